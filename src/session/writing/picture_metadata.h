#pragma once

// Metadata of a picture in an EXR (pertev.*): everything that is needed to render it again.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "denoise/reconstruction_settings.h"
#include "image/exr_file.h"
#include "image/write_image.h"
#include "restir/restir_settings.h"
#include "session/opening/choose_camera.h"
#include "session/opening/open_scene.h"
#include "session/shutter.h"
#include "session/writing/files_of_picture.h"
#include "settings/setting_table.h"

namespace pertev {

/// The options of a scene's opening, as they were used, and facts of the scene. Options that were chosen for the caller
/// are filled in: the animation, the scene of the file, the variant, and `ground`, which is "on" or empty.
struct SceneSource : SceneOptions {
    bool has_environment = false;     // the scene has one, requested or default
    std::optional<double> time_s;     // time of the picture; none: at rest
    std::optional<Shutter> shutter;   // open around that time; none: the picture shows one moment
    std::string hash;                 // scene_hash() of settings/settings_file.h; empty if unknown
    std::vector<FileOfPicture> files; // all others that the picture depends on
    std::string settings;             // all given settings, as JSON (settings/settings_file.h); empty if unknown
    // Names of settings that were chosen for want of others, from the scene's file, from a settings file, from flags.
    std::string by_default, by_scene, by_settings, by_caller;
    std::vector<std::string> instances, materials; // names by id, for pictures with ids; empty without them
    std::vector<std::string> made_up, left_out;    // messages: generated parts of the scene; parts of it left out
    std::optional<DoubleVec3> position_origin;     // origin of positions in a far scene; none: the file's origin
    double load_seconds = 0, build_seconds = 0;    // seconds of reading, and of building trees
};

/// A camera, and the requested values in text that states the same.
struct CameraSource {
    Camera camera;
    std::string name;                 // name or number among the scene's cameras; empty: none requested
    std::optional<DoubleVec3> target; // in the coordinates of the file
    std::optional<Vec3> up;
    float fov_deg = 0;             // 0: none requested
    DoubleVec3 origin = {0, 0, 0}; // origin of the camera's scene (Scene::origin_in_file)
};

/// A frame of a sequence that depends on those before it.
struct FrameInSequence {
    uint32_t number = 0, cut = 0; // number of the frame, and of the first one in its history
};

/// Reconstruction of a real-time frame (Session::render_frame) from its sample.
struct ReconstructedFrame {
    ReconstructionSettings reconstruction;
    RestirSettings restir;
};

/// False colours in place of tones (image/false_color.h).
struct FalseColors {
    std::string quantity; // "luminance" or "illuminance"
    std::string unit;     // unit of `factor` times the picture's luminance
    float factor = 1;
    float least = 0, most = 0; // ends of the scale, in that unit; 0: fitted to the picture
};

/// Display of the picture in PNG and JPEG.
struct Display {
    ToneMap tone_map = ToneMap::Agx;
    float exposure_stops = 0;
    std::optional<FalseColors> false_colors;             // replaces tones and exposure
    std::vector<std::pair<ToneMap, float>> metered = {}; // stops by each tone map, if the light meter has set them
    std::string lut_file = {};                           // empty: no table
    LutInput lut_input = LutInput::Display;
    std::shared_ptr<const CubeLut> lut = {}; // the contents of that file, once they are read

    DisplayTransform transform() const { return {tone_map, exposure_stops, lut, lut_input}; }
    /// Reads the table, if there is one. Throws Error(BadInput, OverLimit).
    void read_lut();

    /// Returns the metered stops for a tone map; none if there are none.
    std::optional<float> metered_stops(ToneMap curve) const;
};

struct PictureRecord {
    SceneSource scene;
    CameraSource camera;
    RenderSettings settings;
    std::string device;
    std::optional<FrameInSequence> in_sequence; // none: the picture depends on no other
    std::optional<ReconstructedFrame> frame;    // none: an ordinary picture of its samples
    std::optional<Display> display;             // none: the picture is not displayed
    NumberFormats numbers = {};
};

/// Returns the numbers that files have by these options.
NumberFormats number_formats(const PictureOptions& options);

/// Returns an entry for each of `settings` that files record, under its name.
ExrMetadata recorded_settings(const PictureOptions& options, std::span<const Setting> settings);

/// Describes a scene that open_scene() made of these options, without seconds.
SceneSource source_of(const SceneOptions& options, const Scene& scene);
/// Describes a camera that choose_camera() made of this choice, after aim_camera(). `origin` is the scene's.
CameraSource source_of(const CameraChoice& choice, const Camera& camera, DoubleVec3 origin = {0, 0, 0});

/// Returns the settings that place this camera again: to the bit if its text placed it or it has none, else with the
/// precision of the numbers.
CameraChoice choice_of(const CameraSource& source);
/// Returns entries of the settings that place a camera, and of its matrix, column by column.
ExrMetadata camera_metadata(const CameraSource& source);

/// Entries that determine the picture, except for the number of samples: version, scene as it was opened, camera,
/// settings, display.
ExrMetadata settings_metadata(const PictureRecord& record);

/// Records all names to which ids may refer.
void name_ids(const Scene& scene, SceneSource& source);
/// Entries of the instances and materials in the picture: a JSON object each, from id to name. Empty without ids or
/// names.
ExrMetadata id_metadata(const SceneSource& source, std::span<const PixelIds> ids);

/// Holds all that a picture's files say of it besides its results. Film files keep it for the files of the merged
/// picture.
struct PictureFacts {
    ExrMetadata settings;           // settings_metadata() without the display
    ExrMetadata shown;              // entries of the display
    ExrMetadata origin;             // device, messages, where settings came from; names of ids
    std::optional<Display> display; // none: the picture is not displayed
    bool transparent = false;
    NumberFormats numbers;
    ExrPlace place; // where a crop lies in the whole picture
    std::vector<std::string> objects,
        matte_materials; // names that layers of mattes may show
};
/// Returns the facts of a picture. `ids` are the picture's; empty without a layer of ids.
PictureFacts facts_of(const PictureRecord& record, std::span<const PixelIds> ids);
/// Returns PictureFacts::shown of a display.
ExrMetadata display_metadata(const Display& display);

/// Entries of the facts, and of the results. `hash` is that of the film's picture, denoised or not.
ExrMetadata picture_metadata(const PictureFacts& facts, const RenderStats& stats, const std::string& hash);

} // namespace pertev
