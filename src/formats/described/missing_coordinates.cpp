#include "formats/described/missing_coordinates.h"

#include <algorithm>

#include "formats/described/finish_meshes.h"

namespace pertev::described {

bool lacks_coordinates(const Parts& parts, const Placed& shape, const ShapeMesh& mesh) {
    if (!mesh.mesh.uv[0].empty()) return false;
    const Surface& surface = parts.surfaces[shape.surface];
    const auto has_own = [&](const SlotImage& image) { return (surface.material.*image.slot).uv_set != 0; };
    const auto has_alpha = [](const TextureValue& alpha) { return alpha.has_image() && !alpha.mapping; };
    return !std::ranges::all_of(surface.images, has_own) || surface.has_heights ||
           surface.material.normal_texture.has_image() || (shape.alpha && has_alpha(parts.alphas[*shape.alpha])) ||
           (shape.area_light && parts.area_lights[*shape.area_light].image.has_image());
}

void give_missing_coordinates(const Parts& parts, const Placed& shape, ShapeMesh& mesh) {
    if (!lacks_coordinates(parts, shape, mesh)) return;
    mesh.mesh = split_faces(mesh.mesh);
    for (std::size_t i = 0; i < mesh.mesh.indices.size(); ++i) {
        const std::size_t corner = i % 3;
        mesh.mesh.uv[0].push_back(parts.missing_coordinates[corner > 0 && mesh.is_turned[i / 3] ? 3 - corner : corner]);
    }
}

} // namespace pertev::described
