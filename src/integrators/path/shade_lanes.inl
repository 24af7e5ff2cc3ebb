// Body of shade_lanes.h. The file that includes it names the number type: `Floats` is Floats8 or Floats16. All of it is
// in anonymous namespaces, so that each number of lanes has functions of its own.

#include <cstddef>
#include <cstring>

#include "integrators/path/path_code.h"
#include "integrators/path/path_vertex.h"
#include "integrators/path/shade_lanes.h"
#include "integrators/path/vertex_numbers.h"

namespace pertev {
namespace {

constexpr uint32_t kLanes = Floats::kLanes;
using Mask = MaskOf<Floats>;
using Words = WordOf<Floats>;
using Vec3s = Vec3Of<Floats>;
using Rgbs = RgbOf<Floats>;
using Transforms = TransformOf<Floats>;

/// Values that are stored lane by lane and then loaded at once.
template <int kFields>
struct Table {
    alignas(64) float at[kFields][kLanes];

    void set(int field, uint32_t lane, float x) { at[field][lane] = x; }
    void set(int field, uint32_t lane, Vec3 v) {
        set(field, lane, v.x), set(field + 1, lane, v.y), set(field + 2, lane, v.z);
    }
    void set(int field, uint32_t lane, Rgb c) { set(field, lane, Vec3{c.r, c.g, c.b}); }
    Floats get(int field) const { return Floats::load(at[field]); }
    Vec3s vec3(int field) const { return {get(field), get(field + 1), get(field + 2)}; }
    Rgbs rgb(int field) const { return {get(field), get(field + 1), get(field + 2)}; }
};

std::array<float*, kLanes> rows_of(float (&table)[kLanes][8]) {
    std::array<float*, kLanes> rows;
    for (uint32_t lane = 0; lane < kLanes; ++lane) rows[lane] = table[lane];
    return rows;
}

/// A word of each lane.
struct WordTable {
    alignas(64) uint32_t at[kLanes];

