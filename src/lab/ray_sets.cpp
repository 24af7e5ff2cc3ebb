#include "lab/ray_sets.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "base/error.h"
#include "base/parallel_for.h"
#include "math/double_vec3.h"
#include "math/frame.h"
#include "math/portable_math.h"
#include "render/camera_view.h"
#include "render/tiled_pixel.h"

namespace pertev {
namespace {

constexpr float kFarAway = 1e30f;       // t_max of closest-hit rays
constexpr float kOffset = 2e-5f;        // offset of secondary rays from the surface, relative to the scene's diagonal
constexpr float kShadowReach = 0.9995f; // share of the distance to the target that a shadow ray covers
constexpr uint64_t kGrain = 1 << 14;

// Each set has its own sequence of random numbers, and so has the second set whose hits complete the next one.
constexpr uint32_t kShadowSeed = 11;
uint32_t diffuse_seed(int bounce) { return 22u * static_cast<uint32_t>(bounce); }
uint32_t second_diffuse_seed(int bounce) { return diffuse_seed(bounce) + 11u; }

/// The origin of a secondary ray: slightly off the surface, on the side that the previous ray came from.
struct StartPoint {
    Vec3 origin, normal;
};

struct StartPoints {
    std::vector<StartPoint> points;
    std::size_t first_group = 0; // number of hits of the first parents; the rest come from the second parents
};

/// Returns the triangle's unit normal, facing against `direction`. It is computed in doubles, so that a sliver's cross
/// product does not lose its digits.
Vec3 normal_against(const Scene& scene, const RayHit& hit, Vec3 direction) {
    const Instance& instance = scene.instances[hit.instance];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const uint32_t* v = &mesh.indices[3 * static_cast<std::size_t>(hit.primitive)];
    const auto corner = [&](int k) { return transform_point(instance.world_from_local, mesh.positions[v[k]]); };
    const DoubleVec3 a = to_double(corner(0));
    const DoubleVec3 n = cross(to_double(corner(1)) - a, to_double(corner(2)) - a);
    const double length = std::sqrt(dot(n, n));
    if (!(length > 0)) return -normalize(direction);
    const Vec3 normal = to_float(n / length);
    return dot(normal, direction) > 0 ? -normal : normal;
}

/// Finds one start point per ray that hits, in the order of the rays. Hits of each chunk are counted first, so that
/// threads know where to write.
std::vector<StartPoint> find_start_points(const RaySetJob& job, std::span<const Ray> rays, float offset) {
    std::vector<RayHit> hits(rays.size());
    job.trace(rays, hits);
    const std::size_t chunks = (rays.size() + kGrain - 1) / kGrain;
    std::vector<std::size_t> first(chunks + 1, 0);
    const auto in_chunk = [&](std::size_t chunk) {
        return std::span(hits).subspan(chunk * kGrain, std::min<std::size_t>(kGrain, hits.size() - chunk * kGrain));
    };
    parallel_for(chunks, 1, [&](uint64_t chunk) {
        first[chunk + 1] = static_cast<std::size_t>(std::ranges::count_if(in_chunk(chunk), &RayHit::is_hit));
    });
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) first[chunk + 1] += first[chunk];

