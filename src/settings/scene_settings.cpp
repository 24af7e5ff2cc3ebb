// Settings of the scene: its file, its camera, its light, what moves in it.

#include "base/limits.h"
#include "scene/camera_path.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"

namespace pertev {

#define FIELD PERTEV_SETTING_FIELD

std::vector<Setting> scene_settings() {
    constexpr uint32_t kDistorted = kRender | kBenchNoise | kBenchCameras | kLab; // others reconstruct frames
    constexpr uint32_t kAimed = kLooking | kLab | kBenchRays;
    return {
        row("file_scene", "File", "NAME|N", FIELD(scene.file_scene),
            "The scene of a glTF file that has several, by name or by number from 0.", Otherwise{"the file's default"},
            On{kScenes | kLab | kDescribes}, Mark::Name, Mark::OpensScene, Recorded::AsUsed),
        row("variant", "File", "NAME|N", FIELD(scene.variant),
            "The variant of a glTF file's materials (KHR_materials_variants), by name or by number from 0.",
            Otherwise{"the file's default materials"}, On{kScenes | kLab | kDescribes}, Mark::Name, Mark::OpensScene,
            Recorded::AsUsed),
        row("define", "File", "NAME=VALUE", FIELD(scene.defines),
            "The value of $NAME in a Mitsuba file. It may be given again.", Letter{"D"},
            On{kScenes | kLab | kDescribes}, Mark::OpensScene, Recorded::AsUsed),
        row("allow_path", "File", "DIR", FIELD(scene.allowed_paths),
            "A folder outside the scene's own that it may read from as well. It may be given again.",
            On{kScenes | kLab | kDescribes}, Mark::NotKept),
        row("up_axis", "File", "x|y|z", FIELD(scene.up_axis),
            "The axis of an .obj, .ply or .stl file that points up. All other settings are for a scene with y up.",
            Otherwise{"y"}, On{kScenes | kLab | kDescribes}, Mark::OpensScene, Recorded::AsUsed),
        row("unit", "File", "UNIT|M", FIELD(scene.unit),
            "The unit of an .obj, .ply or .stl file: m, cm, mm, km, in, ft or a number of metres. All other settings "
            "are for a scene in metres.",
            Otherwise{"m"}, On{kScenes | kLab | kDescribes}, Mark::OpensScene, Recorded::AsUsed),

        row("material", "File", "NAME KEY=VALUE", FIELD(scene.materials),
            "Sets parameters of the materials with this name, as in \"gold roughness=0.2\"; info lists them.",
            On{kScenes | kDescribes}, Mark::OpensScene, Recorded::AsUsed),
        row("movable", "File", "NAME", FIELD(scene.movable),
            "Instances with this name keep their own trees, so that Python moves them quickly; last bits change.",
            On{kRender | kView}, Mark::Name, Recorded::AsUsed),
        row("author", "File", "NAME", FIELD(scene.author), "The scene's author, for the metadata of an EXR.",
            Otherwise{"the file's"}, On{kRender | kView}, Recorded::AsUsed, Changes::Picture),
        row("license", "File", "TEXT", FIELD(scene.license), "The scene's licence, for the metadata of an EXR.",
            Otherwise{"the file's"}, On{kRender | kView}, Recorded::AsUsed, Changes::Picture),
        row("max_texture_size", "File", "N", FIELD(scene.max_texture_size),
            "Larger textures are scaled down to this longer side.", Range{1, kMaxImageSide}, Unit{"pixels"},
            Otherwise{"any size"}, On{kScenes | kLab | kDescribes}, Mark::OpensScene, Recorded::AsUsed),

        row("camera", "Camera", "NAME|N", FIELD(scene.camera.camera),
            "The scene's camera to render from, by name or by number from 0.", Otherwise{"its first"}, On{kAimed},
            Mark::Common, Recorded::Always, Mark::Name, Changes::Camera),
        row("eye", "Camera", "X,Y,Z", FIELD(scene.camera.eye),
            "The camera's position. It looks at the scene's centre unless a target is given.", Unit{"m"}, On{kAimed},
            Excludes{"camera_path"}, Mark::Common, Recorded::AsUsed, Changes::Camera),
        row("target", "Camera", "X,Y,Z", FIELD(scene.camera.target), "The point that the camera looks at.", Unit{"m"},
            On{kAimed}, Excludes{"camera_path"}, Mark::Common, Recorded::AsUsed, Changes::Camera),
        row("up", "Camera", "X,Y,Z", FIELD(scene.camera.up), "The direction that points up in the picture.",
            Otherwise{"0,1,0"}, On{kAimed}, Excludes{"camera_path"}, Recorded::AsUsed, Changes::Camera),
        row("fov", "Camera", "DEG", FIELD(scene.camera.fov_deg), "The full vertical angle of view, in degrees.",
            Range{kMinFovDeg, kMaxFovDeg}, Unit{"degrees"}, Otherwise{"the camera's own"}, On{kAimed}, Mark::Common,
            Recorded::AsUsed, Panel{"Field of view, degrees", PanelGroup::Camera}, Changes::Camera),
        row("projection", "Camera", "NAME", FIELD(scene.camera.projection), "The camera's projection.",
            Otherwise{"the camera's own"}, On{kAimed}, Recorded::AsUsed, Changes::Camera),
        row("view_height", "Camera", "M", FIELD(scene.camera.view_height), "The full height of an orthographic view.",
            Above{0, kMaxCoordinate}, Unit{"m"}, Otherwise{"as much as the perspective view shows"}, On{kAimed},
            Excludes{"projection=perspective"}, Recorded::AsUsed, Changes::Camera),
        row("aperture", "Camera", "M", FIELD(scene.camera.aperture),
            "The radius of the lens; with 0 everything is sharp.", Range{0, kMaxCoordinate}, Unit{"m"},
            Otherwise{"the camera's own"}, On{kLooking}, Recorded::AsUsed,
            Panel{"Lens radius, m", PanelGroup::Camera, 0.005}, Changes::Camera),
        row("aperture_blades", "Camera", "N", FIELD(scene.camera.aperture_blades),
            "The sides, from 3, of a regular polygon in the aperture's circle; 0 is a disk.", Range{0, kMaxBlades},
            Otherwise{"0"}, On{kLooking}, Excludes{"aperture=0"}, Recorded::AsUsed, Changes::Camera),
        row("aperture_rotation", "Camera", "DEG", FIELD(scene.camera.aperture_rotation),
            "Rotates the blades counter-clockwise; with 0 a side's middle is right.",
            Range{-kMaxApertureRotation, kMaxApertureRotation}, Unit{"degrees"}, Otherwise{"0"}, On{kLooking},
            Excludes{"aperture=0 aperture_blades=0"}, Recorded::AsUsed, Changes::Camera),
        // The least ratio is kMinApertureRatio before it is rounded to a float.
        row("aperture_ratio", "Camera", "RATIO", FIELD(scene.camera.aperture_ratio),
            "The aperture's height over its width, which it divides.", Range{0.01, kMaxApertureRatio}, Otherwise{"1"},
            On{kLooking}, Excludes{"aperture=0"}, Recorded::AsUsed, Changes::Camera),
        row("focus", "Camera", "M", FIELD(scene.camera.focus),
            "The distance at which a lens with an aperture is in focus.", Above{0, kMaxCoordinate}, Unit{"m"},
            Otherwise{"the target's distance, or else that of the surface at the picture's centre"}, On{kLooking},
            Excludes{"aperture=0"}, Recorded::AsUsed, Panel{"Focus distance, m", PanelGroup::Camera, 0.1},
            Changes::Camera),
        row("camera_pose", "Camera", "NUMBERS", FIELD(scene.camera.pose),
            "The camera-to-world matrix: 16 or 12 numbers row by row.", Counts{{12, 16}}, On{kAimed},
            Excludes{"eye target up camera_path"}, Changes::Camera),
        row("convention", "Camera", "NAME", FIELD(scene.camera.convention),
            "The axes of camera_pose and of NeRF's cameras: opengl (y up, looks along -z), opencv (y down, along z) or "
            "blender (opengl's, with z up).",
            Otherwise{"opengl"}, On{kAimed}, Needs{"camera_pose cameras"}, Changes::Camera),
        row("intrinsics", "Camera", "FX,FY,CX,CY", FIELD(scene.camera.intrinsics),
            "Focal lengths and principal point in pixels from the picture's upper left corner, or the nine numbers of "
            "K. The first pixel's centre is 0.5,0.5 (in OpenCV 0,0).",
            Counts{{4, 9}}, On{kAimed}, Needs{"size intrinsics_size"},
            Excludes{"fov view_height projection=orthographic"}, Recorded::AsUsed, Changes::Camera),
        row("intrinsics_size", "Camera", "WIDTHxHEIGHT", FIELD(scene.camera.intrinsics_size),
            "The picture's size for which intrinsics hold; they scale with width and height.",
            Otherwise{"the picture's own"}, On{kAimed}, Needs{"intrinsics"}, Recorded::AsUsed, Changes::Camera),
        row("lens", "Camera", "NAME", FIELD(scene.camera.lens),
            "The model of the lens: opencv, fisheye (Kannala and Brandt, as cv::fisheye), or a panorama: "
            "equirectangular "
            "(2:1) or cube (six faces in a row).",
            Otherwise{"opencv"}, On{kDistorted},
            Excludes{"projection=orthographic fisheye,equirectangular,cube:aperture!=0 "
                     "fisheye,equirectangular,cube:denoise=svgf fisheye,equirectangular,cube:real_time "
                     "equirectangular,cube:fov equirectangular,cube:eye_offset!=0 equirectangular,cube:stereo "
                     "cube:filter!=box"},
            Recorded::AsUsed, Changes::Camera),
        row("distortion", "Camera", "K1,K2,...", FIELD(scene.camera.distortion),
            "The lens's coefficients: k1,k2,p1,p2[,k3[,k4,k5,k6]], or of a fisheye k1,k2,k3,k4.", Counts{{4, 5, 8}},
            On{kDistorted}, Excludes{"projection=orthographic real_time"}, Recorded::AsUsed, Changes::Camera),
        row("eye_offset", "Camera", "M", FIELD(scene.camera.eye_offset),
            "How far the camera moves to its right, as the eye of a stereo pair.",
            Range{-kMaxCoordinate, kMaxCoordinate}, Unit{"m"}, On{kLooking}, Changes::Camera),
        row("convergence", "Camera", "M", FIELD(scene.camera.convergence),
            "The distance at which the pictures of a stereo pair coincide.", Above{0, kMaxCoordinate}, Unit{"m"},
            Otherwise{"infinity: the eyes look in parallel"}, On{kLooking}, Needs{"stereo eye_offset cameras"},
            Excludes{"projection=orthographic"}, Changes::Camera),
        row("camera_from", "Camera", "FILE", FIELD(scene.camera.camera_from),
            "An EXR of Pertev's whose camera is used, to the bit, unless other settings override it.", On{kAimed},
            Excludes{"camera camera_path"}, Mark::Name, HoldsFile::Whole, Changes::Camera),

        row("environment", "Environment", "FILE|R,G,B", FIELD(scene.environment),
            "Light from infinitely far away: an .hdr or .exr panorama, or a radiance R,G,B.", On{kScenes}, Mark::Common,
            Mark::OpensScene, HoldsFile::Whole, Mark::Numbers, Recorded::AsUsed),
        row("sun_sky", "Environment", "ELEVATION,AZIMUTH[,TURBIDITY]", FIELD(scene.sun_sky),
            "A clear sky by Preetham's formulas, with the sun this high and this far from -z towards +x. The turbidity "
            "is from 2 (clear) to 10, by default 3.",
            Unit{"degrees"}, On{kScenes}, Excludes{"environment"}, Mark::OpensScene, Recorded::AsUsed),
        row("environment_rotation", "Environment", "DEG", FIELD(scene.environment_rotation_deg),
            "The rotation of the environment or of the default sky about +y.", Range{-1e6, 1e6}, Unit{"degrees"},
            On{kScenes}, Mark::OpensScene, Recorded::AsUsed),
        row("environment_scale", "Environment", "X", FIELD(scene.environment_scale),
            "A factor for the radiance of the environment or of the default sky.", Range{0, 1e12}, On{kScenes},
            Mark::OpensScene, Recorded::AsUsed),
        row("medium", "Environment", "KEY=VALUE", FIELD(scene.medium),
            "The medium around everything, such as \"sigma_s=0.1,0.2,0.3 sigma_a=0.01 g=0.5\": scattering and "
            "absorption in 1/m, and the mean cosine of scattering; none is a vacuum.",
            Otherwise{"the file's"}, On{kLooking | kMeasure}, Mark::Name, Mark::OpensScene, Recorded::AsUsed),
        row("ground", "Environment", "on|off|auto", FIELD(scene.ground),
            "A ground plane that receives shadows. auto adds it to an object whose file has neither camera nor light.",
            Choices{{"on", "off", "auto"}}, On{kRender | kView}, Mark::OpensScene, Recorded::AsUsed),

        row("lamp", "Lamps", "NAME=AMOUNT", FIELD(scene.emitters),
            "The amount of light of all lights with this name (* and ? are wildcards) in W, lm, cd, lx or nits, for "
            "example bulb=800lm. It may be given again.",
            On{kScenes}, Mark::OpensScene, Recorded::AsUsed),
        row("ies", "Lamps", "NAME=FILE", FIELD(scene.profiles),
            "The IES photometric file of all point and spot lights with this name, which gives them its candelas. It "
            "may be given again.",
            On{kScenes}, Mark::OpensScene, HoldsFile::Named, Recorded::AsUsed),
        row("efficacy", "Lamps", "LM_PER_W", FIELD(scene.efficacy), "The number of lumens per watt.", Above{0, 1e6},
            Unit{"lm/W"}, Otherwise{"683; 1 for glTF, whose candela, lux and nits are read as watts"}, On{kScenes},
            Mark::OpensScene),

        row("two_sided_lights", "Faces", "", FIELD(scene.two_sided_lights),
            "Emitters emit from both faces, whatever the file says.", On{kScenes}, Mark::OpensScene, Recorded::AsUsed),
        row("show_back_faces", "Faces", "", FIELD(scene.show_back_faces),
            "The camera sees back faces that a glTF file hides (doubleSided: false).", On{kLooking}, Mark::OpensScene,
            Recorded::AsUsed),

        row("animation", "Motion", "NAME|N|all", FIELD(scene.animation),
            "The animation to play, by name or by number from 0, or all at once.", Otherwise{"its first"}, On{kScenes},
            Mark::Name, Recorded::AsUsed),
        row("time", "Motion", "SECONDS", FIELD(time_s), "The time in the scene's animation, which starts at 0.",
            Range{-1e9, 1e9}, Unit{"s"}, Otherwise{"the rest pose; the viewer plays the animation"},
            On{kRender | kView | kBenchSequence | kMeasure | kSolve}, Excludes{"frames"}, Mark::Common,
            Recorded::AsUsed, Changes::Picture),
        row("shutter", "Motion", "[OPEN,]SECONDS", FIELD(shutter),
            "The times at which the shutter opens (by default 0) and closes, after the time of the picture or frame. "
            "Motion between them is blurred.",
            Unit{"s"}, Of{integrators_that(has_shutter)}, Needs{"time frames"}, Excludes{"denoise!=none"}, Mark::Name,
            Mark::Numbers, Recorded::AsUsed),
        row("camera_path", "Motion", "FILE", FIELD(camera_path),
            "A JSON file of keys (time, eye, target, up, fov) that the camera follows.",
            On{kRender | kView | kBenchSequence}, Mark::Name, Mark::OpensScene, HoldsFile::Whole),
        row("turntable", "Motion", "N", FIELD(turntable),
            "The number of pictures in which the camera orbits its target once; in the viewer, in N / 24 s.",
            Range{1, 1e9}, On{kRender | kView | kBenchSequence}, Excludes{"camera_path"}),
        row("cameras", "Motion", "FILE", FIELD(cameras),
            "A file of cameras with a picture each: JSON, NeRF's transforms.json or COLMAP's folder. {name} in an "
            "output's name becomes the camera's, # its number.",
            Excludes{"frames turntable camera_path camera camera_from eye target up camera_pose real_time"}, Mark::Name,
            HoldsFile::Whole),
        row("stereo", "Motion", "M", FIELD(stereo),
            "Renders a stereo pair by cameras this far apart, left and right. {name} in an output's name becomes the "
            "eye's.",
            Above{0, kMaxCoordinate}, Unit{"m"}, Excludes{"frames turntable camera_path real_time eye_offset"}),
        row("frames", "Motion", "A-B", FIELD(frames),
            "The first and last frame to render. A run of # in an output's name, as in frame-####.png, becomes the "
            "frame's number.",
            On{kRender | kBenchSequence}, Mark::Common),
        row("cuts", "Motion", "K,K,...", FIELD(cuts),
            "The frames with which the history starts again, because the film is cut before them.",
            Needs{"real_time denoise=svgf"}, Mark::Name),
        row("fps", "Motion", "F", FIELD(fps), "The number of frames per second; frame k is at k / F seconds.",
            Above{0, 1e6}, Unit{"1/s"}, Otherwise{"24"}, On{kRender | kBenchSequence}, Needs{"frames"}),
        row("continue", "Motion", "", FIELD(goes_on), "An interrupted sequence continues: complete frames are kept.",
            Needs{"frames turntable cameras stereo"}, Mark::NotKept),
    };
}

} // namespace pertev
