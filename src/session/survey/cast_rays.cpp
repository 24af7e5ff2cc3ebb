#include "session/survey/cast_rays.h"

#include <mutex>

#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr uint64_t kBlock = 32;  // triangles that rays skip together
constexpr uint64_t kGrain = 128; // blocks

struct LocalRay {
    Vec3 origin, direction;
    std::size_t index; // index of the world ray; the direction keeps the world's unit of distance
};

/// Rays in structure-of-arrays form, eight per vector register, and the nearest hit of each.
struct RayPack {
    static constexpr std::size_t kWidth = 8;
    float ox[kWidth], oy[kWidth], oz[kWidth], dx[kWidth], dy[kWidth], dz[kWidth];
    float per_x[kWidth], per_y[kWidth], per_z[kWidth]; // 1 over the direction, finite
    float distance[kWidth], facing[kWidth];            // `facing` is above 0 on the front
};

bool hits_box(const Bounds3& box, const LocalRay& ray) {
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

/// Updates the hits of rays by a triangle, without branches, so that the compiler vectorizes it. If a front and a back
/// are at one distance the front counts, so that the order of threads does not matter.
void hit_triangle(Vec3 a, Vec3 ab, Vec3 ac, bool has_back, RayPack& rays) {
    for (std::size_t k = 0; k < RayPack::kWidth; ++k) {
        const Vec3 direction = {rays.dx[k], rays.dy[k], rays.dz[k]};
        const Vec3 p = cross(direction, ac);
        const float det = dot(ab, p), inv = 1.0f / det; // not finite for det = 0, when no comparison below holds
        const Vec3 s = Vec3{rays.ox[k], rays.oy[k], rays.oz[k]} - a, q = cross(s, ab);
        const float u = dot(s, p) * inv, v = dot(direction, q) * inv, t = dot(ac, q) * inv;
        const bool is_first = (t < rays.distance[k]) | ((t == rays.distance[k]) & (det > 0));
        const bool is_nearer = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & is_first & (has_back | (det > 0));
        rays.distance[k] = is_nearer ? t : rays.distance[k];
        rays.facing[k] = is_nearer ? det : rays.facing[k];
    }
}

float finite_inverse(float d) { return abs(d) < 0x1p-80f ? 0x1p80f : 1.0f / d; }

std::vector<RayPack> pack(const std::vector<LocalRay>& rays) {
    std::vector<RayPack> packs((rays.size() + RayPack::kWidth - 1) / RayPack::kWidth);
    for (std::size_t i = 0; i < packs.size() * RayPack::kWidth; ++i) {
        const LocalRay& ray = rays[min(i, rays.size() - 1)]; // the last one fills up its pack
        RayPack& to = packs[i / RayPack::kWidth];
        const std::size_t k = i % RayPack::kWidth;
        to.ox[k] = ray.origin.x, to.oy[k] = ray.origin.y, to.oz[k] = ray.origin.z;
        to.dx[k] = ray.direction.x, to.dy[k] = ray.direction.y, to.dz[k] = ray.direction.z;
        to.per_x[k] = finite_inverse(ray.direction.x), to.per_y[k] = finite_inverse(ray.direction.y);
        to.per_z[k] = finite_inverse(ray.direction.z);
        to.distance[k] = kInfinity, to.facing[k] = 0;
    }
    return packs;
}

/// Consecutive triangles of a mesh. Files have neighbours together, so most rays miss the box of most blocks.
struct Block {
    std::size_t count = 0;
    Vec3 a[kBlock], ab[kBlock], ac[kBlock];
    Bounds3 box;

    Block(const Mesh& mesh, uint64_t first) : count(min(kBlock, mesh.triangle_count() - first)) {
        const uint32_t* index = mesh.indices.data() + 3 * first;
        for (std::size_t i = 0; i < count; ++i, index += 3) {
            const Vec3 b = mesh.positions[index[1]], c = mesh.positions[index[2]];
            a[i] = mesh.positions[index[0]], ab[i] = b - a[i], ac[i] = c - a[i];
            box.extend(a[i]), box.extend(b), box.extend(c);
        }
    }

    /// Returns whether a ray may hit the box, which is grown by more than rounding moves a hit that is not edge-on.
    /// Blocks are the same for all threads, so the answer does not depend on these.
    bool is_reached(const RayPack& rays) const {
        const Vec3 size = box.size();
        const float own = 0x1p-10f * max_component(size);
        int reaches = 0;
        for (std::size_t k = 0; k < RayPack::kWidth; ++k) {
            const Vec3 lo = box.lo - Vec3{rays.ox[k], rays.oy[k], rays.oz[k]}, hi = lo + size;
            const float margin = own + 0x1p-16f * max(max_component(abs(lo)), max_component(abs(hi)));
            const float x0 = (lo.x - margin) * rays.per_x[k], x1 = (hi.x + margin) * rays.per_x[k];
            const float y0 = (lo.y - margin) * rays.per_y[k], y1 = (hi.y + margin) * rays.per_y[k];
            const float z0 = (lo.z - margin) * rays.per_z[k], z1 = (hi.z + margin) * rays.per_z[k];
            const float from = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), 0.0f));
            const float to = min(min(max(x0, x1), max(y0, y1)), max(z0, z1));
            reaches |= from <= to;
        }
        return reaches != 0;
    }
};