    std::vector<StartPoint> points(first[chunks]);
    parallel_for(chunks, 1, [&](uint64_t chunk) {
        std::size_t at = first[chunk];
        for (std::size_t i = 0; i < in_chunk(chunk).size(); ++i) {
            const RayHit& hit = hits[chunk * kGrain + i];
            const Ray& ray = rays[chunk * kGrain + i];
            if (!hit.is_hit()) continue;
            const Vec3 normal = normal_against(job.scene, hit, ray.direction);
            points[at++] = {ray.origin + hit.t * ray.direction + offset * normal, normal};
        }
    });
    return points;
}

/// Collects the hits of `rays`, and those of the rays that make_second returns if there are fewer than `count`.
StartPoints gather(const RaySetJob& job, float offset, std::size_t count, std::span<const Ray> rays,
                   const std::function<std::vector<Ray>()>& make_second) {
    StartPoints starts{find_start_points(job, rays, offset)};
    starts.first_group = starts.points.size();
    if (starts.first_group >= count) return starts;
    const std::vector<StartPoint> second = find_start_points(job, make_second(), offset);
    const std::size_t wanted = std::min(second.size(), count - starts.first_group);
    starts.points.insert(starts.points.end(), second.begin(), second.begin() + static_cast<std::ptrdiff_t>(wanted));
    return starts;
}

/// Makes `count` rays as consecutive whole frames; the first frame is sample `first_sample`.
std::vector<Ray> make_primary(const RaySetJob& job, uint32_t count, uint32_t first_sample) {
    const CameraView camera = make_camera_view(job.camera, job.width, job.height);
    const uint32_t pixels = job.width * job.height;
    std::vector<Ray> rays(count);
    parallel_for(count, kGrain, [&](uint64_t i) {
        const uint32_t in_frame = static_cast<uint32_t>(i) % pixels;
        const uint32_t pixel = tiled_pixel(in_frame, job.width, job.height);
        uint32_t state = primary_state(in_frame, first_sample + static_cast<uint32_t>(i) / pixels);
        const float across = draw(state);
        const float down = draw(state);
        const uint32_t x = pixel % job.width, y = pixel / job.width;
        rays[i] = make_camera_ray(camera, {static_cast<float>(x) + across, static_cast<float>(y) + down},
                                  {0.5f, 0.5f}); // centre of the lens
        rays[i].t_max = kFarAway;
    });
    return rays;
}

/// Returns the random state of ray o. Rays are numbered from 0 in each group; the second group's seed is offset by the
/// size of the first.
uint32_t state_of(const StartPoints& starts, std::size_t o, uint32_t seed) {
    const bool is_first = o < starts.first_group;
    const std::size_t made = is_first ? 0 : starts.first_group;
    return secondary_state(static_cast<uint32_t>(o - made), seed + static_cast<uint32_t>(made));
}

std::vector<Ray> make_shadow(const StartPoints& starts, const Bounds3& box) {
    const auto targets = shadow_targets(box);
    std::vector<Ray> rays(starts.points.size());
    parallel_for(rays.size(), kGrain, [&](uint64_t o) {
        uint32_t state = state_of(starts, o, kShadowSeed);
        const Vec3 target = targets[static_cast<std::size_t>(draw(state) * static_cast<float>(kShadowTargets))];
        const Vec3 origin = starts.points[o].origin, offset = target - origin;
        const float distance = length(offset);
        const bool is_there = !(distance > 0); // a ray of zero length, which cannot hit anything
        rays[o] = {origin, 0.0f, is_there ? starts.points[o].normal : (1.0f / distance) * offset,
                   is_there ? 0.0f : kShadowReach * distance};
    });
    return rays;
}

/// Draws directions about the normal with density cosine / pi.
std::vector<Ray> make_diffuse(const StartPoints& starts, uint32_t seed) {
    std::vector<Ray> rays(starts.points.size());
    parallel_for(rays.size(), kGrain, [&](uint64_t o) {
        uint32_t state = state_of(starts, o, seed);
        const float u1 = draw(state);
        const float u2 = draw(state);
        float sine, cosine;
        sin_cos_2pi(u2, sine, cosine);
        const float radius = sqrt(u1);
        const Frame frame = make_frame(starts.points[o].normal);
        const Vec3 direction = frame.to_world({radius * cosine, radius * sine, sqrt(1.0f - u1)});
        rays[o] = {starts.points[o].origin, 0.0f, normalize(direction), kFarAway};
    });
    return rays;
}

std::string diffuse_name(int bounce) { return "diffuse" + std::to_string(bounce); }

void check_frame(const RaySetJob& job) {
    PERTEV_CHECK(job.width > 0 && job.height > 0 && uint64_t(job.width) * job.height <= kMaxImagePixels);
}

} // namespace

