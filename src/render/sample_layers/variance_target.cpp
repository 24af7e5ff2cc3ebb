#include "render/sample_layers/variance_target.h"

#include <cmath>

#include "render/sample_layers/first_hit_targets.h"

namespace pertev {
namespace {

/// A number of 106 bits as the sum of two doubles, so that the difference of large squares is exact where a pixel's
/// samples are equal.
//
// Source: Dekker, "A floating-point technique for extending the available precision", Numer. Math. 18, 1971.
struct TwoDoubles {
    double high = 0, low = 0;
};

TwoDoubles sum(double a, double b) {
    const double high = a + b, of_b = high - a;
    return {high, (a - (high - of_b)) + (b - of_b)};
}
TwoDoubles operator+(const TwoDoubles& a, const TwoDoubles& b) {
    const TwoDoubles s = sum(a.high, b.high), t = sum(a.low, b.low);
    const TwoDoubles u = sum(s.high, s.low + t.high);
    return sum(u.high, u.low + t.low);
}
TwoDoubles operator*(const TwoDoubles& a, const TwoDoubles& b) {
    const double high = a.high * b.high;
    return sum(high, std::fma(a.high, b.high, -high) + (a.high * b.low + a.low * b.high));
}
TwoDoubles operator-(const TwoDoubles& a) { return {-a.high, -a.low}; }

/// Returns a sum in units of 2^-64, times 2^`scale`.
TwoDoubles number_of(FixedSum units, int scale) {
    const bool is_negative = units.high >> 63 != 0;
    if (is_negative) units = -units;
    TwoDoubles number;
    for (const auto& [word, exponent] : {std::pair(units.high >> 32, 32),
                                         {units.high & UINT32_MAX, 0},
                                         {units.low >> 32, -32},
                                         {units.low & UINT32_MAX, -64}})
        number = number + TwoDoubles{std::ldexp(static_cast<double>(word), exponent + scale), 0};
    return is_negative ? -number : number;
}

} // namespace

double variance_of_mean(const Moments& moments, uint64_t samples) {
    if (samples < 2) return 0;
    const TwoDoubles values = number_of(moments.values, 0);
    const TwoDoubles squares = number_of(moments.squares, 0) + number_of(moments.large_squares, 48);
    const auto count = static_cast<double>(samples);
    const TwoDoubles difference = TwoDoubles{count, 0} * squares + -(values * values);
    const double excess = difference.high + difference.low; // n^2 (n - 1) times the variance of the mean
    return excess > 0 ? excess / (count * count * (count - 1)) : 0;
}

std::vector<FilmLayer> VarianceTarget::layers(uint32_t width, const RowSamples& samples) const {
    const std::vector<PixelMoments> pixels = elements().download();
    FilmLayer layer = {"variance", {"R", "G", "B"}, {width, static_cast<uint32_t>(pixels.size()) / width, 3, {}}};
    layer.image.pixels.reserve(3 * pixels.size());
    samples.visit_pixels(width, pixels.size(), [&](std::size_t first, std::size_t end, uint64_t count) {
        for (std::size_t i = first; i < end; ++i)
            for (const Moments& channel : pixels[i].channels)
                layer.image.pixels.push_back(static_cast<float>(variance_of_mean(channel, count)));
    });
    return {std::move(layer)};
}

void take_moments(Queue& queue, const Film& film) {
    const auto* const target = find_target<VarianceTarget>(film);
    PERTEV_CHECK(target != nullptr);
    const FilmView view = film.view();
    const std::size_t before = std::size_t{film.first_row()} * film.width();
    launch(queue, "take_moments", view.window.count(), TakeMoments{view, target->elements().data() + before});
    queue.wait();
}

} // namespace pertev
