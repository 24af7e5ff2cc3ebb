#pragma once

// A film target that counts samples per instance in each pixel, for mattes. Its layers list the ids in order of
// coverage. The film does not depend on it.
//
// A pixel with more ids than fit keeps the smallest. These depend only on the set of samples, so parts of a film add
// up exactly: an id that is among the smallest of all is so in each part.
//
// Source: Friedman, Jones, "Fully Automatic ID Mattes with Support for Motion Blur and Transparency", SIGGRAPH 2015
// posters.

#include <algorithm>
#include <vector>

#include "integrators/path/film_listener.h"
#include "render/film.h"
#include "tests/seams/path_rounds.h"

namespace pertev::test {

/// Ids and counts of samples, in the order of ids. kNoHit follows the last one.
template <uint32_t kIds>
struct PixelCoverage {
    uint32_t ids[kIds], samples[kIds];

    HD void take(uint32_t id, uint32_t count) {
        uint32_t i = 0;
        while (i < kIds && ids[i] < id) ++i;
        if (i == kIds) return;
        if (ids[i] == id) {
            samples[i] += count;
            return;
        }
        for (uint32_t k = kIds - 1; k > i; --k) ids[k] = ids[k - 1], samples[k] = samples[k - 1];
        ids[i] = id, samples[i] = count;
    }
};

template <uint32_t kIds>
struct AddCoverage {
    const PixelCoverage<kIds>* from;
    PixelCoverage<kIds>* to;

    HD void operator()(uint32_t i) const {
        for (uint32_t k = 0; k < kIds && from[i].ids[k] != kNoHit; ++k) to[i].take(from[i].ids[k], from[i].samples[k]);
    }
};

template <uint32_t kIds>
class CoverageTarget : public ElementTarget<PixelCoverage<kIds>, AddCoverage<kIds>, 0xff> {
public:
    CoverageTarget(Queue& queue, std::size_t pixels)
        : ElementTarget<PixelCoverage<kIds>, AddCoverage<kIds>, 0xff>(queue, pixels, "coverage") {}
    void show(FilmView&) const override {}

    /// One layer: the id and the share of samples of each rank, from the largest share to the smallest. A share of 0
    /// ends the list.
    std::vector<FilmLayer> layers(uint32_t width, const RowSamples& samples) const override {
        const std::vector<PixelCoverage<kIds>> pixels = this->elements().download();
        FilmLayer layer = {"coverage", {}, {width, static_cast<uint32_t>(pixels.size()) / width, 2 * kIds, {}}};
        for (const PixelCoverage<kIds>& pixel : pixels) {
            std::vector<std::pair<uint32_t, uint32_t>> ranks; // samples, id
            for (uint32_t k = 0; k < kIds && pixel.ids[k] != kNoHit; ++k) {
                ranks.emplace_back(pixel.samples[k], pixel.ids[k]);
            }
            std::ranges::sort(ranks, std::ranges::greater());
            ranks.resize(kIds);
            for (const auto& [count, id] : ranks) {
                layer.image.pixels.push_back(static_cast<float>(id));
                layer.image.pixels.push_back(static_cast<float>(count) / static_cast<float>(samples.most()));
            }
        }
        return {layer};
    }
};

template <uint32_t kIds>
struct CoverageJob : PathJob {
    PixelCoverage<kIds>* coverage; // [pixels of the film]
};

/// A listener for the first hits of camera rays. Each pixel has one sample in flight at a time, as in PathRounds.
template <uint32_t kIds>
class CoverageListener : public PathListener<CoverageListener<kIds>> {
public:
    HD explicit CoverageListener(const CoverageJob<kIds>& job) : job_(job) {}
    HD void vertex(const PathState& path, const Hit& hit, Surface&) {
        if (path.depth == 0)
            job_.coverage[static_cast<uint32_t>(job_.film.window.slot_of(path.pixel))].take(hit.instance, 1);
    }

private:
    const CoverageJob<kIds>& job_;
};

template <uint32_t kIds>
using CoverageListeners = Listeners<FirstHitLayers, CoverageListener<kIds>>;
template <uint32_t kIds>
using CoverageRounds = PathRounds<kPlainDiffuse, CoverageListeners<kIds>, CoverageJob<kIds>>;

extern template class PathRounds<kPlainDiffuse, CoverageListeners<2>, CoverageJob<2>>; // seam_stages.cu
extern template class PathRounds<kPlainDiffuse, CoverageListeners<6>, CoverageJob<6>>;

} // namespace pertev::test
