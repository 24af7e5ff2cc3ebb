#pragma once

// Targets of caustic photons: spheres that together contain every surface that may mirror or refract. A photon that
// hits another surface first causes no caustic. This file also samples how such a photon leaves its light: the light
// and the point on it as in emit_particle.h, then a uniform direction in the cones from there to the spheres, or, for
// distant light, a uniform point in their discs. If the targets are wider than the light's normal emission, normal
// emission is used.
//
// Source: Jensen, "Global Illumination using Photon Maps", 1996, section 4.1, whose projection maps are grids of
// directions for one point each; spheres serve every point on an emitter.

#include <vector>

#include "accel/hploc/leaves.h"
#include "integrators/subpaths/emit_particle.h"
#include "math/float4.h"
#include "shading/may_be_specular.h"

namespace pertev {

inline constexpr uint32_t kMaxTargets = 64;

struct PhotonTargetsView {
    const Float4* spheres; // centre, radius: translated world, metres
    uint32_t count;        // 0 if nothing mirrors or refracts
};

namespace aim {

/// 1 - cosine of the half angle that a sphere subtends; 2 from inside.
HD inline float depth_of_cone(Vec3 from, Float4 sphere) {
    const float distance_squared = length_squared(Vec3{sphere.x, sphere.y, sphere.z} - from);
    const float sine_squared = square(sphere.w) / distance_squared;
    if (!(sine_squared < 1)) return 2;
    return sine_squared / (1.0f + sqrt(1.0f - sine_squared));
}
HD inline Vec3 axis_to(Vec3 from, Float4 sphere) {
    return normalize_or(Vec3{sphere.x, sphere.y, sphere.z} - from, Vec3{0, 0, 1});
}

struct Direction {
    Vec3 to;
    float pdf; // 1/sr
};

HD inline float depth_of_cones(const PhotonTargetsView& targets, Vec3 from) {
    float all = 0;
    for (uint32_t i = 0; i < targets.count; ++i) all += depth_of_cone(from, targets.spheres[i]);
    return all;
}
/// Total area of the discs over pi, in square metres.
HD inline float area_of_discs(const PhotonTargetsView& targets) {
    float all = 0;
    for (uint32_t i = 0; i < targets.count; ++i) all += square(targets.spheres[i].w);
    return all;
}

/// Samples the cones uniformly; a direction in two of them is twice as likely.
HD inline Direction draw_direction(const PhotonTargetsView& targets, Vec3 from, Vec2 u) {
    const float all = depth_of_cones(targets, from);
    float rest = u.x * all, depth = 0;
    uint32_t chosen = 0;
    for (uint32_t i = 0; i < targets.count; ++i) {
        depth = depth_of_cone(from, targets.spheres[i]);
        chosen = i;
        if (rest < depth || i + 1 == targets.count) break;
        rest -= depth;
    }
    const Vec2 within = {min(rest / depth, 0x1.fffffep-1f), u.y};
    const Frame frame = make_frame(axis_to(from, targets.spheres[chosen]));
    const Vec3 direction = normalize(frame.to_world(sample_uniform_cone(within, depth)));
    uint32_t cones = 1;
    for (uint32_t i = 0; i < targets.count; ++i) {
        const Float4 sphere = targets.spheres[i];
        if (i != chosen && 1.0f - dot(axis_to(from, sphere), direction) < depth_of_cone(from, sphere)) ++cones;
    }
    return {direction, static_cast<float>(cones) * 0.5f * kInvPi / all};
}

struct Start {
    Vec3 from;
    float pdf; // 1/m2, across the direction
};

/// Samples the origin of a ray along `direction` from outside the world, uniformly in the discs of the spheres.
HD inline Start draw_start(const PhotonTargetsView& targets, const WorldSphere& world, Vec3 direction, Vec2 u) {
    const float all = area_of_discs(targets);
    float rest = u.x * all;
    uint32_t chosen = 0;
    for (; chosen + 1 < targets.count && !(rest < square(targets.spheres[chosen].w)); ++chosen) {
        rest -= square(targets.spheres[chosen].w);
    }
    const Float4 sphere = targets.spheres[chosen];
    const Vec2 disc = sample_uniform_disk_concentric({min(rest / square(sphere.w), 0x1.fffffep-1f), u.y});
    const Vec3 across = make_frame(direction).to_world({disc.x, disc.y, 0});
    const Vec3 through = Vec3{sphere.x, sphere.y, sphere.z} + sphere.w * across;
    uint32_t discs = 1;
    for (uint32_t i = 0; i < targets.count; ++i) {
        const Vec3 off = Vec3{targets.spheres[i].x, targets.spheres[i].y, targets.spheres[i].z} - through;
        const Vec3 beside = off - dot(off, direction) * direction;
        if (i != chosen && length_squared(beside) < square(targets.spheres[i].w)) ++discs;
    }
    const float back = dot(through - world.centre, direction) + world.radius;
    return {through - back * direction, static_cast<float>(discs) * kInvPi / all};
}

/// Aims a particle from each kind of light at the targets.
struct AimFromKind {
    EmitFromKind freely;
    const PhotonTargetsView& targets;

