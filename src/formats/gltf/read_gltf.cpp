#include "formats/gltf/read_gltf.h"

#include "base/limits.h"
#include "base/read_file.h"
#include "formats/files/load_textures.h"
#include "formats/gltf/animations.h"
#include "formats/gltf/choices.h"
#include "formats/gltf/materials.h"
#include "formats/gltf/meshes.h"
#include "formats/gltf/node_shapes.h"
#include "formats/gltf/place_nodes.h"
#include "formats/gltf/textures.h"
#include "scene/scene_origin.h"

namespace pertev {

Scene read_gltf(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options,
                Messages& messages) {
    return read_gltf(path, read_file(path), access, options, messages);
}

Scene read_gltf(const std::filesystem::path& path, std::vector<std::byte> bytes, const FileAccess& access,
                const ReadOptions& options, Messages& messages) {
    Scene scene;
    const gltf::Document document(path, std::move(bytes), messages);
    gltf::Buffers buffers(document, access, messages);
    gltf::choose(document, buffers, options, scene, messages);
    gltf::NodeGraph nodes(document, scene.file_scene, messages);

    TextureLoader loader(access, messages);
    gltf::Textures textures(document, buffers, loader, messages);
    gltf::Materials materials(document, options.geometry_only ? nullptr : &textures, scene, messages);
    gltf::Meshes meshes(document, buffers, nodes, materials, scene, options.geometry_only, messages);
    scene.nodes = nodes.take_nodes();
    gltf::read_node_shapes(document, buffers, scene, messages);
    gltf::place_nodes(document, buffers, nodes, meshes, scene, messages);
    take_off_centre(scene);
    gltf::read_animations(document, buffers, scene, messages);
    loader.load_into(scene, buffers.file_bytes());
    materials.convert_textures(justified_bytes(kFreeImageBytes, buffers.file_bytes()));

    return scene;
}

} // namespace pertev
