#include "formats/gltf/read_gltf.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/limits.h"
#include "base/read_file.h"
#include "formats/files/file_choices.h"
#include "formats/files/load_textures.h"
#include "formats/gltf/animations.h"
#include "formats/gltf/credits.h"
#include "formats/gltf/external_assets.h"
#include "formats/gltf/ies_lights.h"
#include "formats/gltf/image_based_light.h"
#include "formats/gltf/leave_out.h"
#include "formats/gltf/materials.h"
#include "formats/gltf/meshes.h"
#include "formats/gltf/node_shapes.h"
#include "formats/gltf/place_nodes.h"
#include "formats/gltf/textures.h"
#include "scene/scene_origin.h"

namespace pertev::gltf {
namespace {

std::vector<std::string> names_of(const std::vector<JsonValue>& elements, Buffers& buffers, Sink& sink) {
    std::vector<std::string> names;
    for (const JsonValue& element : elements) {
        names.emplace_back();
        read_or_leave_out(fmt::format("the name of {}", element.pointer()), sink,
                          [&] { names.back() = element.string_or("name", ""); });
        buffers.charge(sizeof(Clip) + names.back().size(), element);
    }
    return names;
}

/// Fills scene.variants and, by the options, scene.variant. Throws as choose.
void choose_variant(const Document& document, Buffers& buffers, const ReadOptions& options, Scene& scene, Sink& sink) {
    if (const std::optional<JsonValue> extension = document.root().extension("KHR_materials_variants")) {
        std::vector<JsonValue> variants;
        read_or_leave_out(*extension, sink, [&] { variants = extension->elements_of("variants"); });
        scene.variants = names_of(variants, buffers, sink);
    }
    if (options.variant.empty()) return;
    scene.variant = choose_material_variant(document.file(), scene.variants, options.variant);
}

/// Fills scene.clips, except for their ends, scene.file_scenes and scene.file_scene, by the options or, without any,
/// by the file: its first animation plays, and its `scene` or else its first scene is shown. Throws Error(BadInput)
/// with a list of those that exist.
void choose(const Document& document, Buffers& buffers, const ReadOptions& options, Scene& scene, Sink& sink) {
    std::vector<JsonValue> animations;
    read_or_leave_out("/animations", sink, [&] { animations = document.root().elements_of("animations"); });
    const std::vector<std::string> clips = names_of(animations, buffers, sink);
    const std::vector<bool> plays = choose_clips(document.file(), clips, options.animation);
    for (std::size_t i = 0; i < clips.size(); ++i) scene.clips.push_back({.name = clips[i], .plays = plays[i]});

    scene.file_scenes = names_of(document.table("scenes"), buffers, sink);
    if (!options.file_scene.empty()) {
        scene.file_scene = choose_file_scene(document.file(), scene.file_scenes, options.file_scene);
    } else if (const std::optional<JsonValue> chosen = document.root().find("scene");
               chosen && !scene.file_scenes.empty()) {
        read_or_leave_out(*chosen, sink, [&] { scene.file_scene = document.index_into("scenes", *chosen); });
    }
}

/// Hides what nodes that are not visible at rest hold, also of assets.
void hide_at_rest(Scene& scene) {
    if (std::ranges::all_of(scene.nodes, &Node::is_visible)) return;
    const std::vector<bool> are_visible = visible_nodes(scene.nodes, parents_first(scene.nodes));
    for (Instance& instance : scene.instances) instance.is_hidden = instance.is_hidden || !are_visible[instance.node];
    for (Light& light : scene.lights) light.is_hidden = !are_visible[light.node];
}

} // namespace

Scene read_asset(const std::filesystem::path& path, std::vector<std::byte> bytes, const FileAccess& access,
                 const ReadOptions& options, const AssetPlace& place, Sink& sink) {
    Scene scene;
    const Document document(path, std::move(bytes), sink);
    Buffers buffers(document, access, sink);
    place.budget.file_bytes += buffers.file_bytes();
    choose(document, buffers, options, scene, sink);
    choose_variant(document, buffers, options, scene, sink);
    read_credits(document, scene, sink);
    NodeGraph nodes(document, scene.file_scene, nodes_with_animated_visibility(document, scene.clips), sink,
                    place.base);
    ExternalAssets assets(document, buffers, access, nodes, options, place, sink);

    TextureLoader loader(access, sink);
    loader.shrink_to(options.max_texture_size);
    Textures textures(document, buffers, loader, sink);
    Materials materials(document, options.geometry_only ? nullptr : &textures, animated_pointers(document, scene.clips),
                        scene, sink);
    Meshes meshes(document, buffers, nodes, materials, scene, options.geometry_only, sink);
    scene.nodes = nodes.take_nodes();
    read_node_shapes(document, buffers, scene, sink);
    place_nodes(document, buffers, nodes, meshes, scene, sink);
    if (!options.geometry_only) place_ies_lights(document, buffers, access, nodes, scene, sink);
    read_animations(document, buffers, materials, scene, sink);
    if (!options.geometry_only) read_image_based_light(document, buffers, access, scene, sink);
    loader.load_into(scene, buffers.file_bytes());
    materials.convert_textures(justified_bytes(kFreeImageBytes, buffers.file_bytes()));
    assets.append_to(scene);
    hide_at_rest(scene);
    return scene;
}

} // namespace pertev::gltf

namespace pertev {

Scene read_gltf(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options, Sink& sink) {
    return read_gltf(path, read_file(path), access, options, sink);
}

Scene read_gltf(const std::filesystem::path& path, std::vector<std::byte> bytes, const FileAccess& access,
                const ReadOptions& options, Sink& sink) {
    std::error_code none;
    gltf::AssetBudget budget;
    const gltf::AssetPlace place = {.file = std::filesystem::weakly_canonical(path, none), .budget = budget};
    Scene scene = gltf::read_asset(path, std::move(bytes), access, options, place, sink);
    subtract_centre(scene);
    return scene;
}

} // namespace pertev
