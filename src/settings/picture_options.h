#pragma once

// All that can be asked for of a picture, of a sequence of frames, and of the scene that they show. The table of
// settings (settings/setting_table.h) has a row for each field; an empty text and 0 mean that a setting was not given,
// unless a comment says otherwise.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "denoise/reconstruction_settings.h"
#include "image/tone_map.h"
#include "radiosity/radiosity_settings.h"
#include "restir/restir_settings.h"
#include "settings/camera_choice.h"
#include "settings/render_settings.h"
#include "tracer/tracer_choice.h"

namespace pertev {

struct SceneOptions {
    std::string scene;                 // a file, or a built-in scene's name
    std::string file_scene, animation; // names or numbers
    std::vector<std::filesystem::path> allowed_paths;
    std::string up_axis, unit; // of the file's coordinates
    CameraChoice camera;
    std::string environment; // a file, or "r,g,b"
    float environment_rotation_deg = 0, environment_scale = 1;
    std::string ground = "auto"; // or on, off
    std::vector<std::string> lamps;
    float efficacy = 0; // lm/W; 0: by the kind of file
    bool two_sided_lights = false, show_back_faces = false;
};

/// Which structures and walks rays go by; each text is for one kind of ray, or for all.
struct TracerOptions {
    TreeBuild default_build = kDefaultBuild; // where `build` is empty; no setting
    std::string build;
    std::vector<std::string> structures, walks, rta, order, distributions;

    bool are_empty() const {
        return build.empty() && structures.empty() && walks.empty() && rta.empty() && order.empty() &&
               distributions.empty();
    }
};

struct MachineOptions {
    std::string device = "auto";
    uint32_t threads = 0; // 0: all
};

/// How radiosity is solved, and what of it a picture shows.
struct RadiosityOptions {
    RadiositySettings solving;
    std::string solution; // a file
    bool flat_patches = false;
    double max_memory = 0; // MiB; of pictures by any integrator too
};

/// How frames in real time are made.
struct ReconstructionOptions {
    ReconstructionSettings settings;
    RestirSettings sharing;
    bool none = false; // frames are their samples
};

struct PictureSize {
    uint32_t width = 0, height = 0; // pixels
    bool operator==(const PictureSize&) const = default;
};

/// What gave a setting its value. A later one overrules those before it.
enum class SettingOrigin : uint8_t {
    Scene, // its file
    File,  // of settings
    Flag,
};

struct PictureOptions {
    SceneOptions scene;
    RenderSettings render; // but for its size, aovs, light_paths, irradiance and heights, which are the fields below
    std::optional<PictureSize> size;
    std::optional<ToneMap> tone_map;
    std::string exposure;                             // auto, or stops
    float iso = 0, f_number = 0, shutter_s = 0;       // a physical exposure
    std::vector<std::string> aovs, lpe, displacement; // in words
    std::string false_color;                          // luminance or illuminance
    std::string false_color_range;                    // A,B
    std::optional<double> time_s;                     // none: at rest
    std::string frames, camera_path, shutter;         // A-B; a file; [OPEN,]SECONDS
    double fps = 0;
    uint32_t turntable = 0;
    bool goes_on = false; // a sequence that was interrupted
    bool real_time = false;
    ReconstructionOptions reconstruction;
    RadiosityOptions radiosity;
    MachineOptions machine;
    TracerOptions tracer;
    bool no_cache = false, strict = false;

    /// The names of the settings that were given, and by what.
    std::map<std::string, SettingOrigin, std::less<>> given;
    bool is_given(std::string_view name) const { return given.contains(name); }
};

} // namespace pertev
