#include "render/sample_layers/matte_target.h"

#include <algorithm>
#include <array>
#include <bit>
#include <set>

#include <fmt/format.h>

namespace pertev {
namespace {

constexpr uint32_t kRanksOfLayer = 2;

struct Rank {
    uint32_t samples = 0, id = 0;
};

/// Returns the ranks of a pixel, with empty ones at the end.
std::array<Rank, kMatteIds> ranks_of(const PixelMatte& pixel) {
    std::array<Rank, kMatteIds> ranks;
    for (uint32_t k = 0; k < kMatteIds && pixel.ids[k] != kNoMatte; ++k) ranks[k] = {pixel.samples[k], pixel.ids[k]};
    std::ranges::sort(ranks, [](const Rank& a, const Rank& b) {
        return a.samples != b.samples ? a.samples > b.samples : a.id < b.id;
    });
    return ranks;
}

} // namespace

std::vector<FilmLayer> MatteTarget::layers(uint32_t width, const RowSamples& samples) const {
    const std::vector<PixelMatte> pixels = elements().download();
    std::vector<FilmLayer> layers;
    for (uint32_t k = 0; k < kMatteRanks / kRanksOfLayer; ++k) {
        FilmLayer& layer = layers.emplace_back(FilmLayer{fmt::format("{}{:02}", name(), k), {"R", "G", "B", "A"}, {}});
        layer.image = {width, static_cast<uint32_t>(pixels.size()) / width, 2 * kRanksOfLayer, {}};
        layer.image.pixels.reserve(pixels.size() * 2 * kRanksOfLayer);
    }
    samples.visit_pixels(width, pixels.size(), [&](std::size_t first, std::size_t end, uint64_t count) {
        for (std::size_t i = first; i < end; ++i) {
            const std::array<Rank, kMatteIds> ranks = ranks_of(pixels[i]);
            for (uint32_t k = 0; k < kMatteRanks; ++k) {
                std::vector<float>& to = layers[k / kRanksOfLayer].image.pixels;
                to.push_back(std::bit_cast<float>(ranks[k].id));
                to.push_back(count == 0 ? 0.0f : mean_of({0, ranks[k].samples}, count));
            }
        }
    });
    return layers;
}

const MatteTarget* find_matte_target(const Film& film, std::string_view type) {
    for (const auto& target : film.targets()) {
        const auto* const mattes = dynamic_cast<const MatteTarget*>(target.get());
        if (mattes != nullptr && type == mattes->name()) return mattes;
    }
    return nullptr;
}

std::vector<uint32_t> shown_mattes(std::span<const FilmLayer> layers, std::string_view type) {
    std::set<uint32_t> ids;
    for (const FilmLayer& layer : layers) {
        if (!layer.name.starts_with(type)) continue;
        uint32_t last = 0; // neighbours mostly show the same
        for (std::size_t i = 0; i + 1 < layer.image.pixels.size(); i += 2) {
            const auto id = std::bit_cast<uint32_t>(layer.image.pixels[i]);
            if (id != last && layer.image.pixels[i + 1] > 0) ids.insert(id);
            last = id;
        }
    }
    return {ids.begin(), ids.end()};
}

} // namespace pertev