void cast_at_mesh(const Mesh& mesh, bool has_back, const std::vector<LocalRay>& rays, std::vector<SurveyHit>& hits) {
    const std::vector<RayPack> start = pack(rays);
    std::mutex merging;
    parallel_for_ranges((mesh.triangle_count() + kBlock - 1) / kBlock, kGrain, [&](uint64_t begin, uint64_t end) {
        std::vector<RayPack> packs = start;
        for (uint64_t i = begin; i < end; ++i) {
            const Block block(mesh, i * kBlock);
            for (RayPack& of_eight : packs) {
                if (!block.is_reached(of_eight)) continue;
                for (std::size_t k = 0; k < block.count; ++k)
                    hit_triangle(block.a[k], block.ab[k], block.ac[k], has_back, of_eight);
            }
        }
        const std::lock_guard lock(merging);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const RayPack& from = packs[i / RayPack::kWidth];
            const std::size_t k = i % RayPack::kWidth;
            SurveyHit& hit = hits[rays[i].index];
            const bool is_front = from.facing[k] > 0;
            if (from.distance[k] < hit.distance || (from.distance[k] == hit.distance && is_front)) {
                hit = {from.distance[k], is_front};
            }
        }
    });
}

} // namespace

std::vector<SurveyHit> cast_rays(const Scene& scene, std::span<const SurveyRay> rays, Backs backs, Glass glass) {
    std::vector<SurveyHit> hits(rays.size());
    std::vector<Bounds3> bounds;
    for (const Mesh& mesh : scene.meshes) bounds.push_back(bounds_of(mesh));
    std::vector<LocalRay> local;
    for (const Instance& instance : scene.instances) {
        const Material& material = scene.materials[instance.material];
        if (instance.is_hidden || instance.is_background) continue;
        if (glass == Glass::LetsThrough && material.kind == MaterialKind::Dielectric) continue;
        const Transform local_from_world = inverse(instance.world_from_local);
        local.clear();
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const LocalRay ray = {transform_point(local_from_world, rays[i].origin),
                                  transform_vector(local_from_world, rays[i].direction), i};
            if (hits_box(bounds[instance.mesh], ray)) local.push_back(ray);
        }
        if (local.empty()) continue;
        const bool has_back = backs == Backs::All || material.double_sided;
        cast_at_mesh(scene.meshes[instance.mesh], has_back, local, hits);
    }
    return hits;
}

} // namespace pertev
