#pragma once

// The target of Cryptomatte: the number of samples by name in each pixel. A sample has its weight in the film, which is
// the same for all, because samples are placed by the pixel filter.

#include "render/film.h"
#include "render/sample_layers/pixel_matte.h"

namespace pertev {

inline constexpr const char* kObjectMattes = "CryptoObject"; // the type, as files name it
inline constexpr const char* kMaterialMattes = "CryptoMaterial";

class MatteTarget final : public ElementTarget<PixelMatte, AddMattes, 0xff> { // kNoMatte
public:
    /// `type` is a name that outlives it.
    MatteTarget(Queue& queue, std::size_t pixels, const char* type) : ElementTarget(queue, pixels, type) {}
    void show(FilmView&) const override {}
    /// Layers TYPE00 to TYPE03 of two ranks each: R the id and G the share of samples of the first, B and A of the
    /// second. Ranks are in order of decreasing shares, then of ids. A share of 0 ends the list.
    std::vector<FilmLayer> layers(uint32_t width, const RowSamples& samples) const override;
};

/// Returns the target of a type; null if the film has none.
const MatteTarget* find_matte_target(const Film& film, std::string_view type);

/// Returns the ids that the layers of a type show, sorted; nothing if there are none of these layers.
std::vector<uint32_t> shown_mattes(std::span<const FilmLayer> layers, std::string_view type);

} // namespace pertev