    Words get() const {
        Words words;
        std::memcpy(&words, at, sizeof words);
        return words;
    }
};

/// Random numbers of the vertices; for lobes that draw by one, also those of choices.
VertexWords<Words> draw_numbers(const PathJob& job, const LaneVertices& vertices, bool has_choices) {
    const PathSettings& settings = job.settings;
    WordTable streams, samples, seeds, depths;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
        const PathState& path = *vertices.paths[lane];
        const SampleKey key = sample_key<kBatched>(job, path.pixel, path.sample);
        streams.at[lane] = key.stream, samples.at[lane] = key.sample, seeds.at[lane] = key.seed;
        depths.at[lane] = path.depth;
        has_choices = has_choices || may_end_by_chance(settings, path.depth + 1);
    }
    const SampleKeyOf<Words> keys = {streams.get(), samples.get(), seeds.get()};
    return draw_vertex(settings.sampler, keys, depths.get(), has_choices);
}

/// Triangles that rays have hit, as they lie in memory.
struct Triangles {
    Transforms world_from_local, local_from_world;
    Vec3s a, b, c;                      // local space
    Vec3s normal_a, normal_b, normal_c; // vertex normals, or zero
    Floats u, v;
    Rgbs albedo;
    Mask has_normals, is_mirrored, is_baked;
    unsigned emits = 0;     // lanes whose material emits
    unsigned have_maps = 0; // lanes whose material has a normal map
};

void load_transforms(const std::array<const InstanceView*, kLanes>& instances, Triangles& triangles) {
    static_assert(offsetof(InstanceView, world_from_local) == 0 && offsetof(InstanceView, local_from_world) == 48);
    Floats columns[3][8];
    for (int part = 0; part < 3; ++part) {
        std::array<const float*, kLanes> rows;
        for (uint32_t lane = 0; lane < kLanes; ++lane)
            rows[lane] = &instances[lane]->world_from_local.row0.x + 8 * part;
        load_columns(rows, columns[part]);
    }
    const auto vector_at = [&](int first) {
        const auto at = [&](int i) { return columns[i / 8][i % 8]; };
        return Vec3s{at(first), at(first + 1), at(first + 2)};
    };
    triangles.world_from_local = {vector_at(0), vector_at(3), vector_at(6), vector_at(9)};
    triangles.local_from_world = {vector_at(12), vector_at(15), vector_at(18), vector_at(21)};
}

Triangles load_triangles(const SceneView& scene, const LaneVertices& vertices) {
    enum Field {
        kA = 0,
        kB = 3,
        kC = 6,
        kNormalA = 9,
        kNormalB = 12,
        kNormalC = 15,
        kU = 18,
        kV,
        kAlbedo,
        kFields = 23
    };
    Table<kFields> table;
    std::array<const InstanceView*, kLanes> instances;
    unsigned have_normals = 0, are_mirrored = 0, are_baked = 0;
    Triangles triangles;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
        const Hit& hit = *vertices.hits[lane];
        const InstanceView& instance = scene.instances[hit.instance];
        const MeshView& mesh = scene.meshes[instance.mesh];
        const MaterialParameters& material = scene.materials[instance.material];
        const TriangleIndices i = triangle_indices(mesh, hit.primitive);
        instances[lane] = &instance;
        table.set(kA, lane, mesh.positions[i.a]);
        table.set(kB, lane, mesh.positions[i.b]);
        table.set(kC, lane, mesh.positions[i.c]);
        const bool has_normals = mesh.normals != nullptr;
        const Vec3* const normals = has_normals ? mesh.normals : mesh.positions; // some numbers, which are not used
        table.set(kNormalA, lane, normals[i.a]);
        table.set(kNormalB, lane, normals[i.b]);
        table.set(kNormalC, lane, normals[i.c]);
        table.set(kU, lane, hit.u);
        table.set(kV, lane, hit.v);
        table.set(kAlbedo, lane, base_color_at<ShadingVariant::Diffuse>(scene, material, mesh, i, hit.u, hit.v));
        have_normals |= (has_normals ? 1u : 0u) << lane;
        are_mirrored |= (instance.is_mirrored != 0 ? 1u : 0u) << lane;
        are_baked |= (instance.is_baked != 0 ? 1u : 0u) << lane;
        const bool emits = material.emission.r > 0 || material.emission.g > 0 || material.emission.b > 0;
        triangles.emits |= (emits ? 1u : 0u) << lane;
        triangles.have_maps |= (material.normal_texture.has_image() ? 1u : 0u) << lane;
    }
    load_transforms(instances, triangles);
    triangles.a = table.vec3(kA), triangles.b = table.vec3(kB), triangles.c = table.vec3(kC);
    triangles.normal_a = table.vec3(kNormalA), triangles.normal_b = table.vec3(kNormalB);
    triangles.normal_c = table.vec3(kNormalC);
    triangles.u = table.get(kU), triangles.v = table.get(kV);
    triangles.albedo = table.rgb(kAlbedo);
    triangles.has_normals = Mask::of_bits(have_normals);
    triangles.is_mirrored = Mask::of_bits(are_mirrored);
    triangles.is_baked = Mask::of_bits(are_baked);
    return triangles;
}

/// Surface (device_scene/surface.h) of hits, without its BSDF.
struct Surfaces {
    Vec3s position, error, winding_normal, geometric_normal;
    FrameOf<Floats> frame;
    Floats tilt;

    Mask is_consistent(Vec3s wo, Vec3s wi, Floats wo_z, Floats wi_z) const {
        const Mask same_side = (dot(wo, geometric_normal) > 0) == (dot(wi, geometric_normal) > 0);
        return same_side == (wo_z * wi_z > 0);
    }
    Vec3s origin_towards(Vec3s wi) const { return offset_ray_origin(position, error, geometric_normal, wi); }
    /// Normal of Surface::light_context.
    Vec3s context_normal(Vec3s wo) const { return select(dot(wo, frame.normal) < 0, -frame.normal, frame.normal); }
};

