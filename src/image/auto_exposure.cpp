#include "image/auto_exposure.h"

#include <algorithm>
#include <vector>

namespace pertev {
namespace {

constexpr float kMiddleGrey = 0.18f;
constexpr double kBurntShare = 0.005; // of all pixels: half of what is promised, for what a small picture averages away
constexpr double kBrightShare = 0.1;  // of what counts
constexpr float kBright = 0.8f;       // as shown: 1 is white
constexpr double kTrimmedShare = 0.1; // at either end of the mean
constexpr int kMostHundredths = 6000; // of a stop

/// Light of one place in the picture, and how many pixels it stands for.
struct Tone {
    float luminance;
    double weight;
};

bool has_weight(const Image& image) { return image.channels % 2 == 0; }

Rgb light_of(const Image& image, const float* pixel) {
    const Rgb light = image.channels >= 3 ? Rgb{pixel[0], pixel[1], pixel[2]} : grey(pixel[0]);
    return is_finite(light) ? light : Rgb{};
}

float weight_of(const Image& image, const float* pixel) {
    return has_weight(image) ? clamp(pixel[image.channels - 1], 0.0f, 1.0f) : 1.0f;
}

/// Mean luminance of each of about 40 blocks along the longer side, from dark to bright. Of single pixels the
/// logarithms would tell of the noise: few samples leave many pixels dark and a few bright, and the picture would come
/// out too bright. Blocks without light tell nothing.
std::vector<Tone> block_tones(const Image& image) {
    const uint32_t side = std::max<uint32_t>(1, std::max(image.width, image.height) / 40);
    const uint32_t columns = (image.width + side - 1) / side, rows = (image.height + side - 1) / side;
    std::vector<double> sums(std::size_t(columns) * rows), weights(sums.size());
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const float* pixel = image.at(x, y);
            const float weight = weight_of(image, pixel);
            if (!(weight > 0)) continue;
            const std::size_t block = std::size_t(y / side) * columns + x / side;
            sums[block] += static_cast<double>(luminance(light_of(image, pixel)));
            weights[block] += static_cast<double>(weight);
        }
    }
    std::vector<Tone> tones;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const auto mean = static_cast<float>(sums[i] / weights[i]); // 0 / 0 is none
        if (mean > 0 && is_finite(mean)) tones.push_back({mean, weights[i]});
    }
    std::ranges::sort(tones, {}, &Tone::luminance);
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
        if (inside > 0) sum += inside * static_cast<double>(log2(tone.luminance));
        begin = end;
    }
    return static_cast<float>(sum / (last - first));
}

/// Luminance that `share` of the weight lies above.
float luminance_below(const std::vector<Tone>& tones, double share) {
    double left = share * total_weight(tones);
    for (std::size_t i = tones.size(); i-- > 0;) {
        left -= tones[i].weight;
        if (left < 0) return tones[i].luminance;
    }
    return tones.front().luminance;
}

/// Rounded once, so that it is the float that a reader makes of the same number in decimals.
float stops_of(int hundredths) { return static_cast<float>(hundredths) / 100.0f; }

/// The most hundredths of a stop, `most` or fewer, that are fine: all are up to some exposure, and none beyond.
template <class IsFine>
int most_that_are_fine(int most, IsFine is_fine) {
    if (is_fine(stops_of(most))) return most;
    int low = -kMostHundredths, high = most;
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

/// Share of all pixels that come out white of light that counts.
double burnt_share(const Image& image, ToneMap kind, float stops) {
    const float scale = exposure_scale(stops);
    double burnt = 0;
    const std::size_t pixels = std::size_t(image.width) * image.height;
    for (std::size_t i = 0; i < pixels; ++i) {
        const float* pixel = &image.pixels[i * image.channels];
        const float weight = weight_of(image, pixel);
        if (weight > 0 && is_burnt((1 / weight) * light_of(image, pixel), kind, scale)) {
            burnt += static_cast<double>(weight);
        }
    }
    return burnt / static_cast<double>(pixels);
}

} // namespace

float auto_exposure_stops(const Image& linear, ToneMap kind) {
    const std::vector<Tone> tones = block_tones(linear);
    if (tones.empty()) return 0;
    const float bright = luminance_below(tones, kBrightShare);
    const float to_grey = log2(kMiddleGrey) - trimmed_log_mean(tones);
    int hundredths = to_int(floor(100.0f * to_grey + 0.5f), -kMostHundredths, kMostHundredths);
    hundredths = most_that_are_fine(
        hundredths, [&](float stops) { return tone_map(grey(bright), kind, exposure_scale(stops)).g <= kBright; });
    hundredths =
        most_that_are_fine(hundredths, [&](float stops) { return burnt_share(linear, kind, stops) <= kBurntShare; });
    return stops_of(hundredths);
}

} // namespace pertev
