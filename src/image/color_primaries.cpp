#include "image/color_primaries.h"

#include <cmath>
#include <cstddef>

#include "base/parallel_for.h"
#include "math/scalar.h"

namespace pertev {
namespace {

using Triple = std::array<double, 3>;

constexpr double kLargest = 4;
constexpr double kMinDeterminant = 1e-4; // the primaries of Rec. 709 have 0.11

constexpr ColorMatrix kBradford = {{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};

Triple multiply(const ColorMatrix& m, const Triple& v) {
    Triple to = {};
    for (std::size_t i = 0; i < 3; ++i) to[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    return to;
}

ColorMatrix multiply(const ColorMatrix& a, const ColorMatrix& b) {
    ColorMatrix to = {};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) to[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    return to;
}

double cofactor(const ColorMatrix& m, std::size_t row, std::size_t column) {
    const std::size_t r0 = (row + 1) % 3, r1 = (row + 2) % 3, c0 = (column + 1) % 3, c1 = (column + 2) % 3;
    return m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
}

double determinant(const ColorMatrix& m) {
    return m[0][0] * cofactor(m, 0, 0) + m[0][1] * cofactor(m, 0, 1) + m[0][2] * cofactor(m, 0, 2);
}

ColorMatrix inverse(const ColorMatrix& m) {
    const double scale = determinant(m);
    ColorMatrix to = {};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) to[i][j] = cofactor(m, j, i) / scale;
    return to;
}

/// Returns X, Y and Z of a white of luminance 1.
Triple white_of(const Chromaticity& c) { return {c.x / c.y, 1, (1 - c.x - c.y) / c.y}; }

/// Returns the matrix from R, G, B to X, Y, Z; nothing if the primaries are degenerate.
std::optional<ColorMatrix> xyz_from(const ColorPrimaries& p) {
    for (const Chromaticity& c : {p.red, p.green, p.blue, p.white}) {
        if (!(std::abs(c.x) <= kLargest && std::abs(c.y) <= kLargest)) return std::nullopt;
    }
    if (!(p.white.y > 0)) return std::nullopt;
    ColorMatrix to = {{{p.red.x, p.green.x, p.blue.x},
                       {p.red.y, p.green.y, p.blue.y},
                       {1 - p.red.x - p.red.y, 1 - p.green.x - p.green.y, 1 - p.blue.x - p.blue.y}}};
    if (std::abs(determinant(to)) < kMinDeterminant) return std::nullopt;
    const Triple amounts = multiply(inverse(to), white_of(p.white));
    for (std::size_t j = 0; j < 3; ++j) {
        if (!(amounts[j] > 0)) return std::nullopt;
        for (std::size_t i = 0; i < 3; ++i) to[i][j] *= amounts[j];
    }
    return to;
}

/// Returns the chromatic adaptation of X, Y, Z from one white to another; nothing if it is degenerate.
std::optional<ColorMatrix> adaptation(const Chromaticity& from, const Chromaticity& to) {
    const Triple before = multiply(kBradford, white_of(from)), after = multiply(kBradford, white_of(to));
    ColorMatrix gains = {};
    for (std::size_t i = 0; i < 3; ++i) {
        if (!(before[i] > 0)) return std::nullopt;
        gains[i][i] = after[i] / before[i];
    }
    return multiply(inverse(kBradford), multiply(gains, kBradford));
}

} // namespace

bool is_rec709(const ColorPrimaries& primaries) {
    const auto is_near = [](const Chromaticity& a, const Chromaticity& b) {
        return std::abs(a.x - b.x) <= 0.0005 && std::abs(a.y - b.y) <= 0.0005;
    };
    return is_near(primaries.red, kRec709.red) && is_near(primaries.green, kRec709.green) &&
           is_near(primaries.blue, kRec709.blue) && is_near(primaries.white, kRec709.white);
}

std::optional<ColorMatrix> rec709_from(const ColorPrimaries& primaries) {
    const std::optional<ColorMatrix> from = xyz_from(primaries), ours = xyz_from(kRec709);
    if (!from) return std::nullopt;
    const std::optional<ColorMatrix> adapted = adaptation(primaries.white, kRec709.white);
    if (!adapted) return std::nullopt;
    return multiply(inverse(*ours), multiply(*adapted, *from));
}

void convert_colors(const ColorMatrix& matrix, Image& image) {
    if (image.channels < 3) return;
    const std::size_t row = std::size_t(image.width) * image.channels;
    parallel_for(image.height, 16, [&](uint64_t y) {
        float* pixel = image.pixels.data() + y * row;
        for (float* const end = pixel + row; pixel != end; pixel += image.channels) {
            const Triple rgb = {double(pixel[0]), double(pixel[1]), double(pixel[2])};
            const Triple to = multiply(matrix, rgb);
            const float r = float(to[0]), g = float(to[1]), b = float(to[2]);
            if (!is_finite(r) || !is_finite(g) || !is_finite(b)) continue;
            pixel[0] = r, pixel[1] = g, pixel[2] = b;
        }
    });
}

} // namespace pertev
