#pragma once

// The flags of pertev render, and what they ask for.

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/choose_device.h"
#include "apps/cli/irradiance_cache_flags.h"
#include "apps/cli/photon_flags.h"
#include "apps/cli/radiosity_flags.h"
#include "apps/cli/reconstruction_flags.h"
#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "apps/cli/tracer_flags.h"
#include "session/frame_sequence.h"
#include "session/photometry.h"
#include "session/settings_text.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

struct RenderFlags {
    SceneOptions scene;
    std::vector<std::string> outputs;
    std::string size;
    std::string tone_map, exposure; // empty: agx, and auto
    bool transparent = false;
    std::string ground = "auto"; // or on, off
    std::vector<std::string> aovs;
    std::vector<std::string> light_paths; // --lpe
    std::string false_color, false_color_range;
    float iso = 0, f_number = 0, shutter_s = 0; // 0: not given
    uint32_t samples = RenderSettings{}.samples;
    double time_limit_s = 0;
    std::optional<double> time_s;
    std::string frames, camera_path, shutter;
    double fps = 0; // 0: not given
    uint32_t turntable = 0;
    bool goes_on = false; // --continue
    bool real_time = false;
    std::string real_time_flag;         // one that was given of those that are of such frames alone; empty: none
    ReconstructionFlags reconstruction; // of frames in real time
    std::string integrator{integrator_name({})}, sampler{name_of(PathSettings{}.sampler)},
        filter{name_of(RenderSettings{}.filter)}, denoise{name_of(RenderSettings{}.denoise)};
    std::string ambient; // empty: the integrator's own
    std::string shading; // empty: raster's own
    bool wireframe = false;
    float shading_rate = 0;                 // 0: not given
    std::vector<std::string> displacements; // --displacement
    PhotonFlags photons;
    IrradianceCacheFlags cache;
    RadiosityFlags radiosity;
    bool limits_memory = false; // --max-memory counts for all integrators
    float filter_radius = 0, clamp = 0;
    uint32_t max_depth = PathSettings{}.max_depth, seed = PathSettings{}.seed;
    MachineFlags machine;
    TracerFlags tracer;
    bool no_cache = false, strict = false;
    ReportFlags report;
};

void add_render_flags(CLI::App& verb, RenderFlags& flags);
/// Of these, but for the scene, the ones that a picture on a screen has too: size, display, quality, tracing, machine.
void add_shown_picture_flags(CLI::App& verb, RenderFlags& flags);
/// Of these, the ones that say what moves, and at which times; and what can be told of them before the scene is read,
/// which throws Error(BadInput).
void add_motion_flags(CLI::App& verb, RenderFlags& flags);
void check_motion_flags(const RenderFlags& flags);
/// --shutter, which pictures alone have that are not reconstructed of frames.
void add_shutter_flag(CLI::App& verb, RenderFlags& flags);
/// Of --shutter; none: it is not given. Throws Error(BadInput).
std::optional<Shutter> shutter(const RenderFlags& flags);
/// Of these, the ones that say at which time the scene is shown, or how the camera goes over time: --time,
/// --camera-path, --turntable. `plays`: without a time, time runs.
void add_time_flags(CLI::App& verb, RenderFlags& flags, bool plays);
/// Of these, the ones that say which light is asked for and by how many samples: --spp, --integrator, --max-depth,
/// --ambient, --shading, --wireframe, --shading-rate, --displacement, those of photons, of records and of radiosity,
/// --seed, --filter, --filter-radius.
void add_light_path_flags(CLI::App& verb, RenderFlags& flags, const char* group);

/// Of --iso, --f-number and --shutter-time; none: they are not given.
std::optional<PhysicalExposure> physical_exposure(const RenderFlags& flags);

/// Of --false-color; none: it is not given. A scale without a range fits the picture.
std::optional<FalseColors> false_colors(const RenderFlags& flags);

/// Whether a picture is asked for that light is mapped to tones for: PNG or JPEG.
bool writes_tone_mapped(const RenderFlags& flags);

/// The frames that are asked for; none: a single picture. Throws Error(BadInput).
std::optional<FrameSequence> frame_sequence(const RenderFlags& flags);

/// What can be told before the scene is read. Throws Error, above all for an output that could not be written.
void check_render_flags(const RenderFlags& flags, Messages& messages);

/// The same of add_shown_picture_flags, add_time_flags and the scene's options.
void check_shown_picture_flags(const RenderFlags& flags);

/// The settings for a scene. Throws Error.
RenderSettings render_settings(const RenderFlags& flags, const Scene& scene);

} // namespace pertev
