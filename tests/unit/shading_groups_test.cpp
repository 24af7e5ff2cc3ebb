#include <algorithm>
#include <cstdlib>
#include <vector>

#include <doctest/doctest.h>

#include "shading/shading_groups.h"

using namespace pertev;

namespace {

MaterialParameters grouped_kind(MaterialKind kind) {
    MaterialParameters material;
    material.kind = kind;
    return material;
}

} // namespace

TEST_CASE("materials share a shading group if they have the same kinds of lobes and textures") {
    std::vector<MaterialParameters> materials(7, grouped_kind(MaterialKind::MetallicRoughness));
    materials[1] = grouped_kind(MaterialKind::Diffuse);
    materials[2].roughness = 0.3f, materials[2].base_color = {1, 0, 0}; // numbers alone
    materials[3].coat_weight = 0.5f;
    materials[4].coat_weight = 1, materials[4].coat_ior = 1.3f;
    materials[5].coat_weight = 1, materials[5].base_color_texture.image = 0;
    materials[6] = grouped_kind(MaterialKind::Conductor);
    const std::vector<uint8_t> groups = shading_groups(materials);
    CHECK(groups[0] == groups[2]);
    CHECK(groups[3] == groups[4]);
    std::vector<uint8_t> others = {groups[0], groups[1], groups[3], groups[5], groups[6]};
    std::ranges::sort(others);
    CHECK(others == std::vector<uint8_t>{1, 2, 3, 4, 5});
    CHECK(std::abs(groups[3] - groups[5]) == 1); // coats with and without a texture are adjacent
    CHECK(std::max(groups[3], groups[5]) == 5);  // stacks come last
}

TEST_CASE("the last shading group takes the rest of many kinds of materials") {
    std::vector<MaterialParameters> materials;
    for (int i = 0; i < 64; ++i) {
        MaterialParameters material = grouped_kind(MaterialKind::MetallicRoughness);
        if ((i & 1) != 0) material.coat_weight = 1;
        if ((i & 2) != 0) material.transmission_weight = 1;
        if ((i & 4) != 0) material.thin_film_weight = 1;
        if ((i & 8) != 0) material.fuzz_weight = 1;
        if ((i & 16) != 0) material.base_color_texture.image = 0;
        if ((i & 32) != 0) material.normal_texture.image = 0;
        materials.push_back(material);
    }
    const std::vector<uint8_t> groups = shading_groups(materials);
    CHECK(*std::ranges::min_element(groups) == 1);
    CHECK(std::ranges::count(groups, kMaxShadingGroup) == 35);
    CHECK(*std::ranges::max_element(groups) == kMaxShadingGroup);
    CHECK(shading_groups({}).empty());
}
