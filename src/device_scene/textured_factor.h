#pragma once

// A texture of a material at a point of a mesh. If the triangle's indices have a footprint, its mip-map is used.
//
// Source: Akenine-Moller et al., "Texture Level of Detail Strategies for Real-Time Ray Tracing", Ray Tracing Gems,
// 2019, chapter 20. Their level is that of the longer axis of a cone's section with the surface; ours is that of its
// area, which keeps textures sharp at grazing angles.

#include "device_scene/scene_view.h"

namespace pertev {

HD inline Vec2 texture_coordinate(const MeshView& mesh, const TextureRef& ref, TriangleIndices i, float u, float v) {
    const Vec2* uv = mesh.uv[ref.uv_set];
    return uv != nullptr ? interpolate(uv, i, u, v) : Vec2{0, 0};
}

/// Linear RGBA at barycentrics (u, v) from the mip-map of `ref`, which has an image.
HD_CALL inline Vec4 mip_mapped_texel(const SceneView& scene, const MeshView& mesh, const TextureRef& ref,
                                     TriangleIndices i, float u, float v) {
    float level = 0;
    if (const Vec2* uv = mesh.uv[ref.uv_set]; uv != nullptr) {
        const Vec2 a = uv[i.a], ab = uv[i.b] - a, ac = uv[i.c] - a;
        const TextureImageView& image = scene.images[ref.image];
        const float texels = static_cast<float>(image.width) * static_cast<float>(image.height);
        const float scale = abs(ref.m00 * ref.m11 - ref.m01 * ref.m10);
        level = mip_level(i.footprint * abs(ab.x * ac.y - ab.y * ac.x) * (scale * texels));
    }
    return lookup_mip_map(scene.images, ref, texture_coordinate(mesh, ref, i, u, v), level, scene.linear_from_srgb);
}

/// Linear RGBA of `ref`, which has an image, at barycentrics (u, v) of a triangle.
HD inline Vec4 texel_at(const SceneView& scene, const MeshView& mesh, const TextureRef& ref, TriangleIndices i, float u,
                        float v) {
    if (i.footprint > 0) return mip_mapped_texel(scene, mesh, ref, i, u, v);
    return lookup_texture(scene.images, ref, texture_coordinate(mesh, ref, i, u, v), scene.linear_from_srgb);
}

/// Returns `factor` times the channel of `ref`, at barycentrics (u, v) of a triangle.
HD inline float textured_factor(const SceneView& scene, const MeshView& mesh, float factor, const TextureRef& ref,
                                TriangleIndices i, float u, float v) {
    if (!ref.has_image()) return factor;
    if (i.footprint > 0) return factor * channel_of(mip_mapped_texel(scene, mesh, ref, i, u, v), ref.channel);
    return factor *
           lookup_texture_channel(scene.images, ref, texture_coordinate(mesh, ref, i, u, v), scene.linear_from_srgb);
}

} // namespace pertev