/// Normals of normal maps, for lanes that have one; `normal` is the interpolated one of each.
Vec3s map_normals(const SceneView& scene, const LaneVertices& vertices, const Triangles& t, Vec3s normal) {
    enum Field {
        kA = 0,
        kB = 3,
        kC = 6,
        kHandednessA = 9,
        kHandednessB,
        kHandednessC,
        kMap,
        kTexel = 16,
        kScale = 19,
        kFields
    };
    Table<kFields> table;
    unsigned have_tangents = 0;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
        const Hit& hit = *vertices.hits[lane];
        const InstanceView& instance = scene.instances[hit.instance];
        const MeshView& mesh = scene.meshes[instance.mesh];
        const MaterialParameters& material = scene.materials[instance.material];
        const TextureRef& map = material.normal_texture;
        const TriangleIndices i = triangle_indices(mesh, hit.primitive);
        const bool has_tangents = mesh.tangents != nullptr, has_map = map.has_image();
        have_tangents |= (has_tangents ? 1u : 0u) << lane;
        const Vec4 none = {1, 0, 0, 1};
        const Vec4 a = has_tangents ? mesh.tangents[i.a] : none, b = has_tangents ? mesh.tangents[i.b] : none,
                   c = has_tangents ? mesh.tangents[i.c] : none;
        table.set(kA, lane, Vec3{a.x, a.y, a.z}), table.set(kHandednessA, lane, a.w);
        table.set(kB, lane, Vec3{b.x, b.y, b.z}), table.set(kHandednessB, lane, b.w);
        table.set(kC, lane, Vec3{c.x, c.y, c.z}), table.set(kHandednessC, lane, c.w);
        table.set(kMap, lane, map.m00), table.set(kMap + 1, lane, map.m01);
        table.set(kMap + 2, lane, map.m10), table.set(kMap + 3, lane, map.m11);
        const Vec4 texel = has_map ? texel_at(scene, mesh, map, i, hit.u, hit.v) : Vec4{};
        table.set(kTexel, lane, Vec3{texel.x, texel.y, texel.z});
        table.set(kScale, lane, material.normal_scale);
    }
    const Vec3s local = interpolate(table.vec3(kA), table.vec3(kB), table.vec3(kC), t.u, t.v);
    const Floats w =
        (1.0f - t.u - t.v) * table.get(kHandednessA) + t.u * table.get(kHandednessB) + t.v * table.get(kHandednessC);
    const FrameOf<Floats> by_tangents = frame_of_transformed_map(
        frame_with_tangent(normal, transform_vector(t.world_from_local, local), select(t.is_mirrored, -w, w)),
        {table.get(kMap), table.get(kMap + 1)}, {table.get(kMap + 2), table.get(kMap + 3)});
    const FrameOf<Floats> frame = select(Mask::of_bits(have_tangents), by_tangents, make_frame(normal));
    return select(Mask::of_bits(t.have_maps), mapped_normal(frame, table.vec3(kTexel), table.get(kScale)), normal);
}

Surfaces make_surfaces(const SceneView& scene, const LaneVertices& vertices, const Triangles& t, Vec3s wo) {
    WorldTriangleOf<Floats> triangle;
    place_hit(triangle, {t.world_from_local, t.local_from_world, t.is_mirrored, t.is_baked}, t.a, t.b, t.c, t.u, t.v);
    Surfaces s;
    s.position = triangle.position, s.error = triangle.error, s.winding_normal = triangle.normal;
    s.geometric_normal = triangle.normal;
    s.tilt = 0.0f;
    Vec3s shading_normal = triangle.normal;
    if (any(t.has_normals) || t.have_maps != 0) {
        const Transforms& local_from_world = t.local_from_world;
        const Vec3s sum = transform_transposed(local_from_world, t.normal_a + t.normal_b + t.normal_c);
        const Mask is_behind = t.has_normals && dot(sum, triangle.normal) < 0;
        const Vec3s front = select(is_behind, -triangle.normal, triangle.normal);
        const Vec3s local = interpolate(t.normal_a, t.normal_b, t.normal_c, t.u, t.v);
        Vec3s normal = world_normal(local_from_world, select(t.has_normals, local, Vec3s{}), front);
        const Vec3s corners = {corner_tilt(local_from_world, t.normal_a, front),
                               corner_tilt(local_from_world, t.normal_b, front),
                               corner_tilt(local_from_world, t.normal_c, front)};
        const Floats tilt = terminator_tilt(sine_between(normal, front), dot({1.0f - t.u - t.v, t.u, t.v}, corners));
        if (t.have_maps != 0) normal = map_normals(scene, vertices, t, normal);
        const Floats side = select(dot(wo, front) < 0, Floats(-1.0f), Floats(1.0f));
        const Vec3s valid = side * valid_normal(side * normal, side * front, wo);
        s.geometric_normal = front;
        s.tilt = select(t.has_normals, tilt, Floats(0.0f));
        shading_normal = select(t.has_normals || Mask::of_bits(t.have_maps), valid, front);
    }
    s.frame = make_frame(shading_normal);
    return s;
}

} // namespace
} // namespace pertev

