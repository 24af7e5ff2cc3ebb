#include "image/flip.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/parallel_for.h"
#include "image/metrics.h"
#include "math/portable_math.h"
#include "math/rgb.h"
#include "math/vec3.h"

namespace pertev {
namespace {

// Constants by the paper's names: q_c, p_c, p_t (section 4.1), w and q_f (4.2).
constexpr float kColourExponent = 0.7f, kColourKnee = 0.4f, kColourKneeValue = 0.95f;
constexpr float kFeatureWidthDegrees = 0.082f, kFeatureExponent = 0.5f;

// Linear Rec. 709 to CIE XYZ, exact fractions of the primaries and D65 of IEC 61966-2-1.
constexpr float kXyzFromRgb[3][3] = {
    {static_cast<float>(10135552.0 / 24577794), static_cast<float>(8788810.0 / 24577794),
     static_cast<float>(4435075.0 / 24577794)},
    {static_cast<float>(2613072.0 / 12288897), static_cast<float>(8788810.0 / 12288897),
     static_cast<float>(887015.0 / 12288897)},
    {static_cast<float>(1425312.0 / 73733382), static_cast<float>(8788810.0 / 73733382),
     static_cast<float>(70074185.0 / 73733382)}};
constexpr float kRgbFromXyz[3][3] = {{3.241003232976358f, -1.537398969488785f, -0.498615881996363f},
                                     {-0.969224252202516f, 1.875929983695176f, 0.041554226340085f},
                                     {0.055639419851975f, -0.204011206123910f, 1.057148977187533f}};

Vec3 multiply(const float (&m)[3][3], Vec3 v) {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

Vec3 white() { return multiply(kXyzFromRgb, {1, 1, 1}); }

// XYZ relative to white, as every opponent space here wants it.
Vec3 relative_xyz_of(Vec3 rgb) {
    const Vec3 xyz = multiply(kXyzFromRgb, rgb), w = white();
    return {xyz.x / w.x, xyz.y / w.y, xyz.z / w.z};
}

Vec3 ycxcz_of(Vec3 rgb) {
    const Vec3 v = relative_xyz_of(rgb);
    return {116.0f * v.y - 16.0f, 500.0f * (v.x - v.y), 200.0f * (v.y - v.z)};
}

Vec3 rgb_of_ycxcz(Vec3 c) {
    const float y = (c.x + 16.0f) / 116.0f;
    const Vec3 w = white();
    return multiply(kRgbFromXyz, {w.x * (y + c.y / 500.0f), w.y * y, w.z * (y - c.z / 200.0f)});
}

float lab_curve(float t) {
    constexpr float kDelta = 6.0f / 29.0f;
    return t > kDelta * kDelta * kDelta ? pow(t, 1.0f / 3.0f) : t / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
}

// CIE L*a*b*, its chroma scaled by lightness (Hunt effect): dark colours look less colourful.
Vec3 hunt_lab_of(Vec3 rgb) {
    const Vec3 v = relative_xyz_of(rgb);
    const float x = lab_curve(v.x), y = lab_curve(v.y), z = lab_curve(v.z), lightness = 116.0f * y - 16.0f;
    return {lightness, 0.01f * lightness * 500.0f * (x - y), 0.01f * lightness * 200.0f * (y - z)};
}

// HyAB: city-block between lightness and chroma, for large differences.
float hyab(Vec3 a, Vec3 b) {
    const Vec3 d = a - b;
    return abs(d.x) + sqrt(d.y * d.y + d.z * d.z);
}

using Plane = std::vector<float>;

struct Size {
    int width, height;
    std::size_t count() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

// Convolution with across(x) down(y), each of 2 radius + 1 taps; the picture's edge is repeated outwards.
Plane convolve(const Plane& from, Size size, const std::vector<float>& across, const std::vector<float>& down) {
    const int radius = static_cast<int>(across.size() / 2);
    const auto rows = static_cast<uint64_t>(size.height);
    Plane middle(size.count()), to(size.count());
    parallel_for(rows, 4, [&](uint64_t y) {
        const float* row = from.data() + y * static_cast<std::size_t>(size.width);
        std::vector<float> wide(static_cast<std::size_t>(size.width + 2 * radius)); // the row and copies of its ends
        for (int x = 0; x < size.width + 2 * radius; ++x)
            wide[static_cast<std::size_t>(x)] = row[clamp(x - radius, 0, size.width - 1)];
        float* result = middle.data() + y * static_cast<std::size_t>(size.width);
        for (int k = 0; k <= 2 * radius; ++k) {
            const float* shifted = wide.data() + k;
            const float weight = across[static_cast<std::size_t>(k)];
            for (int x = 0; x < size.width; ++x) result[x] += weight * shifted[x];
        }
    });
    parallel_for(rows, 4, [&](uint64_t y) {
        float* row = to.data() + y * static_cast<std::size_t>(size.width);
        for (int k = 0; k <= 2 * radius; ++k) {
            const int source = clamp(static_cast<int>(y) + k - radius, 0, size.height - 1);
            const float* other =
                middle.data() + static_cast<std::size_t>(source) * static_cast<std::size_t>(size.width);
            const float weight = down[static_cast<std::size_t>(k)];
            for (int x = 0; x < size.width; ++x) row[x] += weight * other[x];
        }
    });
    return to;
}

// exp(-factor x^2) at whole x.
std::vector<float> gaussian(int radius, float factor) {
    std::vector<float> taps;
    for (int x = -radius; x <= radius; ++x) taps.push_back(exp(-factor * static_cast<float>(x * x)));
    return taps;
}

float sum_of(const std::vector<float>& taps) {
    float sum = 0;
    for (const float tap : taps) sum += tap;
    return sum;
}

void scale(std::vector<float>& taps, float factor) {
    for (float& tap : taps) tap *= factor;
}

// Contrast sensitivity (paper, table 1): a1 sqrt(pi / b1) exp(-pi^2 d^2 / b1) + the same of a2, b2; d in degrees.
struct Sensitivity {
    float a1, b1, a2, b2;
};
constexpr Sensitivity kAchromatic = {1, 0.0047f, 0, 1e-5f}, kRedGreen = {1, 0.0053f, 0, 1e-5f},
                      kBlueYellow = {34.1f, 0.04f, 13.5f, 0.025f};

Plane filter(const Plane& from, Size size, const Sensitivity& s, float pixels_per_degree) {
    // One radius for all three channels: three standard deviations of the widest Gaussian.
    const int radius = to_int(3.0f * sqrt(0.04f / (2.0f * kPi * kPi)) * pixels_per_degree + 0.999999f, 1, 1 << 12);
    const float step = kPi / pixels_per_degree;
    std::vector<float> first = gaussian(radius, step * step / s.b1), second = gaussian(radius, step * step / s.b2);
    const float weight1 = s.a1 * sqrt(kPi / s.b1), weight2 = s.a2 * sqrt(kPi / s.b2);
    const float total = weight1 * square(sum_of(first)) + weight2 * square(sum_of(second));
    std::vector<float> weighted = first;
    scale(weighted, weight1 / total);
    Plane result = convolve(from, size, weighted, first);
    if (s.a2 == 0) return result;
    weighted = second;
    scale(weighted, weight2 / total);
    const Plane more = convolve(from, size, weighted, second);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] += more[i];
    return result;
}

// Taps of a derivative along one axis, with the Gaussian across it folded into the scale: positive weights of the
// two-dimensional filter sum to 1, negative ones to -1.
void normalize_signed(std::vector<float>& taps, const std::vector<float>& across) {
    float positive = 0, negative = 0;
    for (const float tap : taps) (tap > 0 ? positive : negative) += tap;
    const float other = sum_of(across);
    for (float& tap : taps) tap /= (tap > 0 ? positive : -negative) * other;
}

constexpr uint64_t kPixels = 4096; // minimum number that a thread takes at once

struct Features {
    Plane edges, points; // strength at each pixel
};

Features find_features(const Plane& lightness, Size size, float pixels_per_degree) {
    const float deviation = 0.5f * kFeatureWidthDegrees * pixels_per_degree, variance = square(deviation);
    const int radius = to_int(3.0f * deviation + 0.999999f, 1, 1 << 12);
    const std::vector<float> bell = gaussian(radius, 0.5f / variance);
    std::vector<float> edge = bell, point = bell;
    for (int i = 0; i <= 2 * radius; ++i) {
        const int x = i - radius;
        const auto k = static_cast<std::size_t>(i);
        edge[k] *= static_cast<float>(-x);
        point[k] *= static_cast<float>(x * x) / variance - 1.0f;
    }
    normalize_signed(edge, bell);
    normalize_signed(point, bell);
    const auto strength = [&](const std::vector<float>& taps) {
        Plane x = convolve(lightness, size, taps, bell);
        const Plane y = convolve(lightness, size, bell, taps);
        parallel_for(x.size(), kPixels, [&](uint64_t i) { x[i] = sqrt(x[i] * x[i] + y[i] * y[i]); });
        return x;
    };
    return {strength(edge), strength(point)};
}

// Data of one picture for the comparison.
struct Perceived {
    std::vector<Vec3> colour; // Hunt-adjusted L*a*b* after the eye's filter
    Features features;
};

float clamp_to_unit(float x) { return clamp(x, 0.0f, 1.0f); }
Vec3 clamp_to_unit(Vec3 c) { return {clamp_to_unit(c.x), clamp_to_unit(c.y), clamp_to_unit(c.z)}; }

Perceived perceive(const std::vector<Vec3>& linear, Size size, float pixels_per_degree) {
    Plane y(size.count()), cx(size.count()), cz(size.count()), lightness(size.count());
    parallel_for(linear.size(), kPixels, [&](uint64_t i) {
        const Vec3 c = ycxcz_of(clamp_to_unit(linear[i]));
        y[i] = c.x;
        cx[i] = c.y;
        cz[i] = c.z;
        lightness[i] = (c.x + 16.0f) / 116.0f;
    });
    Perceived result;
    result.features = find_features(lightness, size, pixels_per_degree);
    y = filter(y, size, kAchromatic, pixels_per_degree);
    cx = filter(cx, size, kRedGreen, pixels_per_degree);
    cz = filter(cz, size, kBlueYellow, pixels_per_degree);
    result.colour.resize(size.count());
    parallel_for(result.colour.size(), kPixels, [&](uint64_t i) {
        result.colour[i] = hunt_lab_of(clamp_to_unit(rgb_of_ycxcz({y[i], cx[i], cz[i]})));
    });
    return result;
}

// The largest colour difference there is: between the display's green and blue.
float largest_colour_difference() { return pow(hyab(hunt_lab_of({0, 1, 0}), hunt_lab_of({0, 0, 1})), kColourExponent); }

// Maps a colour difference to [0, 1], with most of the range for the differences below p_c times the largest.
float redistribute(float difference, float largest) {
    const float error = pow(difference, kColourExponent), knee = kColourKnee * largest;
    if (error < knee) return kColourKneeValue / knee * error;
    return kColourKneeValue + (error - knee) / (largest - knee) * (1.0f - kColourKneeValue);
}

Plane error_map(const Perceived& a, const Perceived& b) {
    const float largest = largest_colour_difference();
    Plane result(a.colour.size());
    parallel_for(result.size(), kPixels, [&](uint64_t i) {
        const float colour = redistribute(hyab(a.colour[i], b.colour[i]), largest);
        const float edge = abs(a.features.edges[i] - b.features.edges[i]);
        const float point = abs(a.features.points[i] - b.features.points[i]);
        const float feature = pow(clamp_to_unit(sqrt(0.5f) * max(edge, point)), kFeatureExponent);
        result[i] = clamp_to_unit(pow(colour, 1.0f - feature));
    });
    return result;
}

std::vector<Vec3> colours_of(const Image& image) {
    std::vector<Vec3> result(std::size_t(image.width) * image.height);
    for (std::size_t i = 0; i < result.size(); ++i) {
        const float* p = image.pixels.data() + i * image.channels;
        result[i] = {clamp(p[0], 0.0f, 0x1p40f), clamp(p[1], 0.0f, 0x1p40f), clamp(p[2], 0.0f, 0x1p40f)};
    }
    return result;
}

bool has_finite_color(const Image& image, std::size_t pixel) {
    const float* const p = image.pixels.data() + pixel * image.channels;
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

// A pixel without a finite colour differs by all that there is.
FlipResult result_of(Plane map, const Image& picture, const Image& reference) {
    for (std::size_t i = 0; i < map.size(); ++i) {
        if (!has_finite_color(picture, i) || !has_finite_color(reference, i)) map[i] = 1;
    }
    double sum = 0;
    for (const float error : map) sum += double(error);
    return {sum / static_cast<double>(map.size()), {picture.width, picture.height, 1, std::move(map)}};
}

Size size_of(const Image& image) { return {static_cast<int>(image.width), static_cast<int>(image.height)}; }

// Narkowicz's ACES curve with the 0.6 of exposure that goes with it (HDR paper, section 3): (k0 x^2 + k1 x) / (k3 x^2
// + k4 x + k5).
constexpr float kCurve[6] = {0.6f * 0.6f * 2.51f, 0.6f * 0.03f, 0, 0.6f * 0.6f * 2.43f, 0.6f * 0.59f, 0.14f};

float curve(float x) {
    return ((kCurve[0] * x + kCurve[1]) * x + kCurve[2]) / ((kCurve[3] * x + kCurve[4]) * x + kCurve[5]);
}

struct ExposureRange {
    float first = 0, last = 0; // stops
};

// The exposures that show the brightest pixel and the median one at 85 % of the display.
ExposureRange exposures_for(const std::vector<Vec3>& reference) {
    constexpr float kTarget = 0.85f;
    const float a = kCurve[0] - kTarget * kCurve[3], b = kCurve[1] - kTarget * kCurve[4],
                c = kCurve[2] - kTarget * kCurve[5];
    const float half = -0.5f * b / a, at_target = half + sqrt(half * half - c / a);
    std::vector<float> luminances;
    for (const Vec3 v : reference) luminances.push_back(luminance(Rgb{v.x, v.y, v.z}));
    const float brightest = *std::max_element(luminances.begin(), luminances.end());
    const auto middle = luminances.begin() + static_cast<std::ptrdiff_t>(luminances.size() / 2);
    std::nth_element(luminances.begin(), middle, luminances.end());
    const float floor_value = 0x1p-23f; // black references have an exposure too
    return {log2(at_target / max(brightest, floor_value)), log2(at_target / max(*middle, floor_value))};
}

} // namespace

FlipResult flip(const Image& picture, const Image& reference, float pixels_per_degree) {
    check_comparable(picture, reference);
    PERTEV_CHECK(pixels_per_degree > 0);
    const auto perceived = [&](const Image& image) {
        return perceive(colours_of(image), size_of(image), pixels_per_degree);
    };
    return result_of(error_map(perceived(picture), perceived(reference)), picture, reference);
}

FlipResult hdr_flip(const Image& picture, const Image& reference, float pixels_per_degree) {
    return std::move(hdr_flips({&picture}, reference, pixels_per_degree)[0]);
}

std::vector<FlipResult> hdr_flips(const std::vector<const Image*>& pictures, const Image& reference,
                                  float pixels_per_degree, Sink* sink) {
    for (const Image* picture : pictures) check_comparable(*picture, reference);
    PERTEV_CHECK(pixels_per_degree > 0);
    const std::vector<Vec3> colours_of_reference = colours_of(reference);
    std::vector<std::vector<Vec3>> colours;
    for (const Image* picture : pictures) colours.push_back(colours_of(*picture));
    const ExposureRange range = exposures_for(colours_of_reference);
    const int count = max(2, to_int(range.last - range.first + 0.999999f, 0, 64));
    std::vector<Plane> largest(pictures.size(), Plane(colours_of_reference.size()));
    for (int k = 0; k < count; ++k) {
        const float stops =
            range.first + (range.last - range.first) * static_cast<float>(k) / static_cast<float>(count - 1);
        if (sink != nullptr) sink->check();
        const auto perceived = [&, scale = exp2(stops)](const std::vector<Vec3>& from) {
            std::vector<Vec3> to(from.size());
            parallel_for(from.size(), kPixels, [&](uint64_t i) {
                const Vec3 s = min(scale * from[i], Vec3{0x1p40f, 0x1p40f, 0x1p40f}); // its square is still finite
                to[i] = {curve(s.x), curve(s.y), curve(s.z)};
            });
            return perceive(to, size_of(reference), pixels_per_degree);
        };
        const Perceived wanted = perceived(colours_of_reference);
        for (std::size_t which = 0; which < pictures.size(); ++which) {
            const Plane map = error_map(perceived(colours[which]), wanted);
            for (std::size_t i = 0; i < map.size(); ++i) largest[which][i] = max(largest[which][i], map[i]);
        }
    }
    std::vector<FlipResult> results;
    for (std::size_t which = 0; which < pictures.size(); ++which)
        results.push_back(result_of(std::move(largest[which]), *pictures[which], reference));
    return results;
}

} // namespace pertev
