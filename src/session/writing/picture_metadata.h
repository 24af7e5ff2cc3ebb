#pragma once

// How a picture was made, in the words that an EXR holds of it (pertev.*): all that is needed to make it again.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "denoise/reconstruction_settings.h"
#include "image/exr_file.h"
#include "image/tone_map.h"
#include "restir/restir_settings.h"
#include "session/opening/choose_camera.h"
#include "session/opening/open_scene.h"
#include "session/shutter.h"
#include "settings/setting_table.h"

namespace pertev {

/// How the scene was opened.
struct SceneSource {
    std::string scene;           // file, or name of a built-in scene
    std::string environment;     // asked for: file or colour; empty: none was
    float environment_scale = 1; // factor
    float environment_rotation_deg = 0;
    std::string up_axis, unit; // of the file's coordinates, asked for; empty: not
    std::string hash;          // settings/settings_file.h's scene_hash(); empty: not known
    std::string settings;      // all that was asked for, as JSON (settings/settings_file.h); empty: not known
    std::string by_scene, by_settings, by_flags; // names of settings that its file, a file of them, and flags gave
    std::string lamps;                           // set to amounts of light, a line each; empty: none
    bool has_environment = false;                // the scene has one: asked for, its own or the default
    bool has_ground = false;                     // a made-up one
    bool two_sided_lights = false, show_back_faces = false;
    std::string animation, file_scene; // choices among the file's (formats/files/file_choices.h); empty: no others
    std::optional<double> time_s;      // that it is shown at; none: at rest
    std::optional<Shutter> shutter;    // open at that time; none: it is of one moment
    std::vector<std::string> instances, materials; // names by id, for pictures with ids; empty: none are said
    std::vector<std::string> made_up, left_out;    // messages: for the scene; of what it has
    std::optional<DoubleVec3> position_origin;     // of a far scene: what positions are relative to; none: the file's
    double load_seconds = 0, build_seconds = 0;    // of reading; of the trees
};

/// A camera, and what was asked for of it in words that say the same.
struct CameraSource {
    Camera camera;
    std::string name;                 // or number, of the scene's cameras; empty: none was asked for
    std::optional<DoubleVec3> target; // in the coordinates of the file
    std::optional<Vec3> up;
    float fov_deg = 0;             // 0: none was asked for
    DoubleVec3 origin = {0, 0, 0}; // of the scene that the camera stands in (Scene::origin_in_file)
};

/// Of a frame in real time (Session::render_frame): what it is made of beside its sample.
struct ReconstructedFrame {
    uint32_t number = 0, cut = 0; // of the frame, and of the first one that it knows of
    ReconstructionSettings reconstruction;
    RestirSettings restir;
};

/// Numbers in place of tones (image/false_color.h).
struct FalseColors {
    std::string quantity; // "luminance" or "illuminance"
    std::string unit;     // of `factor` times the picture's luminance
    float factor = 1;
    float least = 0, most = 0; // ends of the scale, in that unit; 0: as fits the picture
};

/// How PNG and JPEG show the picture.
struct Display {
    ToneMap tone_map = ToneMap::Agx;
    float exposure_stops = 0;
    std::optional<FalseColors> false_colors; // then there are no tones and no exposure
};

struct PictureRecord {
    SceneSource scene;
    CameraSource camera;
    RenderSettings settings;
    std::string device;
    std::optional<ReconstructedFrame> frame; // none: a picture of its samples alone
    std::optional<Display> display;          // none: the picture is shown nowhere
};

/// Returns an entry for each of `settings` that files record, under its name.
ExrMetadata recorded_settings(const PictureOptions& options, std::span<const Setting> settings);

/// Of a scene that open_scene() made of these options; without seconds.
SceneSource source_of(const OpenOptions& options, const Scene& scene);
/// Of a camera that choose_camera() made of this choice, after aim_eye(). `origin`: of the scene.
CameraSource source_of(const CameraChoice& choice, const Camera& camera, DoubleVec3 origin = {0, 0, 0});

/// What places this camera again: to the bit where words have placed it or none are given, else as near as their
/// numbers go. And its matrix, column by column.
ExrMetadata camera_metadata(const CameraSource& source);

/// Of the picture, what it is a function of, but for the number of samples: the version, the scene as it was opened,
/// the camera, the settings, how it is shown.
ExrMetadata settings_metadata(const PictureRecord& record);

/// Writes the names of all that ids may tell of.
void name_ids(const Scene& scene, SceneSource& source);
/// Of the instances and materials in the picture: a JSON object each, from id to name. Nothing without ids or names.
ExrMetadata id_metadata(const SceneSource& source, std::span<const PixelIds> ids);

/// settings_metadata and what came of it. `hash`: of the film's picture, denoised or not.
ExrMetadata picture_metadata(const PictureRecord& record, const RenderStats& stats, const std::string& hash);

} // namespace pertev