#include "integrators/path/lane_lobes.inl"

namespace pertev {
namespace {

/// Evaluates the BSDF as Surface::evaluate.
template <class Lobes>
Values evaluate(const Surfaces& s, const Lobes& lobes, Vec3s wo, Vec3s wo_local, Vec3s wi) {
    const Vec3s wi_local = s.frame.to_local(wi);
    const RaisedDirectionOf<Floats> from = lower_direction(wi_local, s.tilt);
    const Values value = lobes.evaluate(wo_local, from.direction);
    const Mask is_valid = s.is_consistent(wo, wi, wo_local.z, wi_local.z) && from.slope > 0;
    return {(1.0f / from.slope) * value.f, select(is_valid, value.pdf / from.slope, Floats(0.0f))};
}

} // namespace
} // namespace pertev

#include "integrators/path/light_lanes.inl"

namespace pertev {
namespace {

/// The parts of a path that shading reads and writes.
struct Paths {
    Vec3s direction;
    Rgbs throughput;
    Mask is_clamped; // scattered at least once before this vertex
};

/// Samples direct light as sample_direct. Returns the lanes that need a shadow ray.
template <class Lobes>
unsigned sample_direct(const PathJob& job, unsigned lanes, const Paths& paths, const Surfaces& surfaces,
                       const Lobes& lobes, Vec3s wo, Vec3s wo_local, const LaneVertices& vertices,
                       const SampleBitsOf<Words>& u, ShadowRay* shadows) {
    const LightSetView& all = scene_of(job, vertices).lights;
    Lights lights;
    if (job.selects_by_tree) {
        const Vec3s normal = surfaces.context_normal(wo);
        sample_lights<kLightTree>(all, lanes, surfaces.position, normal, u, lights);
    } else {
        sample_lights<kPlainDiffuse>(all, lanes, surfaces.position, {}, u, lights);
    }
    const Values scattered = evaluate(surfaces, lobes, wo, wo_local, lights.wi);
    const Mask wants = lights.arrives && scattered.pdf > 0 && !is_black(scattered.f);
    unsigned wanted = without_holes(job, bit_mask(wants) & lanes, vertices, lights);
    if (wanted == 0) return 0;
    // ray_to_light.
    const Vec3s origin = surfaces.origin_towards(lights.wi);
    const Vec3s end = select(
        lights.is_triangle, offset_ray_origin(lights.point, light_point_error(lights.point), lights.normal, -lights.wi),
        lights.point);
    const Vec3s direction = select(lights.has_distance, end - origin, lights.wi);
    const Floats t_max = select(lights.has_distance, Floats(1.0f), Floats(kInfinity));
    alignas(64) float first[kLanes][8], light[3][kLanes];
    store_columns({origin.x, origin.y, origin.z, direction.x, direction.y, direction.z, t_max, t_max}, rows_of(first));
    const bool by_mis = job.settings.strategy == LightStrategy::Mis;
    const Floats weight =
        by_mis ? select(lights.is_delta, Floats(1.0f), power_heuristic(lights.pdf, scattered.pdf)) : Floats(1.0f);
    Rgbs arriving = (weight / lights.pdf) * lights.radiance;
    unsigned behind = 0;
    if (job.passes_thin_walls) wanted = pass_thin_walls(job, wanted, vertices, first, arriving, behind);
    Rgbs contribution = paths.throughput * scattered.f * arriving;
    if (job.settings.clamp > 0) {
        const Floats largest = max_component(contribution), limit = weight * job.settings.clamp;
        const Mask is_clamped = paths.is_clamped || Mask::of_bits(behind);
        contribution = select(is_clamped && largest > limit, (limit / largest) * contribution, contribution);
    }
    contribution.r.store(light[0]), contribution.g.store(light[1]), contribution.b.store(light[2]);
    for (unsigned rest = wanted; rest != 0; rest &= rest - 1) {
        const int lane = __builtin_ctz(rest);
        const float* const row = first[lane];
        *shadows++ = {.origin = {row[0], row[1], row[2]},
                      .direction = {row[3], row[4], row[5]},
                      .t_max = row[6],
                      .start = {vertices.hits[lane]->instance, vertices.hits[lane]->primitive},
                      .target = lights.targets[lane],
                      .contribution = {light[0][lane], light[1][lane], light[2][lane]}};
    }
    return wanted;
}

/// Returns the lanes whose paths have scattered `depth` times.
unsigned lanes_at_depth(uint32_t depth, const LaneVertices& vertices) {
    unsigned lanes = 0;
    for (uint32_t lane = 0; lane < vertices.count; ++lane) {
        lanes |= (vertices.paths[lane]->depth == depth ? 1u : 0u) << lane;
    }
    return lanes;
}

/// Samples directions as sample_scattering. Returns the lanes whose paths go on, and moves these paths.
template <class Lobes>
unsigned sample_scattering(const PathJob& job, unsigned lanes, const Paths& paths, const Surfaces& surfaces,
                           const Lobes& lobes, Vec3s wo, Vec3s wo_local, const LaneVertices& vertices,
                           const VertexWords<Words>& words) {
    const PathSettings& settings = job.settings;
    const Vec2Of<Floats> u = {unit_interval<Floats>(words.direction.x), unit_interval<Floats>(words.direction.y)};
    const DrawnDirections drawn = lobes.draw(wo_local, unit_interval<Floats>(words.choices.x), u);
    const Values value = lobes.evaluate(wo_local, drawn.wi);
    const Rgbs weight = (1.0f / value.pdf) * value.f;
    Mask goes_on = drawn.is_drawn && wo_local.z != 0 && value.pdf > 1e-30f && !is_black(weight);
    const RaisedDirectionOf<Floats> raised = raise_direction(drawn.wi, surfaces.tilt);
    const Floats pdf = value.pdf / raised.slope;
    const Vec3s wi = normalize(surfaces.frame.to_world(raised.direction));
    goes_on = goes_on && surfaces.is_consistent(wo, wi, wo_local.z, raised.direction.z) && pdf > 0;
    unsigned going = bit_mask(goes_on) & lanes;
    if (job.ends_by_nee) going &= ~lanes_at_depth(settings.max_depth - 1, vertices);

    Rgbs throughput = paths.throughput * weight;
    unsigned by_chance = 0;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
        by_chance |= (may_end_by_chance(settings, vertices.paths[lane]->depth + 1) ? 1u : 0u) << lane;
    }
    if ((by_chance & going) != 0) {
        const Floats survival = survival_probability(settings.roulette, max_component(throughput));
        const Mask may_end = Mask::of_bits(by_chance) && survival < 1.0f;
        going &= bit_mask(!may_end || unit_interval<Floats>(words.choices.y) < survival);
        throughput = select(may_end, (1.0f / survival) * throughput, throughput);
    }
    if (going == 0) return 0;
    const Vec3s origin = surfaces.origin_towards(wi), normal = surfaces.context_normal(wo);
    alignas(64) float rows[kLanes][8];
    store_columns({origin.x, origin.y, origin.z, wi.x, wi.y, wi.z, throughput.r, throughput.g}, rows_of(rows));
    for (unsigned rest = going; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<uint32_t>(__builtin_ctz(rest));
        const float* const row = rows[lane];
        PathState& path = *vertices.paths[lane];
        path.origin = {row[0], row[1], row[2]};
        path.direction = {row[3], row[4], row[5]};
        path.throughput = {row[6], row[7], throughput.b[lane]};
        path.bsdf_pdf = pdf[lane];
        path.passed = 0;
        path.start = {vertices.hits[lane]->instance, vertices.hits[lane]->primitive};
        if (job.selects_by_tree) path.normal = {normal.x[lane], normal.y[lane], normal.z[lane]};
        path.depth += 1;
        path.rough_depth += 1;
    }
    return going;
}

/// Adds what the surfaces of `lanes` emit.
void add_emission(const PathJob& job, unsigned lanes, const LaneVertices& vertices, const Surfaces& surfaces) {
    const SceneView& scene = scene_of(job, vertices);
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<uint32_t>(__builtin_ctz(lanes));
        const Hit& hit = *vertices.hits[lane];
        PathState& path = *vertices.paths[lane];
        const uint32_t material = scene.instances[hit.instance].material;
        const Vec3s& n = surfaces.winding_normal;
        const Vec3 normal = {n.x[lane], n.y[lane], n.z[lane]};
        if (!scene.materials[material].two_sided_emission && !(dot(normal, path.direction) < 0)) continue;
        Surface surface = {};
        surface.position = {surfaces.position.x[lane], surfaces.position.y[lane], surfaces.position.z[lane]};
        surface.triangle = {hit.instance, hit.primitive};
        const MeshView& mesh = scene.meshes[scene.instances[hit.instance].mesh];
        const Vec2 uv = texture_coordinate(mesh, scene.materials[material].emission_texture,
                                           triangle_indices(mesh, hit.primitive), hit.u, hit.v);
        surface.emission = surface_emission(scene.lights, material, uv);
        Listeners<> listener(job);
        // A path may have passed thin walls since its density was sampled.
        if (job.selects_by_tree) {
            job.passes_thin_walls ? add_surface_emission<kLightTree | kMedia>(job, path, hit, surface, listener)
                                  : add_surface_emission<kLightTree>(job, path, hit, surface, listener);
        } else {
            job.passes_thin_walls ? add_surface_emission<kMedia>(job, path, hit, surface, listener)
                                  : add_surface_emission<kPlainDiffuse>(job, path, hit, surface, listener);
        }
    }
}