    HD bool triangle(uint32_t light, Vec2 at, float) const {
        EmissionPoint emission;
        if (!find_emission_point(freely.scene, light, at, freely.key, emission)) return false;
        if (!(depth_of_cones(targets, emission.point) < 1)) return freely.triangle(light, emission);
        const EmissiveTriangle& triangle = freely.scene.lights.triangles[light];
        const Direction direction = draw_direction(targets, emission.point, freely.u);
        Vec3 normal = emission.normal;
        if (triangle.is_two_sided == 0 ? triangle.is_mirrored != 0 : dot(normal, direction.to) < 0) normal = -normal;
        const float cosine = dot(normal, direction.to);
        if (!(cosine > 0)) return false; // the target is behind the emitter
        start_particle(triangle, emission, normal, direction.to, freely.particle);
        freely.particle.light = light;
        freely.particle.power =
            (cosine / (emission.pdf * direction.pdf)) * emission.radiance_along(freely.scene, triangle, cosine);
        return true;
    }
    HD bool punctual(uint32_t number, float pmf) const {
        if (!(pmf > 0)) return false;
        const PunctualLight& light = freely.scene.lights.punctual[number];
        switch (light.kind) {
        case LightKind::Point:
        case LightKind::Spot:
        case LightKind::Goniometric: {
            if (!(depth_of_cones(targets, light.position) < depth_of_beam(light))) break;
            const Direction direction = draw_direction(targets, light.position, freely.u);
            freely.particle.light = freely.scene.lights.triangle_count + number;
            return freely.punctual(light, {light.position, direction.to, reach_of(light), direction.pdf}, pmf);
        }
        case LightKind::Directional: {
            if (!are_narrow()) break;
            const Start start = draw_start(targets, freely.world, light.direction, freely.u);
            freely.particle.is_from_far = true;
            return freely.punctual(light, {start.from, light.direction, kInfinity, start.pdf}, pmf);
        }
        }
        return freely.punctual(number, pmf);
    }
    HD bool environment(float pmf, SampleBits bits) const {
        if (!are_narrow()) return freely.environment(pmf, bits);
        EnvironmentSample sample;
        if (!(pmf > 0) || !sample_environment(freely.scene.lights.environment, bits, sample)) return false;
        const float pdf = pmf * sample.pdf;
        if (!(pdf > 0)) return false;
        const Start start = draw_start(targets, freely.world, -sample.wi, freely.u);
        freely.particle.ray = {start.from, 0, -sample.wi, kInfinity};
        freely.particle.is_from_far = true;
        freely.particle.power = (1.0f / (pdf * start.pdf)) * sample.radiance;
        return true;
    }

private:
    /// Returns whether the targets are narrower than the disc through which distant light enters.
    HD bool are_narrow() const { return area_of_discs(targets) < square(freely.world.radius); }
};

} // namespace aim

/// Emits a particle like emit_particle, but towards `targets`, of which there is at least one. The power is divided
/// by the density of all that was sampled. Its `mis` is not set.
HD inline bool aim_particle(const SceneView& scene, const PhotonTargetsView& targets, const WorldSphere& world,
                            SampleBits u_position, Vec2 u, uint32_t key, Particle& particle) {
    if (!(world.radius > 0)) return false;
    particle.start = {};
    particle.is_from_far = false;
    particle.light = kNoLight;
    particle.is_punctual = false;
    return draw_light(scene.lights, u_position, aim::AimFromKind{{scene, world, u, key, particle}, targets});
}

// Finds the target spheres of caustic photons from a scene's triangles on the device: the bounds of all surfaces that
// may mirror or refract, then those of the contents of each of 4 x 4 x 4 cells. The result is one sphere around all,
// or those of some cells, whichever is smallest in total.

inline constexpr uint32_t kTargetCellsAcross = 4;
static_assert(kTargetCellsAcross * kTargetCellsAcross * kTargetCellsAcross <= kMaxTargets);

/// Bounds of specular triangles and of the cells that hold some; all bytes are hploc::kNothing while it is empty.
struct SpecularBounds {
    hploc::OrderedBounds all, cells[kMaxTargets];
    int32_t reach; // hploc::ordered of minus the squared distance of the farthest corner from the middle of `all`
};

/// The stage that extends the bounds by triangle i of all instances or, once these are known, those of the cells.
struct FindSpecular {
    SceneView scene;
    SpecularBounds* bounds;
    bool in_cells;

