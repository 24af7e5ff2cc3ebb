#pragma once

// Targets of texture coordinates at first hits and of the number of samples.

#include "render/film.h"

namespace pertev {

/// The stage that adds numbers of samples, with one call per pixel.
struct AddSampleCounts {
    const uint32_t* from;
    uint32_t* to;

    HD void operator()(uint32_t i) const { to[i] += from[i]; }
};

/// Sums over the samples that hit a surface with texture coordinates: u, v, and the number of these samples.
struct UvSum {
    FixedSum u, v, hits;
};

/// The stage that adds these sums, with one call per pixel.
struct AddUvSums {
    const UvSum* from;
    UvSum* to;

    HD void operator()(uint32_t i) const {
        to[i] = {to[i].u + from[i].u, to[i].v + from[i].v, to[i].hits + from[i].hits};
    }
};

/// Layer `uv`: the mean of the first set of texture coordinates, as the scene's file has them, over the samples that
/// hit a surface with such coordinates; 0 where none did.
class UvTarget final : public ElementTarget<UvSum, AddUvSums, 0> {
public:
    UvTarget(Queue& queue, std::size_t pixels) : ElementTarget(queue, pixels, "uv") {}
    void show(FilmView&) const override {}
    std::vector<FilmLayer> layers(uint32_t width, const RowSamples& samples) const override;
};

/// Layer `samples`: the number of samples that a pixel has taken, as a float, which is exact up to 2^24.
class CountTarget final : public ElementTarget<uint32_t, AddSampleCounts, 0> {
public:
    CountTarget(Queue& queue, std::size_t pixels) : ElementTarget(queue, pixels, "sample counts") {}
    void show(FilmView&) const override {}
    std::vector<FilmLayer> layers(uint32_t width, const RowSamples& samples) const override;
};

/// Returns the film's target of this class; null if it has none.
template <class Target>
const Target* find_target(const Film& film) {
    for (const auto& target : film.targets())
        if (const auto* const found = dynamic_cast<const Target*>(target.get())) return found;
    return nullptr;
}

} // namespace pertev
