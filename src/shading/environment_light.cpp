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

/// sin^2(x) for x in [0, pi / 2], by its series: the same bits whatever the C library.
double sin_squared(double x) {
    double term = x, sum = x;
    for (int k = 1; k <= 12; ++k) {
        term *= -x * x / ((2.0 * k) * (2.0 * k + 1.0));
        sum += term;
    }
    return sum * sum;
}

/// Image times scale, made finite and >= 0; one white pixel where there is no image.
std::vector<Rgb> clean_pixels(const Environment& environment, Messages& messages) {
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
        return clamp(value * scale, 0.0f, 0x1.fffffep127f);
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
        messages.warn("environment: " + std::to_string(times) + " pixel values are " + what + "; taken as " + became);
    };
    warn(negative, "negative", "0");
    warn(not_a_number, "not a number", "0");
    warn(infinite, "infinite", "65504");
    return pixels;
}

/// Mean of f^2 over a unit square, f bilinear with these corner values.
double mean_square(double f00, double f10, double f01, double f11) {
    return (f00 * f00 + f10 * f10 + f01 * f01 + f11 * f11 + f00 * f10 + f00 * f01 + f10 * f11 + f01 * f11) / 9.0 +
           (f00 * f11 + f10 * f01) / 18.0;
}

/// Root mean square of the bilinearly filtered image over texel x of the middle of three rows, each [width].
double filtered_rms(const std::array<const Rgb*, 3>& rows, uint32_t x, uint32_t width) {
    const std::array<uint32_t, 3> columns = {x == 0 ? width - 1 : x - 1, x, x + 1 == width ? 0 : x + 1};
    double f[3][3];
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const Rgb p = rows[i][columns[j]];
            f[i][j] = static_cast<double>(p.r) + static_cast<double>(p.g) + static_cast<double>(p.b);
        }
    }
    double sum = 0;
    for (const std::size_t i : {0, 2}) {
        for (const std::size_t j : {0, 2}) { // the quarter of the texel towards that corner
            sum += mean_square(f[1][1], 0.5 * (f[1][1] + f[1][j]), 0.5 * (f[1][1] + f[i][1]),
                               0.25 * (f[1][1] + f[1][j] + f[i][1] + f[i][j]));
        }
    }
    return std::sqrt(0.25 * sum);
}

} // namespace

EnvironmentData build_environment_light(const Environment& environment, Messages& messages) {
    EnvironmentData data;
    data.pixels = clean_pixels(environment, messages);
    data.constant = data.pixels[0];
    data.is_constant = std::all_of(data.pixels.begin(), data.pixels.end(), [&](Rgb p) { return p == data.constant; });
    if (data.is_constant) {
        data.pixels = {data.constant};
        data.mean_radiance = data.constant;
        data.rows = build_ordered_table(std::array{static_cast<double>(max_component(data.constant))});
        return data;
    }

    data.width = environment.image.width;
    data.height = environment.image.height;
    const double turns = static_cast<double>(environment.rotation) / 6.283185307179586;
    data.rotation_turns = static_cast<float>(turns - std::floor(turns));
    if (data.rotation_turns >= 1.0f) data.rotation_turns = 0;
    data.row_bounds.resize(data.height + 1);
    for (uint32_t y = 0; y <= data.height; ++y) {
        data.row_bounds[y] = static_cast<float>(sin_squared(1.5707963267948966 * y / data.height));
    }

    struct Sums {
        double r = 0, g = 0, b = 0;
    };
    std::vector<Sums> row_sums(data.height); // of pixel times the row's share of the sphere
    std::vector<double> row_weights(data.height);
    const std::size_t starts = data.width + 1, guide = (std::size_t(1) << guide_bits_for(data.width)) + 1;
    data.columns.starts.resize(data.height * starts);
    data.columns.guide.resize(data.height * guide);
    const auto row = [&](uint64_t y) { return data.pixels.data() + y * data.width; };
    parallel_for(data.height, 16, [&](uint64_t y) {
        const uint64_t from_pole = std::min<uint64_t>(y, data.height - 1 - y);
        const double share = static_cast<double>(data.row_bounds[from_pole + 1] - data.row_bounds[from_pole]);
        const std::array<const Rgb*, 3> rows = {row(y == 0 ? 0 : y - 1), row(y),
                                                row(std::min<uint64_t>(y + 1, data.height - 1))};
        std::vector<double> weights(data.width);
        for (uint32_t x = 0; x < data.width; ++x) {
            weights[x] = share * filtered_rms(rows, x, data.width);
            row_sums[y].r += share * static_cast<double>(rows[1][x].r);
            row_sums[y].g += share * static_cast<double>(rows[1][x].g);
            row_sums[y].b += share * static_cast<double>(rows[1][x].b);
        }
        row_weights[y] = build_ordered_table(weights, std::span(data.columns.starts).subspan(y * starts, starts),
                                             std::span(data.columns.guide).subspan(y * guide, guide));
    });
    Sums sum;
    for (const Sums& s : row_sums) sum = {sum.r + s.r, sum.g + s.g, sum.b + s.b};
    const auto mean = [&](double s) { return static_cast<float>(s / data.width); };
    data.mean_radiance = {mean(sum.r), mean(sum.g), mean(sum.b)};
    data.rows = build_ordered_table(row_weights);
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
