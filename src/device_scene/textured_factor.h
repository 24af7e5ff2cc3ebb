#pragma once

// A numeric parameter of a material at a point of a mesh, with its texture.

#include "device_scene/scene_view.h"

namespace pertev {

HD inline Vec2 texture_coordinate(const MeshView& mesh, const TextureRef& ref, TriangleIndices i, float u, float v) {
    const Vec2* uv = mesh.uv[ref.uv_set];
    return uv != nullptr ? interpolate(uv, i, u, v) : Vec2{0, 0};
}

/// Returns `factor` times the channel of `ref`, at barycentrics (u, v) of a triangle.
HD inline float textured_factor(const SceneView& scene, const MeshView& mesh, float factor, const TextureRef& ref,
                                TriangleIndices i, float u, float v) {
    if (!ref.has_image()) return factor;
    return factor *
           lookup_texture_channel(scene.images, ref, texture_coordinate(mesh, ref, i, u, v), scene.linear_from_srgb);
}

} // namespace pertev
