#include "scene/cast_rays.h"

#include <mutex>

#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr uint64_t kGrain = 4096;

struct LocalRay {
    Vec3 origin, direction;
    std::size_t index; // of the world ray; the direction keeps the world's unit of distance
};

bool meets(const Bounds3& box, const LocalRay& ray) {
    float from = 0, to = kInfinity;
    for (int k = 0; k < 3; ++k) {
        const float o = component(ray.origin, k), d = component(ray.direction, k);
        const float lo = component(box.lo, k) - o, hi = component(box.hi, k) - o;
        if (d == 0) {
            if (lo > 0 || hi < 0) return false;
            continue;
        }
        from = max(from, min(lo / d, hi / d));
        to = min(to, max(lo / d, hi / d));
    }
    return from <= to * 1.0001f; // boxes may be flat
}

void meet_triangle(Vec3 a, Vec3 ab, Vec3 ac, const LocalRay& ray, LookHit& best) {
    const Vec3 p = cross(ray.direction, ac);
    const float det = dot(ab, p);
    if (det == 0) return;
    const float inv = 1.0f / det;
    const Vec3 s = ray.origin - a;
    const float u = dot(s, p) * inv;
    if (!(u >= 0 && u <= 1)) return;
    const Vec3 q = cross(s, ab);
    const float v = dot(ray.direction, q) * inv;
    if (!(v >= 0 && u + v <= 1)) return;
    const float t = dot(ac, q) * inv;
    if (t > 0 && t < best.distance) best = {t, det > 0};
}

void cast_at_mesh(const Mesh& mesh, const std::vector<LocalRay>& rays, bool is_mirrored, std::vector<LookHit>& hits) {
    std::mutex merging;
    parallel_for_ranges(mesh.triangle_count(), kGrain, [&](uint64_t begin, uint64_t end) {
        std::vector<LookHit> best(rays.size());
        for (uint64_t i = 3 * begin; i < 3 * end; i += 3) {
            const Vec3 a = mesh.positions[mesh.indices[i]];
            const Vec3 ab = mesh.positions[mesh.indices[i + 1]] - a, ac = mesh.positions[mesh.indices[i + 2]] - a;
            for (std::size_t k = 0; k < rays.size(); ++k) meet_triangle(a, ab, ac, rays[k], best[k]);
        }
        const std::lock_guard lock(merging);
        for (std::size_t k = 0; k < rays.size(); ++k) {
            LookHit& hit = hits[rays[k].index];
            if (best[k].distance < hit.distance) hit = {best[k].distance, best[k].is_front != is_mirrored};
        }
    });
}

} // namespace

std::vector<LookHit> cast_rays(const Scene& scene, std::span<const LookRay> rays) {
    std::vector<LookHit> hits(rays.size());
    std::vector<Bounds3> bounds;
    for (const Mesh& mesh : scene.meshes) bounds.push_back(bounds_of(mesh));
    std::vector<LocalRay> local;
    for (const Instance& instance : scene.instances) {
        const Transform local_from_world = inverse(instance.world_from_local);
        local.clear();
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const LocalRay ray = {transform_point(local_from_world, rays[i].origin),
                                  transform_vector(local_from_world, rays[i].direction), i};
            if (meets(bounds[instance.mesh], ray)) local.push_back(ray);
        }
        if (local.empty()) continue;
        cast_at_mesh(scene.meshes[instance.mesh], local, determinant(instance.world_from_local) < 0, hits);
    }
    return hits;
}

} // namespace pertev
