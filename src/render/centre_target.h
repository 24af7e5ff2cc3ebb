#pragma once

// The target of layers at the centres of pixels (render/centre_layers.h). They belong to no sample: films of other
// samples of a picture hold the same values, or none before their first sample.

#include "render/centre_layers.h"
#include "render/film_stages.h"
#include "render/film_target.h"

namespace pertev {

class CentreTarget final : public ElementTarget<float, AddMissing, 0xff> { // AddMissing::kMissing
public:
    /// `aovs` are AovBits, of which at least one group has sums.
    CentreTarget(Queue& queue, std::size_t pixels, uint32_t aovs);

    /// The arrays of the groups, without ids.
    CentreArrays arrays() const;
    /// Number of channels of all groups of sums.
    static uint32_t channels(uint32_t aovs) { return film_channel_count(aovs) - kFilmColorChannels; }

    void show(FilmView&) const override {}
    std::vector<FilmLayer> layers(uint32_t width, const RowSamples& samples) const override;

private:
    std::size_t pixels_;
    uint32_t aovs_;
};

} // namespace pertev
