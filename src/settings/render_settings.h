#pragma once

// Settings of a render besides scene and camera, and its result.

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "integrators/kinds/make_integrator.h"
#include "render/film.h"
#include "render/pixel_filter.h"
#include "render/prepare_scene.h"
#include "render/sample_layers/matte_names.h"
#include "render/sample_layers/sample_layers.h"
#include "scene/camera.h"

namespace pertev {

/// Choice of a denoised picture in addition to the mean of the samples.
enum class Denoise : uint8_t {
    None,
    Svgf, // denoise/picture_denoiser.h
    Oidn, // denoise/oidn/oidn_denoiser.h, outside the one-picture law
};

/// A part of a picture: its upper left pixel, from 0, and its size in pixels.
struct PictureCrop {
    uint32_t x = 0, y = 0, width = 0, height = 0;
    bool operator==(const PictureCrop&) const = default;
};

/// The integrator with its settings (IntegratorSettings), and further settings of a picture.
struct RenderSettings : IntegratorSettings {
    // Besides scene, camera, light and number of samples, the picture depends on these.
    uint32_t width = 1280, height = 720; // pixels of the whole picture
    std::optional<PictureCrop> crop;     // the pixels that are rendered; none: all
    PixelFilter filter = PixelFilter::BlackmanHarris;
    float filter_radius = 0;                  // pixels; 0 = the filter's default
    uint32_t aovs = 0;                        // AovBits
    LayersAt layers_at = LayersAt::Samples;   // where these layers are sampled
    std::vector<std::string> light_groups;    // the last layers of light_paths, as the setting states them
    uint32_t sample_layers = 0;               // SampleLayerBits
    std::shared_ptr<const MatteNames> mattes; // ids of the scene's names, if layers show them
    bool transparent = false;        // RGBA: the background is omitted, and alpha is the covered fraction of the
                                     // pixel
    Denoise denoise = Denoise::None; // the film does not change
    uint32_t history = 0;            // the most frames of a sequence whose light denoised pictures mix; up to 1: none
    /// Maximum number of scatterings in real-time frames, if that is below path.max_depth; none: no separate limit.
    /// It does not affect the film.
    std::optional<uint32_t> frame_depth;

    // Number of samples and limits.
    uint32_t first_sample = 0;           // number of the first sample of each pixel
    uint32_t samples = 64;               // per pixel, for render_picture, with those before first_sample
    uint32_t first_row = 0, end_row = 0; // rows of pixels that get samples; 0 as the end: all
    double time_limit_s = 0;             // limit for one call that renders; 0: none; it ends at a whole sample
    uint32_t pass_samples = 0;           // samples per pass; 0: as many as fit a fraction of a second

    // How the device renders; the picture does not change.
    std::optional<TracerChoice> tracers; // none: the device's default
    bool time_kinds = false;             // fills RenderStats::kind_seconds, which slows the wavefront down

    bool is_denoised() const { return denoise != Denoise::None; }
    /// Returns whether denoised pictures depend on those before them.
    bool has_history() const { return denoise == Denoise::Svgf && history > 1; }
    SampleRange range() const { return {first_sample, samples}; }
    /// The window of the picture that the film holds.
    PixelWindow window() const {
        if (!crop) return {.width = width, .height = height};
        return {width, crop->x, crop->y, crop->width, crop->height};
    }
    /// The part of the film that is rendered.
    FilmPart part() const { return {first_row, end_row == 0 ? window().height : end_row, range()}; }
    /// The number of pixels that get samples.
    uint64_t rendered_pixels() const { return uint64_t(window().width) * (part().end_row - part().first_row); }
};

/// Returns the names of the requested layers of light paths.
std::vector<std::string> light_layers_of(const RenderSettings& settings);

/// Returns whether the film has layers at the centres of pixels.
inline bool has_centres(const RenderSettings& settings) {
    return settings.layers_at == LayersAt::Centre && (settings.aovs & ~uint32_t{kAovMotion}) != 0;
}

/// Returns the filter radius in pixels: the requested one, or the filter's default.
inline float filter_radius_of(const RenderSettings& settings) {
    return settings.filter_radius > 0 ? settings.filter_radius : default_filter_radius(settings.filter);
}

/// Makes all samples pass through the centres of their pixels, to a millionth of a pixel.
inline void sample_centres(RenderSettings& settings) {
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0x1p-20f;
}

/// Returns the requested tracers, or the device's default. `deforms` means that the scene has meshes whose vertices
/// move; a GPU then has one tree of compressed nodes for all rays, which it refits and builds itself.
TracerChoice tracers_of(const RenderSettings& settings, bool on_cuda, bool deforms = false);

/// Returns the options for preparing a scene for a session with these settings: trees and structures of its tracers.
PrepareOptions prepare_options(const RenderSettings& settings, bool on_cuda);

/// Sets the size of a picture without a given one: 1280x720, or a height of 720 with the aspect ratio of `own`, a
/// camera of the scene; null if there is none.
void set_default_size(RenderSettings& settings, const Camera* own);

/// Returns the settings for real-time frames: paths may end from their second vertex on, where those of pictures may
/// from the third, and more of them do (Roulette::NearCubeRoot), which takes fewer rays for the same mean light. Also
/// limits scatterings to `frame_depth`, which loses light.
RenderSettings settings_of_frames(RenderSettings settings);

/// Returns whether `a` and `b` give the same picture for the same scene, camera and number of samples.
bool same_picture(const RenderSettings& a, const RenderSettings& b);

/// Statistics of the samples in the film.
struct RenderStats {
    uint32_t samples = 0; // whole samples of all pixels
    RayCounts rays;
    SceneTracer::Seconds kind_seconds; // seconds of the last call that renders
    uint64_t invalid_samples = 0;
    double hidden_back_share = 0; // fraction of camera rays: see render/hidden_back_share.h
    double upload_seconds = 0;    // upload of the scene; includes the conversion of trees if no session has had its
                                  // tracers yet
    double render_seconds = 0;
    double first_pixel_seconds = 0; // until each pixel had one sample, including memory allocation
    std::size_t device_peak_bytes = 0;
};

struct RenderResult : RenderStats {
    Image picture;                 // RGB or RGBA, linear: the film's
    std::optional<Image> denoised; // with the same channels, if the settings request it
    std::string denoiser;          // Denoiser::name of what made it
    std::vector<FilmLayer> layers;
    std::vector<PixelIds> ids; // empty unless requested
};

/// Returns a requested layer of `result` by its name.
const Image& layer_named(const RenderResult& result, std::string_view name);

} // namespace pertev
