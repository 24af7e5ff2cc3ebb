#include "shading/environment_light.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <string>

#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr float kLargestHalf = 65504.0f;

/// Returns sin^2(x) for x in [0, pi / 2], by its series, so that the bits do not depend on the C library.
double sin_squared(double x) {
    double term = x, sum = x;
    for (int k = 1; k <= 12; ++k) {
        term *= -x * x / ((2.0 * k) * (2.0 * k + 1.0));
        sum += term;
    }
    return sum * sum;
}

/// Returns the image times its scale, made finite and >= 0; one white pixel if there is no image.
std::vector<Rgb> clean_pixels(const Environment& environment, Sink& sink) {
    const Image& image = environment.image;
    const bool is_empty = image.pixels.empty();
    const uint64_t count = is_empty ? 1 : uint64_t(image.width) * image.height;
    const uint32_t channels = image.channels;
    PERTEV_CHECK(is_empty || (channels >= 1 && image.pixels.size() == count * channels));
    std::vector<Rgb> pixels(count);
    std::atomic<uint64_t> negative = 0, not_a_number = 0, infinite = 0;
    const auto clean = [&](float value, float scale) {
        if (!(value >= 0)) {
            ++(value < 0 ? negative : not_a_number);
            return 0.0f;
        }
        if (!is_finite(value)) {
            ++infinite;
            value = kLargestHalf;
        }
        value = min(value * scale, 0x1p120f); // sums of these are finite
        return value < 0x1p-100f ? 0.0f : value;
    };
    parallel_for(count, 1 << 16, [&](uint64_t i) {
        const float white = 1.0f;
        const float* value = is_empty ? &white : image.pixels.data() + i * channels;
        const uint32_t g = !is_empty && channels >= 3 ? 1 : 0, b = 2 * g; // 1 or 2 channels are grey
        pixels[i] = {clean(value[0], environment.scale.r), clean(value[g], environment.scale.g),
                     clean(value[b], environment.scale.b)};
    });
    const auto warn = [&](uint64_t times, const char* what, const char* became) {
        if (times == 0) return;
        sink.warn("environment: " + std::to_string(times) + " pixel values are " + what + "; read as " + became);
    };
    warn(negative, "negative", "0");
    warn(not_a_number, "not a number", "0");
    warn(infinite, "infinite", "65504");
    return pixels;
}

/// Returns the mean sampling weight of a patch, in units of panorama_brightness.
double mean_brightness(const PanoramaCorners& corners) {
    float greatest;
    const BilinearPatch density = panorama_density(corners, greatest);
    if (!(greatest > 0)) return 0;
    const auto wide = [](float x) { return static_cast<double>(x); };
    return 0.25 * wide(greatest) * (wide(density.f00) + wide(density.f10) + wide(density.f01) + wide(density.f11));
}

} // namespace

EnvironmentData build_environment_light(const Environment& environment, Sink& sink) {
    EnvironmentData data;
    data.pixels = clean_pixels(environment, sink);
    data.constant = data.pixels[0];
    data.is_constant = std::all_of(data.pixels.begin(), data.pixels.end(), [&](Rgb p) { return p == data.constant; });
    if (data.is_constant) {
        data.pixels = {data.constant};
        data.mean_radiance = data.constant;
        data.rows = build_guided_cdf(std::array{static_cast<double>(max_component(data.constant))});
        return data;
    }

    data.width = environment.image.width;
    data.height = environment.image.height;
    const double turns = static_cast<double>(environment.rotation) / 6.283185307179586;
    data.rotation_turns = static_cast<float>(turns - std::floor(turns));
    if (data.rotation_turns >= 1.0f) data.rotation_turns = 0;
    data.row_bounds.resize(data.height / 2 + 2); // up to the row at the equator
    for (uint32_t edge = 1; edge < data.row_bounds.size(); ++edge) {
        data.row_bounds[edge] = static_cast<float>(sin_squared(1.5707963267948966 * (edge - 0.5) / data.height));
    }

    struct Sums {
        double r = 0, g = 0, b = 0;
    };
    const uint32_t rows = data.height + 1;
    std::vector<Sums> row_sums(rows); // radiance times the row's share of the sphere
    std::vector<double> row_weights(rows);
    const std::size_t starts = data.width + 1, guide = (std::size_t(1) << guide_bits_for(data.width)) + 1;
    data.columns.starts.resize(rows * starts);
    data.columns.guide.resize(rows * guide);
    EnvironmentView view; // for the rows and corners of patches
    view.width = data.width, view.height = data.height;
    view.pixels = data.pixels.data(), view.row_bounds = data.row_bounds.data();
    parallel_for(rows, 16, [&](uint64_t y) {
        const PanoramaRow row = panorama_row(view, static_cast<uint32_t>(y));
        const double share = static_cast<double>(row.upper - row.lower);
        std::vector<double> weights(data.width);
        for (uint32_t x = 0; x < data.width; ++x) {
            const PanoramaCorners corners = panorama_corners(view, x, static_cast<uint32_t>(y));
            weights[x] = share * mean_brightness(corners);
            const auto add = [&](double& sum, float upper, float lower) {
                sum += 0.5 * share * (static_cast<double>(upper) + static_cast<double>(lower));
            };
            add(row_sums[y].r, corners.upper_left.r, corners.lower_left.r);
            add(row_sums[y].g, corners.upper_left.g, corners.lower_left.g);
            add(row_sums[y].b, corners.upper_left.b, corners.lower_left.b);
        }
        row_weights[y] = build_guided_cdf(weights, std::span(data.columns.starts).subspan(y * starts, starts),
                                          std::span(data.columns.guide).subspan(y * guide, guide));
    });
    Sums sum;
    for (const Sums& s : row_sums) sum = {sum.r + s.r, sum.g + s.g, sum.b + s.b};
    const auto mean = [&](double s) { return static_cast<float>(s / data.width); };
    data.mean_radiance = {mean(sum.r), mean(sum.g), mean(sum.b)};
    data.rows = build_guided_cdf(row_weights);
    return data;
}

EnvironmentView view_of(const EnvironmentData& data) {
    return {data.width,
            data.height,
            data.pixels.data(),
            data.row_bounds.data(),
            view_of(data.rows),
            {data.columns.starts.data(), data.columns.guide.data(), data.width, guide_bits_for(data.width)},
            data.rotation_turns,
            data.is_constant,
            data.constant,
            data.mean_radiance};
}

} // namespace pertev
