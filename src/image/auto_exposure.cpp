#include "image/auto_exposure.h"

#include <algorithm>
#include <vector>

namespace pertev {
namespace {

constexpr float kMiddleGrey = 0.18f;
// Share of the counting pixels: half of what is promised, because a small picture averages highlights away.
constexpr double kBurntShare = 0.005;
constexpr double kBrightShare = 0.1;  // share of the counting pixels, like kBurntShare
constexpr float kBright = 0.8f;       // displayed value; 1 is white
constexpr double kTrimmedShare = 0.1; // at either end of the mean
constexpr int kMaxHundredths = 6000;  // hundredths of a stop

/// Light at one position of the picture, and the number of pixels that it represents.
struct Tone {
    float light; // luminance, or the largest channel
    double weight;
};

/// Luminance, weighted towards the middle of the picture, where the subject is; and the largest channel, which
/// determines what burns out, with one weight everywhere.
struct Tones {
    std::vector<Tone> luminance, largest; // from dark to bright
};

struct DoubleRgb {
    double r = 0, g = 0, b = 0;
    void add(Rgb c) {
        r += static_cast<double>(c.r);
        g += static_cast<double>(c.g);
        b += static_cast<double>(c.b);
    }
    Rgb over(double weight) const {
        return {static_cast<float>(r / weight), static_cast<float>(g / weight), static_cast<float>(b / weight)};
    }
};

/// Returns the weight of a position in the mean: 1 in the middle of the picture, 1/8 in its corners. `x` and `y` are in
/// [0, 1].
double position_weight(double x, double y) {
    const double inwards = std::max(0.0, 1 - 2 * ((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5)));
    return 0.125 + 0.875 * inwards * inwards;
}

bool has_weight(const Image& image) { return image.channels % 2 == 0; }

Rgb light_of(const Image& image, const float* pixel) {
    const Rgb light = image.channels >= 3 ? Rgb{pixel[0], pixel[1], pixel[2]} : grey(pixel[0]);
    return is_finite(light) ? light : Rgb{};
}

float weight_of(const Image& image, const float* pixel) {
    return has_weight(image) ? clamp(pixel[image.channels - 1], 0.0f, 1.0f) : 1.0f;
}

/// Returns the means of blocks, about 40 along the longer side. Logarithms of single pixels would depend on the noise:
/// few samples leave many pixels dark and a few bright, and the picture would come out too bright. Blocks without light
/// are left out.
Tones block_tones(const Image& image) {
    const uint32_t side = std::max<uint32_t>(1, std::max(image.width, image.height) / 40);
    const uint32_t columns = (image.width + side - 1) / side, rows = (image.height + side - 1) / side;
    std::vector<DoubleRgb> sums(std::size_t(columns) * rows);
    std::vector<double> weights(sums.size());
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const float* pixel = image.at(x, y);
            const float weight = weight_of(image, pixel);
            if (!(weight > 0)) continue;
            const std::size_t block = std::size_t(y / side) * columns + x / side;
            sums[block].add(light_of(image, pixel));
            weights[block] += static_cast<double>(weight);
        }
    }
    Tones tones;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        const Rgb mean = sums[i].over(weights[i]);
        const float light = luminance(mean);
        if (!(light > 0 && is_finite(mean))) continue;
        const double x = (static_cast<double>(i % columns) + 0.5) / columns;
        const double y = (static_cast<double>(i / columns) + 0.5) / rows;
        tones.luminance.push_back({light, weights[i] * position_weight(x, y)});
        tones.largest.push_back({max_component(mean), weights[i]});
    }
    std::ranges::sort(tones.luminance, {}, &Tone::light);
    std::ranges::sort(tones.largest, {}, &Tone::light);
    return tones;
}

double total_weight(const std::vector<Tone>& tones) {
    double sum = 0;
    for (const Tone& tone : tones) sum += tone.weight;
    return sum;
}

/// Mean of log2 of the luminance between the darkest and the brightest tenth.
float trimmed_log_mean(const std::vector<Tone>& tones) {
    const double all = total_weight(tones), first = kTrimmedShare * all, last = (1 - kTrimmedShare) * all;
    double sum = 0, begin = 0;
    for (const Tone& tone : tones) {
        const double end = begin + tone.weight;
        const double inside = std::min(end, last) - std::max(begin, first);
        if (inside > 0) sum += inside * static_cast<double>(log2(tone.light));
        begin = end;
    }
    return static_cast<float>(sum / (last - first));
}

/// Returns the light that is exceeded by the fraction `share` of the weight.
float light_below(const std::vector<Tone>& tones, double share) {
    double left = share * total_weight(tones);
    for (std::size_t i = tones.size(); i-- > 0;) {
        left -= tones[i].weight;
        if (left < 0) return tones[i].light;
    }
    return tones.front().light;
}

/// Converts to stops with one rounding, so that the result is the float that a reader makes of the same decimal number.
float stops_of(int hundredths) { return static_cast<float>(hundredths) / 100.0f; }

/// Returns the largest number of hundredths of a stop, at most `most`, for which `is_fine` is true. It is true up to
/// some exposure and false beyond.
template <class IsFine>
int max_fine(int most, IsFine is_fine) {
    if (is_fine(stops_of(most))) return most;
    int low = -kMaxHundredths, high = most;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        (is_fine(stops_of(middle)) ? low : high) = middle;
    }
    return low;
}

bool is_burnt(Rgb light, ToneMap kind, float scale) {
    const Rgb shown = tone_map(light, kind, scale);
    return to_byte(shown.r) == 255 && to_byte(shown.g) == 255 && to_byte(shown.b) == 255;
}

/// Returns the fraction of the counting weight that comes out white.
double burnt_share(const Image& image, ToneMap kind, float stops) {
    const float scale = exposure_scale(stops);
    double burnt = 0, all = 0;
    const std::size_t pixels = std::size_t(image.width) * image.height;
    for (std::size_t i = 0; i < pixels; ++i) {
        const float* pixel = &image.pixels[i * image.channels];
        const float weight = weight_of(image, pixel);
        if (!(weight > 0)) continue;
        all += static_cast<double>(weight);
        if (is_burnt((1 / weight) * light_of(image, pixel), kind, scale)) burnt += static_cast<double>(weight);
    }
    return burnt / all;
}

} // namespace

float auto_exposure_stops(const Image& linear, ToneMap kind) {
    const Tones tones = block_tones(linear);
    if (tones.luminance.empty()) return 0;
    const float bright = light_below(tones.largest, kBrightShare);
    const float to_grey = log2(kMiddleGrey) - trimmed_log_mean(tones.luminance);
    int hundredths = to_int(floor(100.0f * to_grey + 0.5f), -kMaxHundredths, kMaxHundredths);
    hundredths = max_fine(
        hundredths, [&](float stops) { return tone_map(grey(bright), kind, exposure_scale(stops)).g <= kBright; });
    hundredths = max_fine(hundredths, [&](float stops) { return burnt_share(linear, kind, stops) <= kBurntShare; });
    return stops_of(hundredths);
}

} // namespace pertev
