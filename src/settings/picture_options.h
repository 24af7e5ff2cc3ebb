#pragma once

// All options of a picture, of a sequence of frames, and of their scene. The table of settings
// (settings/setting_table.h) has a row for each field. An empty text or 0 means that a setting was not given, unless
// a comment says otherwise.

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "denoise/reconstruction_settings.h"
#include "formats/cameras/read_cameras.h"
#include "image/write_image.h"
#include "radiosity/radiosity_settings.h"
#include "restir/restir_settings.h"
#include "settings/camera_choice.h"
#include "settings/render_settings.h"
#include "tracer/tracer_choice.h"

namespace pertev {

struct SceneOptions {
    std::string scene;                          // a file, or the name of a built-in scene
    std::string file_scene, variant, animation; // names or numbers
    std::vector<std::filesystem::path> allowed_paths;
    std::vector<std::string> defines; // values of a Mitsuba file's parameters: NAME=VALUE
    std::string up_axis, unit;        // coordinate system of the file
    uint32_t max_texture_size = 0;    // pixels of the longer side; 0: any
    CameraChoice camera;
    std::string environment; // a file, or "r,g,b"
    std::string sun_sky;     // formats/sun_sky/sun_sky.h
    float environment_rotation_deg = 0, environment_scale = 1;
    std::string medium;                                     // around everything; empty: the file's
    std::string ground = "auto";                            // auto, on or off
    std::vector<std::string> emitters, materials, profiles; // changes of the scene
    std::vector<std::string> movable;                       // names of instances
    std::string author, license;                            // the metadata show them
    float efficacy = 0;                                     // lm/W; 0: by the kind of file
    bool two_sided_lights = false, show_back_faces = false;
};

/// Structures and traversals of rays; each text applies to one kind of ray, or to all.
struct TracerOptions {
    TreeBuild default_build = kDefaultBuild; // used if `build` is empty; not a setting
    std::string build;
    std::vector<std::string> structures, traversals, rta, order, distributions;

    bool are_empty() const {
        return build.empty() && structures.empty() && traversals.empty() && rta.empty() && order.empty() &&
               distributions.empty();
    }
};

struct MachineOptions {
    std::string device = "auto";
    uint32_t threads = 0; // 0: all
};

/// Settings of solving radiosity, and of showing it.
struct RadiosityOptions {
    RadiositySettings solving;
    std::string solution; // a file
    std::string records;  // a file of what is made before the first sample, by irradiance_cache too
    bool flat_patches = false;
    double max_memory = 0; // MiB; applies to pictures by any integrator
};

/// Settings of real-time frames.
struct ReconstructionOptions {
    ReconstructionSettings settings;
    RestirSettings sharing;
    bool none = false; // frames show their raw samples

    /// The settings of the reconstruction; without it of_samples_alone.
    ReconstructionSettings used() const {
        ReconstructionSettings used = none ? of_samples_alone(settings) : settings;
        used.history = std::max(used.history, 1u);
        return used;
    }
    /// Returns whether an option is set that only integrators with frames have (makes_frames).
    bool has_frame_options() const { return sharing.light != RestirLight::Off || settings.resolution_scale != 1; }
};

/// The source of a setting's value. Later ones override earlier ones.
enum class SettingOrigin : uint8_t {
    Scene,  // the scene's file
    File,   // a settings file
    Caller, // a flag, or the caller of a library
};

struct PictureOptions {
    SceneOptions scene;
    RenderSettings
        render; // except for size, crop, aovs, light_paths, irradiance and heights, which are the fields below
    std::optional<PictureSize> size;
    std::vector<double> crop; // X,Y,W,H
    std::optional<ToneMap> tone_map;
    std::string lut; // a file
    LutInput lut_input = LutInput::Display;
    ExrColors exr_colors = ExrColors::Float;
    std::string png_bits = "8", output_format;        // 8 or 16; exr, hdr, jpg or png
    std::string exposure;                             // auto, or stops
    float iso = 0, f_number = 0, shutter_s = 0;       // a physical exposure
    std::vector<std::string> aovs, lpe, light_groups; // lists of texts
    std::vector<std::string> displacement;
    std::string false_color;                                      // luminance or illuminance
    std::string false_color_range;                                // A,B
    std::optional<double> time_s;                                 // none: the scene is at rest
    std::string frames, camera_path, shutter;                     // A-B; a file; [OPEN,]SECONDS
    std::string cuts;                                             // K,K,...
    std::string cameras;                                          // a file or folder of many cameras
    std::optional<double> stereo;                                 // metres between the eyes of a stereo pair
    std::shared_ptr<const std::vector<CameraOfFile>> camera_list; // cameras of that file and eyes, once it is read
    double fps = 0;
    uint32_t turntable = 0;
    std::string rows, samples; // A:B
    std::string part;          // I/N, where I counts from part_base
    uint32_t part_base = 1;
    std::string checkpoint; // a film file that the render goes on from and writes
    double checkpoint_every_s = 60;
    bool goes_on = false; // continues a sequence that was interrupted
    bool real_time = false;
    ReconstructionOptions reconstruction;
    RadiosityOptions radiosity;
    MachineOptions machine;
    TracerOptions tracer;
    bool no_cache = false, strict = false;

    /// Names of the settings that were given, and their sources.
    std::map<std::string, SettingOrigin, std::less<>> given;
    bool is_given(std::string_view name) const { return given.contains(name); }
    /// Returns whether there are frames one after the other; pictures of a list of cameras are not.
    bool is_sequence() const { return !frames.empty() || turntable > 0; }
    /// Returns whether ordinary frames have a history (RenderSettings::has_history).
    bool keeps_history() const {
        return !real_time && is_sequence() && render.denoise == Denoise::Svgf && reconstruction.settings.history > 1;
    }
};

} // namespace pertev
