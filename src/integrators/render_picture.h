#pragma once

// One picture from a prepared scene: uploads, renders in passes of whole samples over all pixels, and reads the film.
// What the command line, the benchmarks and the tests all call.

#include <cstdint>
#include <functional>
#include <optional>

#include "integrators/make_integrator.h"
#include "render/prepare_scene.h"

namespace pertev {

struct RenderSettings {
    uint32_t width = 1280, height = 720;
    uint32_t samples = 64; // a pixel
    PixelFilter filter = PixelFilter::BlackmanHarris;
    float filter_radius = 0;  // pixels; 0 = the filter's default
    uint32_t aovs = 0;        // AovBits
    bool transparent = false; // RGBA: the background is left out, alpha says how much of the pixel is covered
    double time_limit_s = 0;  // 0 = none; ends at a whole sample
    PathSettings path;
    PathBody body = PathBody::Loop;      // CUDA always takes Wavefront
    uint32_t batch = 1u << 22;           // paths in flight of the wavefront
    std::optional<TracerChoice> tracers; // none: the device's default
    bool time_kinds = false;             // fills RenderResult::kind_seconds; the wavefront is then slower
    uint32_t pass_samples = 0;           // samples a pass; 0 = as many as fit a fraction of a second
};

/// Pixels: the one asked for, or the filter's default.
inline float filter_radius_of(const RenderSettings& settings) {
    return settings.filter_radius > 0 ? settings.filter_radius : default_filter_radius(settings.filter);
}

struct RenderProgress {
    uint32_t samples_done = 0, samples = 0;
    double seconds = 0; // since the first pass began
    RayCounts rays;
};

struct RenderResult {
    Image picture; // RGB or RGBA, linear
    std::vector<FilmLayer> layers;
    std::vector<PixelIds> ids; // empty unless asked for
    uint32_t samples = 0;      // whole samples done; less than asked for when stopped or out of time
    uint64_t invalid_samples = 0;
    double hidden_back_share = 0; // of the camera's rays: see render/hidden_back_share.h
    RayCounts rays;
    SceneTracer::Seconds kind_seconds;
    double upload_seconds = 0, render_seconds = 0, first_pixel_seconds = 0; // first: until one sample of all pixels
    std::size_t device_peak_bytes = 0;
};

/// Bytes of device memory that render_picture will ask for.
std::size_t predicted_bytes(const PreparedScene& prepared, const RenderSettings& settings, bool on_cuda);

/// Renders until done, out of time, or `keep_going` (called after each pass) returns false; at least one sample.
/// Throws Error(OutOfMemory, DeviceFault).
RenderResult render_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                            const RenderSettings& settings,
                            const std::function<bool(const RenderProgress&)>& keep_going = {});

} // namespace pertev