Paths load_paths(const LaneVertices& vertices) {
    static_assert(offsetof(PathState, throughput) == offsetof(PathState, direction) + sizeof(Vec3));
    static_assert(offsetof(PathState, radiance) == offsetof(PathState, throughput) + sizeof(Rgb));
    std::array<const float*, kLanes> rows;
    unsigned are_clamped = 0;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
        rows[lane] = &vertices.paths[lane]->direction.x;
        are_clamped |= (vertices.paths[lane]->depth > 0 ? 1u : 0u) << lane;
    }
    Floats columns[8];
    load_columns(rows, columns);
    return {{columns[0], columns[1], columns[2]}, {columns[3], columns[4], columns[5]}, Mask::of_bits(are_clamped)};
}

template <class Lobes>
[[gnu::flatten]] LaneResults shade_lanes(const PathJob& job, const LaneVertices& vertices, ShadowRay* shadows) {
    const SceneView& scene = scene_of(job, vertices);
    const unsigned all = (1u << vertices.count) - 1;
    const Paths paths = load_paths(vertices);
    const VertexWords<Words> words = draw_numbers(job, vertices, Lobes::kHasChoices);
    const Vec3s wo = -paths.direction;
    const Triangles triangles = load_triangles(scene, vertices);
    const Surfaces surfaces = make_surfaces(scene, vertices, triangles, wo);
    add_emission(job, triangles.emits & all, vertices, surfaces);
    unsigned scatter = 0;
    for (uint32_t lane = 0; lane < vertices.count; ++lane) {
        scatter |= (vertices.paths[lane]->depth < job.settings.max_depth ? 1u : 0u) << lane;
    }
    if (scatter == 0) return {};
    const Vec3s wo_local = surfaces.frame.to_local(wo);
    Lobes lobes(scene, vertices, triangles.albedo);
    lobes.see_from(wo_local);
    LaneResults results;
    if (scene.lights.has_lights()) {
        results.has_shadow_ray =
            sample_direct(job, scatter, paths, surfaces, lobes, wo, wo_local, vertices, words.light, shadows);
    }
    results.goes_on = sample_scattering(job, scatter, paths, surfaces, lobes, wo, wo_local, vertices, words);
    return results;
}

constexpr VertexShading kShading = {kLanes, shade_lanes<DiffuseLobes>, shade_lanes<GlossyLobes>};

} // namespace
} // namespace pertev
