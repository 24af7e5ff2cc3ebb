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
    for (std::size_t i = 0; i < std::min<std::size_t>(used.size(), 2); ++i) sets[i] = used[i];
    if (used.size() == 1) sets[1] = sets[0] == 0 ? 1 : 0;
    visit_textures(material, [&](TextureRef& texture, const char* name) {
        if (!texture.has_image()) return;
        const auto set = std::ranges::find(sets, texture.uv_set);
        if (set != sets.end()) {
            texture.uv_set = static_cast<uint8_t>(set - sets.begin());
            return;
        }
        sink.leave_out(
            {FileLocation{file}, fmt::format("{}: {} uses TEXCOORD_{}, a third set of texture coordinates of "
                                             "the material, and is left out",
                                             origin, name, texture.uv_set)});
        texture = {};
    });
    return sets;
}

void drop_other_sets(Scene& scene, const std::string& file, Sink& sink) {
    for (Material& material : scene.materials) {
        visit_textures(material, [&](TextureRef& texture, const char* name) {
            if (texture.uv_set < 2) return;
            if (texture.has_image()) {
                sink.leave_out({FileLocation{file}, fmt::format("{}: {} uses TEXCOORD_{} and is left out",
                                                                material.origin, name, texture.uv_set)});
            }
            texture = {};
        });
    }
}

} // namespace pertev::gltf