    HD void operator()(uint32_t i) const {
        uint32_t low = 0, high = scene.instance_count; // first_triangle[low] <= i < first_triangle[high]
        while (high - low > 1) {
            const uint32_t middle = low + (high - low) / 2;
            (scene.first_triangle[middle] <= i ? low : high) = middle;
        }
        const InstanceView& instance = scene.instances[low];
        if (instance.is_hidden != 0 || !may_be_specular(scene.materials[instance.material])) return;
        const MeshView& mesh = scene.meshes[instance.mesh];
        const TriangleIndices corners = triangle_indices(mesh, i - scene.first_triangle[low]);
        const auto corner_position = [&](uint32_t corner) {
            return transform_point(instance.world_from_local, mesh.positions[corner]);
        };
        const Vec3 at[3] = {corner_position(corners.a), corner_position(corners.b), corner_position(corners.c)};
        Bounds3 box;
        for (const Vec3 corner : at) box.extend(corner);
        if (!in_cells) return extend(bounds->all, box);
        const Vec3 middle = 0.5f * (bounds->all.lo() + bounds->all.hi());
        for (const Vec3 corner : at) hploc::lower(&bounds->reach, hploc::ordered(-length_squared(corner - middle)));
        const Vec3 lo = bounds->all.lo(), size = bounds->all.hi() - lo;
        int first[3], last[3];
        for (int k = 0; k < 3; ++k) {
            first[k] = cell_of(component(box.lo, k), component(lo, k), component(size, k));
            last[k] = cell_of(component(box.hi, k), component(lo, k), component(size, k));
        }
        const Vec3 cell = (1.0f / kTargetCellsAcross) * size;
        for (int z = first[2]; z <= last[2]; ++z) {
            for (int y = first[1]; y <= last[1]; ++y) {
                for (int x = first[0]; x <= last[0]; ++x) {
                    const auto of = [](int n) { return static_cast<float>(n); };
                    const Vec3 from = lo + Vec3{of(x) * cell.x, of(y) * cell.y, of(z) * cell.z};
                    const Vec3 to = lo + Vec3{of(x + 1) * cell.x, of(y + 1) * cell.y, of(z + 1) * cell.z};
                    const uint32_t number = static_cast<uint32_t>((z * 4 + y) * 4 + x);
                    extend(bounds->cells[number], {max(box.lo, from), min(box.hi, to)});
                }
            }
        }
    }

private:
    HD static int cell_of(float x, float lo, float size) {
        return to_int((x - lo) / size * static_cast<float>(kTargetCellsAcross), 0, int(kTargetCellsAcross) - 1);
    }
    HD static void extend(hploc::OrderedBounds& target, const Bounds3& box) {
        const float values[6] = {box.lo.x, box.lo.y, box.lo.z, -box.hi.x, -box.hi.y, -box.hi.z};
        for (int k = 0; k < 6; ++k) hploc::lower(target.least + k, hploc::ordered(values[k]));
    }
};

/// Chooses the spheres; empty if nothing was found.
std::vector<Float4> choose_targets(const SpecularBounds& found);

} // namespace pertev