std::array<Vec3, kShadowTargets> shadow_targets(const Bounds3& box) {
    // PCG's own stream from state 777: a linear congruence advances the state, and each number is its hash.
    uint32_t state = 777;
    const auto next = [&state] {
        const float u = static_cast<float>(hash_word(state) >> 8) * 0x1p-24f;
        state = state * 747796405u + 2891336453u;
        return u;
    };
    std::array<Vec3, kShadowTargets> targets;
    for (Vec3& target : targets) {
        const float x = 0.1f + 0.8f * next();
        const float y = 0.15f + 0.7f * next();
        const float z = 0.1f + 0.8f * next();
        const Vec3 size = box.size();
        target = box.lo + Vec3{x * size.x, y * size.y, z * size.z};
    }
    return targets;
}

FrameSize record_frame(uint32_t count) {
    uint64_t step = 4; // 9 * 4 rows and 16 * 4 columns are whole tiles
    while (4 * 16 * 9 * (step + 4) * (step + 4) <= count) step += 4;
    return {static_cast<uint32_t>(16 * step), static_cast<uint32_t>(9 * step)};
}

std::vector<RaySet> make_record_ray_sets(const RaySetJob& job, uint32_t count) {
    check_frame(job);
    const Bounds3 box = bounds_of(job.scene);
    const float offset = kOffset * length(box.size());
    const uint32_t pixels = job.width * job.height;
    const uint32_t frames = static_cast<uint32_t>((uint64_t(count) + pixels - 1) / pixels);
    std::vector<RaySet> sets = {{"primary", false, make_primary(job, count, 0)}};
    StartPoints starts = gather(job, offset, count, sets[0].rays, [&] { return make_primary(job, count, frames); });
    sets.push_back({"shadow", true, make_shadow(starts, box)});
    for (int bounce = 1; bounce <= 3; ++bounce) {
        sets.push_back({diffuse_name(bounce), false, make_diffuse(starts, diffuse_seed(bounce))});
        if (bounce == 3) break;
        starts = gather(job, offset, count, sets.back().rays,
                        [&] { return make_diffuse(starts, second_diffuse_seed(bounce)); });
    }
    return sets;
}

std::vector<RaySet> make_axis_ray_sets(const RaySet& from) {
    const auto turned = [&](const char* name, float aside) {
        RaySet set{name, from.any_hit, from.rays};
        parallel_for(set.rays.size(), kGrain, [&](uint64_t i) {
            Vec3& d = set.rays[i].direction;
            const Vec3 size = abs(d);
            const bool is_x = size.x >= size.y && size.x >= size.z, is_y = !is_x && size.y >= size.z;
            const auto part = [&](bool is_axis, float of) { return copysign(is_axis ? 1.0f : aside, of); };
            d = normalize(Vec3{part(is_x, d.x), part(is_y, d.y), part(!is_x && !is_y, d.z)});
        });
        return set;
    };
    return {turned("along_axes", 0), turned("beside_axes", 1e-3f)};
}

std::vector<RaySet> make_frame_ray_sets(const RaySetJob& job, int depth) {
    check_frame(job);
    PERTEV_CHECK(depth >= 0 && depth <= kMaxFrameDepth);
    const Bounds3 box = bounds_of(job.scene);
    const float offset = kOffset * length(box.size());
    std::vector<RaySet> sets = {{"primary", false, make_primary(job, job.width * job.height, 0)}};
    const auto hits_of = [&](const RaySet& set) { return gather(job, offset, 0, set.rays, {}); };
    StartPoints starts = hits_of(sets[0]);
    sets.push_back({"shadow", true, make_shadow(starts, box)});
    for (int bounce = 1; bounce <= depth; ++bounce) {
        sets.push_back({diffuse_name(bounce), false, make_diffuse(starts, diffuse_seed(bounce))});
        if (bounce < depth) starts = hits_of(sets.back());
    }
    return sets;
}

} // namespace pertev
