#include "session/meter_exposure.h"

#include <numeric>

#include "image/auto_exposure.h"

namespace pertev {
namespace {

/// The meter's settings: light paths, aspect ratio and device of the picture, and fixed values for everything else.
RenderSettings meter_settings(const RenderSettings& picture) {
    // The aspect ratio in lowest terms, so that 1280x720 and 640x360 have the same meter.
    const uint32_t common = std::gcd(picture.width, picture.height);
    const float width = static_cast<float>(picture.width / common),
                height = static_cast<float>(picture.height / common);
    const float scale = sqrt(static_cast<float>(kMeterPixels) / (width * height));
    RenderSettings meter = picture;
    meter.width = static_cast<uint32_t>(to_int(scale * width + 0.5f, 1, kMeterPixels));
    meter.height = static_cast<uint32_t>(to_int(scale * height + 0.5f, 1, kMeterPixels));
    meter.crop.reset(); // a crop is shown as the whole picture is
    meter.samples = kMeterSamples;
    meter.filter = PixelFilter::Box;
    meter.filter_radius = 0;
    meter.aovs = meter.sample_layers = 0;
    meter.light_paths = nullptr;
    meter.light_groups.clear();
    meter.time_kinds = false;
    if (finds_all_light(meter.integrator)) meter.integrator = IntegratorKind::Path; // they give the same light
    meter.path.sampler = SamplerKind::Sobol;
    meter.path.seed = 0;
    return meter;
}

Rgb light_of(const float* pixel) { return {pixel[0], pixel[1], pixel[2]}; }

/// Returns `light` without the direct light of emitters, `emitted`, which has the same camera rays. A pixel that
/// shows mostly emitters does not count. Both are RGBA without the sky.
Image scattered_light(Image light, const Image& emitted) {
    for (std::size_t i = 0; i < light.pixels.size(); i += 4) {
        float* pixel = &light.pixels[i];
        const Rgb emitters = light_of(&emitted.pixels[i]), rest = light_of(pixel) - emitters;
        const bool counts = luminance(rest) >= luminance(emitters);
        pixel[0] = counts ? max(rest.r, 0.0f) : 0.0f;
        pixel[1] = counts ? max(rest.g, 0.0f) : 0.0f;
        pixel[2] = counts ? max(rest.b, 0.0f) : 0.0f;
        pixel[3] = counts ? pixel[3] : 0.0f;
    }
    return light;
}

} // namespace

double share_that_counts(const Image& scattered) {
    double sum = 0;
    for (std::size_t i = 0; i < scattered.pixels.size(); i += 4) {
        if (!is_black(light_of(&scattered.pixels[i]))) sum += static_cast<double>(scattered.pixels[i + 3]);
    }
    return sum / (static_cast<double>(scattered.width) * scattered.height);
}

Image metered_light(const RenderSettings& settings, const std::function<Image(const RenderSettings&)>& render) {
    RenderSettings meter = meter_settings(settings);
    meter.transparent = true; // without the sky
    Image light = render(meter);
    RenderSettings emitters = meter;
    emitters.path.max_depth = 0;
    Image scattered = scattered_light(light, render(emitters));
    if (share_that_counts(scattered) >= kFewestThatCount) return scattered;
    meter.transparent = settings.transparent;
    return settings.transparent ? light : render(meter);
}

float meter_exposure(const RenderSettings& settings, ToneMap tone_map,
                     const std::function<Image(const RenderSettings&)>& render) {
    return auto_exposure_stops(metered_light(settings, render), tone_map);
}

float Meter::stops(const Camera& camera, const RenderSettings& settings, ToneMap tone_map) {
    return auto_exposure_stops(light(camera, settings), tone_map);
}

Image Meter::light(const Camera& camera, const RenderSettings& settings) {
    return metered_light(settings, [&](const RenderSettings& meter) {
        Film& film = fit_film(pictures_.queue(), film_, meter);
        film.clear();
        pictures_.begin(camera, meter, meter.samples).render(0, meter.samples, film.view());
        film.set_samples({0, meter.samples});
        return film.picture(meter.transparent);
    });
}

} // namespace pertev
