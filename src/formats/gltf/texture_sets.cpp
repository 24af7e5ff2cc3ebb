#include "formats/gltf/texture_sets.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace pertev::gltf {

TextureSets pack_texture_sets(MaterialParameters& material, const std::string& file, const std::string& origin,
                              Sink& sink) {
    std::vector<uint8_t> used;
    visit_textures(material, [&](const TextureRef& texture, const char*) {
        if (texture.has_image() && std::ranges::find(used, texture.uv_set) == used.end())
            used.push_back(texture.uv_set);
    });
    TextureSets sets = {0, 1};
    if (std::ranges::all_of(used, [](uint8_t set) { return set < 2; })) return sets;
    if (used.size() > kTextureSets) used.resize(kTextureSets);
    sets = used;
    if (used.size() == 1) sets.push_back(sets[0] == 0 ? 1 : 0);
    visit_textures(material, [&](TextureRef& texture, const char* name) {
        if (!texture.has_image()) return;
        const auto set = std::ranges::find(sets, texture.uv_set);
        if (set != sets.end()) {
            texture.uv_set = static_cast<uint8_t>(set - sets.begin());
            return;
        }
        sink.leave_out(
            {FileLocation{file}, fmt::format("{}: {} uses TEXCOORD_{}, and {} sets of texture coordinates are the most "
                                             "of a material; it is left out",
                                             origin, name, texture.uv_set, kTextureSets)});
        texture = {};
    });
    return sets;
}

} // namespace pertev::gltf
