#include "render/film.h"

#include <span>

#include "base/parallel_for.h"

namespace pertev {
namespace {

struct AovLayout {
    AovBits bit;
    const char* name;
    std::vector<std::string> channels;
    bool over_hits; // mean over the samples that hit, not over all
};

const std::vector<AovLayout>& aov_layouts() {
    static const std::vector<AovLayout> layouts = {
        {kAovAlbedo, "albedo", {"R", "G", "B"}, false},
        {kAovNormal, "normal", {"X", "Y", "Z"}, true},
        {kAovDepth, "depth", {"Z"}, true},
        {kAovPosition, "position", {"X", "Y", "Z"}, true},
    };
    return layouts;
}

uint32_t channel_count(uint32_t aovs) {
    uint32_t count = kFilmColorChannels;
    for (const AovLayout& layout : aov_layouts()) {
        if ((aovs & layout.bit) != 0) count += static_cast<uint32_t>(layout.channels.size());
    }
    return count;
}

} // namespace

Film::Film(Queue& queue, uint32_t width, uint32_t height, uint32_t aovs)
    : width_(width), height_(height), aovs_(aovs), channels_(channel_count(aovs)),
      sums_(queue, std::size_t(width) * height * channels_, "film"),
      ids_(queue, (aovs & kAovIds) != 0 ? std::size_t(width) * height : 0, "film ids"),
      invalid_(queue, 1, "invalid samples") {
    clear();
}

std::size_t Film::predicted_bytes(uint32_t width, uint32_t height, uint32_t aovs) {
    const std::size_t of_pixel =
        channel_count(aovs) * sizeof(FixedSum) + ((aovs & kAovIds) != 0 ? sizeof(PixelIds) : 0);
    return std::size_t(width) * height * of_pixel + sizeof(uint64_t);
}

void Film::clear() {
    sums_.zero();
    ids_.zero();
    invalid_.zero();
}

FilmView Film::view() const { return {sums_.data(), ids_.data(), invalid_.data(), channels_, aovs_, width_, height_}; }

Image Film::picture(uint64_t samples, bool transparent) const {
    std::vector<FixedSum> copy;
    const std::span<const FixedSum> sums = sums_.read(copy);
    Image image{width_, height_, transparent ? 4u : 3u, {}};
    image.pixels.resize(std::size_t(width_) * height_ * image.channels);
    parallel_for(std::size_t(width_) * height_, 4096, [&](uint64_t pixel) {
        for (uint32_t c = 0; c < image.channels; ++c) {
            image.pixels[pixel * image.channels + c] = mean_of(sums[pixel * channels_ + c], samples);
        }
    });
    return image;
}

std::vector<FilmLayer> Film::layers(uint64_t samples) const {
    std::vector<FilmLayer> layers;
    if ((aovs_ & ~static_cast<uint32_t>(kAovIds)) == 0) return layers;
    std::vector<FixedSum> copy;
    const std::span<const FixedSum> sums = sums_.read(copy);
    uint32_t first = kFilmColorChannels;
    for (const AovLayout& layout : aov_layouts()) {
        if ((aovs_ & layout.bit) == 0) continue;
        const auto channels = static_cast<uint32_t>(layout.channels.size());
        FilmLayer layer{layout.name, layout.channels, {width_, height_, channels, {}}};
        layer.image.pixels.resize(std::size_t(width_) * height_ * channels);
        parallel_for(std::size_t(width_) * height_, 4096, [&](uint64_t pixel) {
            const FixedSum* sum = &sums[pixel * channels_];
            const uint64_t hits = sum[3].high; // ones are 2^64 units
            const uint64_t count = layout.over_hits ? hits : samples;
            for (uint32_t c = 0; c < channels; ++c) {
                layer.image.pixels[pixel * channels + c] = count == 0 ? 0.0f : mean_of(sum[first + c], count);
            }
        });
        layers.push_back(std::move(layer));
        first += channels;
    }
    return layers;
}

} // namespace pertev
