#pragma once

// Reprojection: where the content of a pixel was in the previous frame.
//
// Source: Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017, section 4.1.

#include <cstdint>

#include "device_scene/scene_view.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "render/camera_view.h"

namespace pertev {

HD inline Rgb rgb_of(Float4 a) { return {a.x, a.y, a.z}; }
HD inline Vec3 vec3_of(Float4 a) { return {a.x, a.y, a.z}; }
HD inline Float4 with_w(Rgb c, float w) { return {c.r, c.g, c.b, w}; }

/// Positions of the scene's objects in the previous frame; the present ones if nothing has moved.
struct PreviousScene {
    const InstanceView* instances;
    const MeshView* meshes;
};

struct FrameCameras {
    CameraView now, before;
    uint32_t width, height; // pixels, of both frames
};

/// Returns the cameras as frames have them, whose lenses are straight (session/check_integrator.h). A kernel that says
/// so needs fewer registers.
HD inline FrameCameras with_straight_lenses(FrameCameras cameras) {
    cameras.now.lens = cameras.before.lens = {};
    return cameras;
}

/// A position in the previous frame.
struct Reprojection {
    Vec2 pixel;  // position of a pixel's centre
    float depth; // expected depth of the same surface, metres
};

/// World-space point of `hit` (GBufferView::hit).
HD inline Vec3 point_at(const InstanceView* instances, const MeshView* meshes, Float4 hit) {
    const InstanceView& instance = instances[bits_of(hit.x)];
    const MeshView& mesh = meshes[instance.mesh];
    const Vec3 local = interpolate(mesh.positions, triangle_indices(mesh, bits_of(hit.y)), hit.z, hit.w);
    return transform_point(instance.world_from_local, local);
}

/// Reprojects the pixel with this `centre`, whose sample has `hit` (GBufferView::hit). The sample lies somewhere in the
/// pixel; the centre is assumed to move with it.
HD inline Reprojection reproject_surface(const FrameCameras& cameras, const SceneView& scene,
                                         const PreviousScene& before, Vec2 centre, Float4 hit) {
    const Vec3 point = point_at(scene.instances, scene.meshes, hit);
    const bool is_still = before.instances == scene.instances && before.meshes == scene.meshes;
    const ProjectedPoint now = project_point(cameras.now, point);
    const ProjectedPoint then =
        project_point(cameras.before, is_still ? point : point_at(before.instances, before.meshes, hit));
    return {centre + (then.pixel - now.pixel), then.depth};
}

/// Minimum cosine of two normals that may belong to the same surface.
inline constexpr float kMinNormalCosine = 0.5f;
HD inline bool is_similar_depth(float seen, float depth) { return abs(seen - depth) <= 0.05f * depth; }

/// Returns whether a pixel with this normal and depth (GBufferView::normal) shows approximately the surface at `depth`
/// with this normal; otherwise it is disoccluded.
HD inline bool is_similar_surface(Float4 seen, float depth, Vec3 normal) {
    return is_similar_depth(seen.w, depth) && dot(vec3_of(seen), normal) > kMinNormalCosine;
}

} // namespace pertev
