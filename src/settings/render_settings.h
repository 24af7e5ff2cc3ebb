#pragma once

// What a render is asked for beside scene and camera, how far it is, and what came of it.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "integrators/kinds/make_integrator.h"
#include "render/film.h"
#include "render/pixel_filter.h"
#include "render/prepare_scene.h"
#include "scene/camera.h"

namespace pertev {

/// Whether a picture is reconstructed of its samples, beside being their mean.
enum class Denoise : uint8_t {
    None,
    Svgf, // denoise/picture_denoiser.h
};

/// Which integrator, its settings (IntegratorSettings), and what a picture is asked for beside them.
struct RenderSettings : IntegratorSettings {
    // What the picture is a function of, beside scene, camera, light and number of samples.
    uint32_t width = 1280, height = 720;
    PixelFilter filter = PixelFilter::BlackmanHarris;
    float filter_radius = 0;         // pixels; 0 = the filter's default
    uint32_t aovs = 0;               // AovBits
    bool transparent = false;        // RGBA: the background is left out, alpha says how much of the pixel is covered
    Denoise denoise = Denoise::None; // the film stays as it is
    /// Scatterings at most of frames in real time, where that is fewer than path.max_depth; none: as many. The film
    /// stays as it is.
    std::optional<uint32_t> frame_depth;

    // How many, and until when.
    uint32_t samples = 64;     // a pixel, of render_picture
    double time_limit_s = 0;   // of one call that renders; 0 = none; ends at a whole sample
    uint32_t pass_samples = 0; // samples a pass; 0 = as many as fit a fraction of a second

    // How the device does it: the picture stays the same.
    std::optional<TracerChoice> tracers; // none: the device's default
    bool time_kinds = false;             // fills RenderStats::kind_seconds; the wavefront is then slower
};

/// Returns the names of the layers of light paths that are asked for.
std::vector<std::string> light_layers_of(const RenderSettings& settings);

/// Pixels: the one asked for, or the filter's default.
inline float filter_radius_of(const RenderSettings& settings) {
    return settings.filter_radius > 0 ? settings.filter_radius : default_filter_radius(settings.filter);
}

/// The tracers asked for, or the device's default. `deforms`: the scene has meshes whose vertices move; a GPU then
/// keeps one tree for all rays, that of compressed nodes, which it fits and builds by itself.
TracerChoice tracers_of(const RenderSettings& settings, bool on_cuda, bool deforms = false);

/// What a scene is prepared with for a session of these settings: trees and structures of its tracers.
PrepareOptions prepare_options(const RenderSettings& settings, bool on_cuda);

/// For a picture that is given no size: 1280x720, or 720 high in the shape that `own`, a camera of the scene, asks for.
/// Null: there is none.
void set_default_size(RenderSettings& settings, const Camera* own);

/// `settings` as frames in real time are rendered with them: paths may end from their second vertex on, where those of
/// pictures may from the third, and more of them do (Roulette::NearCubeRoot). That takes fewer rays for the same mean
/// light; and there are `frame_depth` scatterings at most, which is less light.
RenderSettings settings_of_frames(RenderSettings settings);

/// Whether both ask for the same picture of the same scene, camera and number of samples.
bool same_picture(const RenderSettings& a, const RenderSettings& b);

struct RenderProgress {
    uint32_t samples_done = 0, samples = 0; // in the film now, and when the call is done
    double seconds = 0;                     // since the call began to render
    RayCounts rays;                         // of the call
    double made_share = 1;                  // of what the integrator makes before the first sample; 1: all is made
    double made_seconds = 0;                // of `seconds`, that this took; 0: there was nothing to make
};

/// Of the samples in the film.
struct RenderStats {
    uint32_t samples = 0; // whole samples of all pixels
    RayCounts rays;
    SceneTracer::Seconds kind_seconds; // of the last call that renders
    uint64_t invalid_samples = 0;
    double hidden_back_share = 0; // of the camera's rays: see render/hidden_back_share.h
    double upload_seconds = 0;    // of the scene; with its trees' conversion, where no session has had its tracers yet
    double render_seconds = 0;
    double first_pixel_seconds = 0; // until one sample of all pixels was there, with the time to take memory for it
    std::size_t device_peak_bytes = 0;
};

struct RenderResult : RenderStats {
    Image picture;                 // RGB or RGBA, linear: the film's
    std::optional<Image> denoised; // of the same channels, where the settings ask for it
    std::vector<FilmLayer> layers;
    std::vector<PixelIds> ids; // empty unless asked for
};

/// That layer of `result`, which was asked for.
const Image& layer_named(const RenderResult& result, std::string_view name);

} // namespace pertev
