// Settings of the scene: its file, its camera, its light, what moves in it.

#include "base/limits.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"

namespace pertev {

#define FIELD PERTEV_SETTING_FIELD

std::vector<Setting> scene_settings() {
    return {
        row("file_scene", "File", "NAME|N", FIELD(scene.file_scene),
            "A glTF file may have several scenes; the one of this name or number, from 0, is shown.",
            Otherwise{"the file's default"}, On{kScenes | kLab | kInfo}, Mark::Name, Mark::OpensScene),
        row("allow_path", "File", "DIR", FIELD(scene.allowed_paths),
            "The scene may read from this folder, too, which is outside its own. It may be given again.",
            On{kScenes | kLab | kInfo}, Mark::NotKept),
        row("up_axis", "File", "x|y|z", FIELD(scene.up_axis),
            "This axis of an .obj or .ply file points up. All other settings are for a scene with y up.",
            Otherwise{"y"}, On{kScenes | kLab | kInfo}, Mark::OpensScene),
        row("unit", "File", "UNIT|M", FIELD(scene.unit),
            "An .obj or .ply file is in this unit: m, cm, mm, km, in, ft or a number of metres. All other settings are "
            "for a scene in metres.",
            Otherwise{"m"}, On{kScenes | kLab | kInfo}, Mark::OpensScene),

        row("camera", "Camera", "NAME|N", FIELD(scene.camera.camera),
            "The scene's camera of this name or number, from 0, takes the picture.", Otherwise{"its first"},
            On{kLooking | kLab}, Mark::Common),
        row("eye", "Camera", "X,Y,Z", FIELD(scene.camera.eye),
            "The camera stands here; it looks at the scene's middle unless a target is given.", Unit{"m"},
            On{kLooking | kLab | kBenchRays}, Excludes{"camera_path"}, Mark::Common),
        row("target", "Camera", "X,Y,Z", FIELD(scene.camera.target), "The camera looks at this point.", Unit{"m"},
            On{kLooking | kLab | kBenchRays}, Excludes{"camera_path"}, Mark::Common),
        row("up", "Camera", "X,Y,Z", FIELD(scene.camera.up), "This direction points up in the picture.",
            Otherwise{"0,1,0"}, On{kLooking | kLab}, Excludes{"camera_path"}),
        row("fov", "Camera", "DEG", FIELD(scene.camera.fov_deg), "The full vertical angle of view, in degrees.",
            Range{0.01, 179}, Unit{"degrees"}, Otherwise{"the camera's own"}, On{kLooking | kLab | kBenchRays},
            Mark::Common),
        row("projection", "Camera", "NAME", FIELD(scene.camera.projection), "How the camera projects the scene.",
            Otherwise{"the camera's own"}, On{kLooking | kLab}),
        row("view_height", "Camera", "M", FIELD(scene.camera.view_height), "The full height of an orthographic view.",
            Above{0, kMaxCoordinate}, Unit{"m"}, Otherwise{"as much as the perspective view shows"},
            On{kLooking | kLab}),
        row("aperture", "Camera", "M", FIELD(scene.camera.aperture),
            "The radius of the lens; with 0 everything is sharp.", Range{0, kMaxCoordinate}, Unit{"m"},
            Otherwise{"the camera's own"}, On{kLooking}),
        row("focus", "Camera", "M", FIELD(scene.camera.focus),
            "A lens with an aperture shows things at this distance sharp.", Above{0, kMaxCoordinate}, Unit{"m"},
            Otherwise{"that of the target, else of what is in the middle of the picture"}, On{kLooking}),

        row("environment", "Environment", "FILE|R,G,B", FIELD(scene.environment),
            "An .hdr or .exr panorama, or a radiance R,G,B, lights the scene from far away.", On{kScenes}, Mark::Common,
            Mark::OpensScene),
        row("environment_rotation", "Environment", "DEG", FIELD(scene.environment_rotation_deg),
            "The environment, or a made-up sky, is turned about +y by this angle.", Range{-1e6, 1e6}, Unit{"degrees"},
            On{kScenes}, Mark::OpensScene),
        row("environment_scale", "Environment", "X", FIELD(scene.environment_scale),
            "The radiance of the environment, or of a made-up sky, is multiplied by this.", Range{0, 1e12}, On{kScenes},
            Mark::OpensScene),
        row("ground", "Environment", "on|off|auto", FIELD(scene.ground),
            "A made-up ground catches the shadow. auto puts it where camera and light are made up around a thing.",
            Choices{{"on", "off", "auto"}}, On{kRender | kView}, Mark::OpensScene),

        row("lamp", "Lamps", "NAME=AMOUNT", FIELD(scene.emitters),
            "Every lamp of this name (* and ? stand for letters) gives so much light, in W, lm, cd, lx or nits, as in "
            "bulb=800lm. It may be given again.",
            On{kScenes}, Mark::OpensScene),
        row("efficacy", "Lamps", "LM_PER_W", FIELD(scene.efficacy), "A watt counts as so many lumens.", Above{0, 1e6},
            Unit{"lm/W"}, Otherwise{"683; 1 for glTF, whose candela, lux and nits are read as watts"}, On{kScenes},
            Mark::OpensScene),

        row("two_sided_lights", "Faces", "", FIELD(scene.two_sided_lights),
            "Lamps shine from both faces, whatever the file says.", On{kScenes}, Mark::OpensScene),
        row("show_back_faces", "Faces", "", FIELD(scene.show_back_faces),
            "The camera sees backs that a glTF file hides (doubleSided: false).", On{kLooking}, Mark::OpensScene),

        row("animation", "Motion", "NAME|N|all", FIELD(scene.animation),
            "A file may have several animations; the one of this name or number, from 0, plays, or all at once.",
            Otherwise{"its first"}, On{kScenes}, Mark::Name),
        row("time", "Motion", "SECONDS", FIELD(time_s),
            "The scene is shown at this time of its animation, which plays from 0 on.", Range{-1e9, 1e9}, Unit{"s"},
            Otherwise{"at rest; in pertev view it plays"}, On{kRender | kView | kBenchSequence | kMeasure | kSolve},
            Excludes{"frames"}, Mark::Common),
        row("shutter", "Motion", "[OPEN,]SECONDS", FIELD(shutter),
            "What moves is blurred, because the shutter is open for so long after the time of the picture or frame, or "
            "from OPEN to CLOSE, counted from it (path, direct, indirect, distributed, whitted, cast).",
            Unit{"s"}, Needs{"time frames"}, Mark::Name),
        row("camera_path", "Motion", "FILE", FIELD(camera_path),
            "A JSON file of keys (time, eye, target, up, fov) leads the camera.", On{kRender | kView | kBenchSequence},
            Mark::Name, Mark::OpensScene),
        row("turntable", "Motion", "N", FIELD(turntable),
            "The camera goes once round what it looks at, in N pictures; in pertev view it takes N / 24 s.",
            Range{1, 1e9}, On{kRender | kView | kBenchSequence}, Excludes{"camera_path"}),
        row("frames", "Motion", "A-B", FIELD(frames),
            "Pictures of frame A to frame B are rendered. A run of # in the name of each output is the frame's number: "
            "-o frame-####.png.",
            On{kRender | kBenchSequence}, Mark::Common),
        row("fps", "Motion", "F", FIELD(fps), "So many frames are shown a second; frame k is at k / F seconds.",
            Above{0, 1e6}, Unit{"1/s"}, Otherwise{"24"}, On{kRender | kBenchSequence}, Needs{"frames"}),
        row("continue", "Motion", "", FIELD(goes_on),
            "A sequence that was interrupted goes on: frames that are there whole are kept.", Needs{"frames turntable"},
            Mark::NotKept),
    };
}

} // namespace pertev
