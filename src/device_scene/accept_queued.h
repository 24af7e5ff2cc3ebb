#pragma once

// Acceptance rules for queued rays in kernels (device_scene/accept_hit.h): nothing is held in registers during
// traversal. Data of the ray is loaded when there is a candidate, which is seldom.

#include <cstdint>

#include "device_scene/accept_hit.h"
#include "device_scene/ray_queue.h"

namespace pertev {

/// Surfaces that rays pass through whatever their alpha: a sum of these.
enum RayPasses : uint32_t {
    kPassesCulledBacks = 1, // camera rays
    kPassesThinWalls = 2,   // AcceptHit::passes_thin_walls
};

/// Rays, and the data for accepting their candidates.
struct TraceQuery {
    RayQueueView rays;
    // In device memory; null if every surface is opaque and has no culled back for these rays.
    const SceneView* scene = nullptr;
    const uint32_t* passing = nullptr;              // mask of SceneView
    const OpacityMicromapView* micromaps = nullptr; // in device memory; null for rays that pass through backs, for
                                                    // which that is tested first
    const SceneView* moving = nullptr;              // in device memory; null if nothing moves while the shutter is
                                                    // open
    uint32_t passes = 0;                            // RayPasses

    bool is_opaque() const { return scene == nullptr; }
};

/// Returns whether the candidate counts on an instance at rest that may let rays pass. It is not inlined, so that its
/// texture lookups cost the traversal no registers.
HD_CALL inline bool passes_surface(const SceneView* scene, const Ray* ray, uint32_t key, uint32_t passes,
                                   uint32_t instance, uint32_t primitive, float u, float v) {
    if ((passes & kPassesCulledBacks) != 0 && hides_side(*scene, ray->direction, instance, primitive)) return true;
    if ((passes & kPassesThinWalls) != 0 && scene->instances[instance].is_thin_wall != 0) return true;
    return scene->any_alpha != 0 && !AcceptHit{*scene, {}, {}, key}.passes_alpha(instance, primitive, u, v);
}

/// Returns whether the candidate counts on an instance that may have moved. `time` is null if nothing moves while the
/// shutter is open.
HD_CALL inline bool passes_moved_surface(const SceneView* scene, const Ray* ray, uint32_t key, uint32_t passes,
                                         const float* time, uint32_t instance, uint32_t primitive, float u, float v) {
    const AcceptHit accept{*scene, {}, {}, key, time != nullptr ? *time : kAtRest};
    if ((passes & kPassesCulledBacks) != 0 &&
        AcceptCameraHit{accept, ray->direction}.hits_hidden_back(instance, primitive)) {
        return true;
    }
    if ((passes & kPassesThinWalls) != 0 && scene->instances[instance].is_thin_wall != 0) return true;
    return scene->any_alpha != 0 && !accept.passes_alpha(instance, primitive, u, v);
}

/// Origin and direction of a ray relative to an instance that has moved. The computation is not inlined, so that
/// static instances do not pay for it.
struct MovedLine {
    Vec3 origin, direction;
};
HD_CALL inline MovedLine moved_back(const SceneView* scene, uint32_t motion, const float* time, const Ray* ray) {
    const RigidMotion now = scene->motions.at(motion, time != nullptr ? *time : kAtRest);
    return {now.move_back(ray->origin), now.rotate_back(ray->direction)};
}

/// Acceptance for scenes whose surfaces are all opaque and without culled backs. It is separate because the traversal
/// has no registers to spare for others.
struct AcceptOpaque {
    const TraceQuery& query;
    uint32_t i; // index of the ray

    HD bool operator()(uint32_t instance, uint32_t primitive, float, float) const {
        const RayQueueView& rays = query.rays;
        return !is_at(rays.starts, rays, instance, primitive) && !is_at(rays.targets, rays, instance, primitive);
    }

private:
    HD bool is_at(const Uint2* ends, const RayQueueView& rays, uint32_t instance, uint32_t primitive) const {
        if (ends == nullptr) return false;
        const Uint2 end = ends[rays.index(i)];
        return instance == end.x && primitive == end.y;
    }
};

/// Acceptance for any scene. `kMayMove` is false if everything is static, as baked triangles always are. It is no
/// function argument, because that would slow down every candidate on a surface with alpha.
template <bool kMayMove>
struct AcceptQueued {
    const TraceQuery& query;
    uint32_t i;

    HD bool operator()(uint32_t instance, uint32_t primitive, float u, float v) const {
        if (!AcceptOpaque{query, i}(instance, primitive, u, v)) return false;
        if (query.scene == nullptr) return true;
        // A word of 32 instances is cached when their views are not.
        if ((query.passing[instance / 32] >> instance % 32 & 1u) == 0) return true;
        // Tested here, it needs no call if it is known.
        const Opacity known = known_opacity(query.micromaps, instance, primitive, u, v);
        if (known != Opacity::Unknown) return known == Opacity::Opaque;
        const Ray* const ray = query.rays.rays + query.rays.index(i);
        const uint32_t key = query.rays.keys != nullptr ? query.rays.keys[query.rays.index(i)] : 0;
        if constexpr (kMayMove) {
            return !passes_moved_surface(query.scene, ray, key, query.passes, time(), instance, primitive, u, v);
        } else {
            return !passes_surface(query.scene, ray, key, query.passes, instance, primitive, u, v);
        }
    }
    HD Ray move_back(uint32_t motion, const Ray& ray) const
        requires kMayMove
    {
        if (query.moving == nullptr) return ray;
        const MovedLine line = moved_back(query.moving, motion, time(), query.rays.rays + query.rays.index(i));
        return {line.origin, ray.t_min, line.direction, ray.t_max};
    }

private:
    HD const float* time() const {
        return query.rays.times != nullptr ? query.rays.times + query.rays.index(i) : nullptr;
    }
};

} // namespace pertev
