#include "render/sample_layers/first_hit_targets.h"

namespace pertev {

std::vector<FilmLayer> UvTarget::layers(uint32_t width, const RowSamples&) const {
    const std::vector<UvSum> sums = elements().download();
    FilmLayer layer = {"uv", {"u", "v"}, {width, static_cast<uint32_t>(sums.size()) / width, 2, {}}};
    layer.image.pixels.reserve(2 * sums.size());
    for (const UvSum& sum : sums) {
        const uint64_t hits = sum.hits.high; // each hit adds one, which is 2^64 units
        layer.image.pixels.push_back(hits == 0 ? 0.0f : mean_of(sum.u, hits));
        layer.image.pixels.push_back(hits == 0 ? 0.0f : mean_of(sum.v, hits));
    }
    return {std::move(layer)};
}

std::vector<FilmLayer> CountTarget::layers(uint32_t width, const RowSamples&) const {
    const std::vector<uint32_t> counts = elements().download();
    FilmLayer layer = {"samples", {"N"}, {width, static_cast<uint32_t>(counts.size()) / width, 1, {}}};
    layer.image.pixels.assign(counts.begin(), counts.end());
    return {std::move(layer)};
}

} // namespace pertev
