#include "render/sample_layers/sample_layers.h"

#include <array>

#include "render/sample_layers/first_hit_targets.h"
#include "render/sample_layers/matte_target.h"
#include "render/sample_layers/variance_target.h"

namespace pertev {
namespace {

struct Row {
    SampleLayerBits bit;
    const char* name;
    uint32_t channels; // numbers of a pixel in an EXR
};
constexpr Row kRows[] = {{kLayerUv, "uv", 2},
                         {kLayerObjects, "crypto_object", 2 * kMatteRanks},
                         {kLayerMaterials, "crypto_material", 2 * kMatteRanks},
                         {kLayerCount, "samples", 1},
                         {kLayerVariance, "variance", 3}};

std::unique_ptr<FilmTarget> make_target(Queue& queue, SampleLayerBits layer, std::size_t pixels) {
    switch (layer) {
    case kLayerUv:
        return std::make_unique<UvTarget>(queue, pixels);
    case kLayerObjects:
        return std::make_unique<MatteTarget>(queue, pixels, kObjectMattes);
    case kLayerMaterials:
        return std::make_unique<MatteTarget>(queue, pixels, kMaterialMattes);
    case kLayerCount:
        return std::make_unique<CountTarget>(queue, pixels);
    case kLayerVariance:
        return std::make_unique<VarianceTarget>(queue, pixels);
    }
    PERTEV_CHECK(false);
    return nullptr;
}

} // namespace

std::optional<SampleLayerBits> sample_layer_named(std::string_view name) {
    for (const Row& row : kRows)
        if (name == row.name) return row.bit;
    return std::nullopt;
}

std::vector<std::string> sample_layer_names(uint32_t layers) {
    std::vector<std::string> names;
    for (const Row& row : kRows)
        if ((layers & row.bit) != 0) names.emplace_back(row.name);
    return names;
}

uint32_t sample_layer_channels(uint32_t layers) {
    uint32_t channels = 0;
    for (const Row& row : kRows) channels += (layers & row.bit) != 0 ? row.channels : 0;
    return channels;
}

void hold_sample_layers(Queue& queue, uint32_t layers, Film& film) {
    const std::size_t pixels = std::size_t{film.width()} * film.height();
    for (const Row& row : kRows)
        if ((layers & row.bit) != 0) film.hold(make_target(queue, row.bit, pixels));
}

uint32_t sample_layers_of(const Film& film) {
    uint32_t layers = 0;
    const auto note = [&](const auto* target, SampleLayerBits bit) { layers |= target != nullptr ? bit : 0u; };
    note(find_target<UvTarget>(film), kLayerUv);
    note(find_matte_target(film, kObjectMattes), kLayerObjects);
    note(find_matte_target(film, kMaterialMattes), kLayerMaterials);
    note(find_target<CountTarget>(film), kLayerCount);
    note(find_target<VarianceTarget>(film), kLayerVariance);
    return layers;
}

} // namespace pertev
