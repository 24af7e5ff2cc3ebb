#include "shading/shading_groups.h"

#include <algorithm>

namespace pertev {
namespace {

/// Returns a number for the kinds of lobes and textures of a material. The higher a bit, the more code it decides.
uint32_t code_of(const MaterialParameters& m) {
    uint32_t code = m.is_stacked() ? 1 : 0;
    const auto add = [&](bool has) { code = 2 * code + (has ? 1 : 0); };
    for (const MaterialKind kind :
         {MaterialKind::MetallicRoughness, MaterialKind::Dielectric, MaterialKind::Conductor, MaterialKind::Diffuse}) {
        add(m.kind == kind);
    }
    add(m.has_coat());
    add(m.transmits());
    add(m.has_thin_film());
    add(m.has_fuzz());
    add(m.has_diffuse_transmission());
    add(m.has_other_microfacets());
    add(m.base_color_texture.has_image());
    add(m.normal_texture.has_image());
    return code;
}

} // namespace

std::vector<uint8_t> shading_groups(std::span<const MaterialParameters> materials) {
    std::vector<uint32_t> codes;
    for (const MaterialParameters& material : materials) codes.push_back(code_of(material));
    std::vector<uint32_t> kinds = codes;
    std::ranges::sort(kinds);
    kinds.erase(std::ranges::unique(kinds).begin(), kinds.end());
    std::vector<uint8_t> groups;
    for (const uint32_t code : codes) {
        const auto rank = std::ranges::lower_bound(kinds, code) - kinds.begin();
        groups.push_back(static_cast<uint8_t>(std::min<std::ptrdiff_t>(rank + 1, kMaxShadingGroup)));
    }
    return groups;
}

} // namespace pertev
