#pragma once

// Layers that take something of every sample besides its light: texture coordinates, coverage by named objects and
// materials (Cryptomatte), the number of samples and the variance. Each is a target of its own in the film
// (render/film_target.h), of exact sums, so that parts add up to the whole. Integrators know nothing of them: first
// hits are traced once more (first_hits.h), and for the variance each sample is rendered alone (variance_target.h).

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/film.h"

namespace pertev {

/// Bits of the layers of samples: uv, mattes, counts and variance.
enum SampleLayerBits : uint32_t {
    kLayerUv = 1,
    kLayerObjects = 2,
    kLayerMaterials = 4,
    kLayerCount = 8,
    kLayerVariance = 16,
};

/// Layers for which first hits are traced.
inline constexpr uint32_t kFirstHitLayers = kLayerUv | kLayerObjects | kLayerMaterials;

/// Returns the layer of this name; nothing for another name.
std::optional<SampleLayerBits> sample_layer_named(std::string_view name);
/// Returns the names of `layers` in the order of their bits.
std::vector<std::string> sample_layer_names(uint32_t layers = ~0u);

/// Returns the numbers in a row of an EXR that the layers take.
uint32_t sample_layer_channels(uint32_t layers);

/// Adds the targets of the layers to a film, in the order of their bits.
void hold_sample_layers(Queue& queue, uint32_t layers, Film& film);
/// Returns the layers whose targets a film has.
uint32_t sample_layers_of(const Film& film);

} // namespace pertev
