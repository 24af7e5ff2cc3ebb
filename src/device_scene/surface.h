#pragma once

// A hit prepared for shading: position, geometric and shading normal, BSDF and emission, with textures and vertex
// colours. One function serves baked and instanced geometry, because both read the mesh through its instance.

#include "device_scene/accept_hit.h"
#include "device_scene/make_bsdf.h"
#include "device_scene/ray_origin.h"
#include "math/frame.h"
#include "shading/shading_frame.h"
#include "shading/shadow_terminator.h"

namespace pertev {

struct Surface {
    Vec3 position;         // translated world, metres
    Vec3 error;            // bound of its rounding error, per component
    Vec3 geometric_normal; // unit, outwards at the front; wo may lie on either side
    Frame frame;           // shading frame, whose normal is within a quarter turn of it
    Bsdf bsdf;
    Rgb emission; // W/(sr m2); for an unlit surface its colour
    Rgb albedo;   // base colour, for the auxiliary channel
    TriangleId triangle;
    uint32_t material;
    bool is_unlit;
    float tilt; // tilt of the interpolated normal (shadow_terminator.h); 0 if the mesh has none

    /// Returns the context of a draw of light that is scattered to `wo`; `time` is the ray's while the shutter is open.
    HD LightContext light_context(Vec3 wo, float time = kAtRest) const {
        return {position, dot(wo, frame.normal) < 0 ? -frame.normal : frame.normal, bsdf.lets_through(), time};
    }

    /// Returns whether both directions are on the same side of the triangle.
    HD bool same_side(Vec3 wo, Vec3 wi) const {
        return (dot(wo, geometric_normal) > 0) == (dot(wi, geometric_normal) > 0);
    }
    /// Returns whether the shading frame classifies the pair as the triangle does, as reflection or transmission. Where
    /// they disagree (near the horizon of a bent normal) no light is scattered, because it would leak.
    HD bool is_consistent(Vec3 wo, Vec3 wi, Vec3 wo_local, Vec3 wi_local) const {
        return same_side(wo, wi) == (wo_local.z * wi_local.z > 0);
    }

    /// The BSDF of this triangle for light along wi to wo (unit, world space), by the lobes of `classes`. It is not
    /// reciprocal: render/particle_scatter.h has its adjoint.
    template <BsdfPass kPass = BsdfPass::Copied>
    HD BsdfValue evaluate(Vec3 wo, Vec3 wi, LobeClasses classes = kAllLobeClasses) const {
        const Vec3 wo_local = frame.to_local(wo), wi_local = frame.to_local(wi);
        if (!is_consistent(wo, wi, wo_local, wi_local)) return {};
        if (!(tilt > 0)) return bsdf.evaluate<kPass>(wo_local, wi_local, classes);
        const RaisedDirection from = lower_direction(wi_local, tilt);
        if (!(from.slope > 0)) return {};
        const BsdfValue value = bsdf.evaluate<kPass>(wo_local, from.direction, classes);
        return {(1.0f / from.slope) * value.f, value.pdf / from.slope};
    }

    /// Approximate fraction of evaluate() from diffuse lobes, [0, 1]: a guide for denoisers.
    HD Rgb diffuse_share(Vec3 wo, Vec3 wi) const { return bsdf.diffuse_share(frame.to_local(wo), frame.to_local(wi)); }

    /// Samples a wi in world space with the density of evaluate(), or that of a delta lobe; the pdf is 0 if there is no
    /// sample.
    template <BsdfPass kPass = BsdfPass::Copied>
    HD BsdfSample sample(Vec3 wo, float u_lobe, Vec2 u) const {
        const Vec3 wo_local = frame.to_local(wo);
        BsdfSample sample = bsdf.sample<kPass>(wo_local, u_lobe, u);
        if (!(sample.pdf > 0) || is_black(sample.weight)) return {};
        if (tilt > 0 && !sample.is_delta()) {
            const RaisedDirection raised = raise_direction(sample.wi, tilt);
            sample.wi = raised.direction;
            sample.pdf = sample.pdf / raised.slope;
        }
        const Vec3 wi = normalize(frame.to_world(sample.wi));
        const bool goes_on = is_consistent(wo, wi, wo_local, sample.wi);
        sample.wi = wi;
        if (goes_on) return sample;
        // A mirror or smooth glass needs no terminator correction: its direction is right unless it is below the
        // triangle's plane, where it is folded back, so that no light is lost.
        if (!sample.is_delta() || frame.normal == geometric_normal) return {};
        sample.wi = folded(wi);
        return sample;
    }

    /// The BSDF's delta direction `wi_local` for wo, in world space, folded back as in sample(). Returns false if it
    /// carries no light.
    HD bool place_specular(Vec3 wo, Vec3 wo_local, Vec3 wi_local, Vec3& wi) const {
        wi = normalize(frame.to_world(wi_local));
        if (is_consistent(wo, wi, wo_local, wi_local)) return true;
        wi = folded(wi);
        return !(frame.normal == geometric_normal);
    }

    /// Mirrors a direction at the triangle's plane.
    HD Vec3 folded(Vec3 wi) const { return wi - (2.0f * dot(wi, geometric_normal)) * geometric_normal; }
};

/// Bound of the rounding error of a point on a light, per component: 16 units, as for an unrotated instance.
template <class T = float>
HD inline Vec3Of<T> light_point_error(Vec3Of<T> point) {
    return 0x1p-20f * abs(point);
}

/// The shadow ray from a point of a surface, known to `error`, with unit normal `normal`, to a sample point on a
/// light, where it ends. `emitter_error` is a bound of the error that an emitter's motion adds to its point, metres.
HD inline Ray ray_to_light(const LightSample& light, Vec3 position, Vec3 error, Vec3 normal, float emitter_error = 0) {
    Ray ray;
    ray.origin = offset_ray_origin(position, error, normal, light.wi);
    if (light.distance < kInfinity) { // t_max = 1 is the light's point
        Vec3 end = light.light_point;
        if (light.kind() == SourceKind::Triangle) {
            const Vec3 off = light_point_error(end) + Vec3{emitter_error, emitter_error, emitter_error};
            end = offset_ray_origin(end, off, light.light_normal, -light.wi);
        }
        ray.direction = end - ray.origin;
        ray.t_max = 1;
    } else {
        ray.direction = light.wi;
        ray.t_max = kInfinity;
    }
    return ray;
}

/// Placement of an instance's mesh in the world (InstanceView).
template <class T>
struct PlacementOf {
    const TransformOf<T>& world_from_local;
    const TransformOf<T>& local_from_world;
    MaskOf<T> is_mirrored, is_baked;
};

HD inline PlacementOf<float> placement_of(const InstanceView& instance) {
    return {instance.world_from_local, instance.local_from_world, instance.is_mirrored != 0, instance.is_baked != 0};
}

/// A triangle that a ray hits. `T` is float, or eight floats at once for eight hits (math/lanes.h).
template <class T>
struct WorldTriangleOf {
    Vec3Of<T> a, ab, ac; // first corner and the edges from it, world space
    Vec3Of<T> normal;    // unit, by the winding in the mesh's own space
    Vec3Of<T> position;  // position of the hit, kept off the edges
    Vec3Of<T> error;     // bound of its rounding error and of everything that the intersection test of a triangle of
                         // this size adds, per component

    HD Vec3Of<T> at(T u, T v) const { return a + (u * ab + v * ac); }
};
struct WorldTriangle : WorldTriangleOf<float> {
    TriangleIndices i;
};

/// Bound of the rounding error of a hit's position, metres per component. In units of 2^-24: for a baked triangle the
/// traversal uses the same vertices, so the error comes from rounding the point P and the offset origin (1 each), the
/// terms of a + u ab + v ac (3) and the test of a triangle from there (6): 2 of |P| and 10 of the edges. In an instance
/// the traversal transforms the origin by L = local_from_world, t: including the rounding of L itself that is 5 |M|
/// (|L||P| + |t|), M = world_from_local. Its vertices here have an error of 4 |M||a| + 4 |T|, which is at most 8 |M|
/// (|L||P| + |t|) and 4 |M||L| of the edges. |M||L| is at least 1, so a factor of 16 covers everything.
template <class T = float>
HD inline Vec3Of<T> hit_error(const PlacementOf<T>& placement, Vec3Of<T> position, Vec3Of<T> ab, Vec3Of<T> ac) {
    const Vec3Of<T> edges = abs(ab) + abs(ac);
    const Vec3Of<T> if_baked = 0x1p-23f * abs(position) + 0x1.4p-21f * edges;
    if (!any(!placement.is_baked)) return if_baked;
    const TransformOf<T>& l = placement.local_from_world;
    const Vec3Of<T> local = transform_sizes(l, abs(position) + edges) + abs(l.translation);
    return select(placement.is_baked, if_baked, 0x1p-20f * transform_sizes(placement.world_from_local, local));
}

/// Sets all of `triangle` from its corners in local space, with the position moved off its edges so that no light leaks
/// there. At an edge the computed point may be behind a neighbour's plane by its error e (the
/// largest component), and an offset along its own normal does not correct that. So each of its weights is at least
/// 16 e s / (2 area), with s the longest component of ab and ac; that is 16 e s / length >= 4.6 e away from an edge
/// of that length. If the neighbour forms an angle x with this triangle, the origin, up to 1.7 e off this one, is
/// then 4.6 e sin x - 1.7 e cos x inside the other: more than the 1.7 e of rounding from 42 degrees to flat, and for
/// most triangles (11 e) from 17 degrees. Slivers count as at least a sixteenth as high as long, so that no point
/// moves by more than 900 e.
template <class T = float>
HD inline void place_hit(WorldTriangleOf<T>& triangle, const PlacementOf<T>& placement, Vec3Of<T> a, Vec3Of<T> b,
                         Vec3Of<T> c, T u, T v) {
    const TransformOf<T>& m = placement.world_from_local;
    triangle.a = transform_point(m, a);
    triangle.ab = transform_point(m, b) - triangle.a;
    triangle.ac = transform_point(m, c) - triangle.a;
    const T size = max(max_component(abs(triangle.ab)), max_component(abs(triangle.ac)));
    const T inv = 1.0f / size; // scaled, because the product of two tiny edges would underflow
    const Vec3Of<T> across = cross(inv * triangle.ab, inv * triangle.ac);
    const T sign = select(placement.is_mirrored, T(-1.0f), T(1.0f));
    triangle.normal = normalize_or(sign * across, {0, 0, 1});

    triangle.error = hit_error(placement, triangle.at(u, v), triangle.ab, triangle.ac);
    const T least = (16.0f * inv) * max_component(triangle.error) / max(length(across), T(0x1p-4f));
    const PointOnTriangleOf<T> uv = inset_barycentrics(u, v, min(least, T(0.25f)));
    triangle.position = triangle.at(uv.u, uv.v);
}

HD inline WorldTriangle world_triangle(const InstanceView& instance, const MeshView& mesh, const Hit& hit) {
    WorldTriangle triangle;
    triangle.i = triangle_indices(mesh, hit.primitive);
    place_hit(triangle, placement_of(instance), mesh.positions[triangle.i.a], mesh.positions[triangle.i.b],
              mesh.positions[triangle.i.c], hit.u, hit.v);
    return triangle;
}

/// Front normal for shading: the normal by the winding, which defines the emitting side (scene/material.h), or its
/// opposite if vertex normals define the other side as the front.
HD inline Vec3 front_normal(const InstanceView& instance, const MeshView& mesh, const WorldTriangle& triangle) {
    if (mesh.normals == nullptr) return triangle.normal;
    const Vec3 sum = mesh.normals[triangle.i.a] + mesh.normals[triangle.i.b] + mesh.normals[triangle.i.c];
    const bool is_behind = dot(transform_transposed(instance.local_from_world, sum), triangle.normal) < 0;
    return is_behind ? -triangle.normal : triangle.normal;
}

/// The frame before the normal map: interpolated normal and tangent, rotated like the map's coordinates.
HD inline Frame tangent_frame(const InstanceView& instance, const MeshView& mesh, const WorldTriangle& triangle,
                              const Hit& hit, Vec3 normal, const TextureRef& map) {
    if (mesh.tangents == nullptr) return make_frame(normal); // no texture coordinates either (make_tangents.h)
    const Vec4 local = interpolate(mesh.tangents, triangle.i, hit.u, hit.v);
    const Vec3 world = transform_vector(instance.world_from_local, {local.x, local.y, local.z});
    const Frame frame = frame_with_tangent(normal, world, instance.is_mirrored != 0 ? -local.w : local.w);
    return frame_of_transformed_map(frame, {map.m00, map.m01}, {map.m10, map.m11});
}

/// Sine of the angle between a vertex normal (mesh space, any length) and the geometric one.
template <class T = float>
HD inline T corner_tilt(const TransformOf<T>& local_from_world, Vec3Of<T> local_normal, Vec3Of<T> geometric_normal) {
    const Vec3Of<T> normal = transform_transposed(local_from_world, local_normal);
    return sine_between(normalize_or(normal, geometric_normal), geometric_normal);
}

/// The shading frame at the hit, seen from `wo` (unit). Writes the `tilt` of the interpolated normal, before the
/// normal map, because a map's bumps have no neighbours whose horizon matters.
template <ShadingVariant kVariant>
HD inline Frame shading_frame(const SceneView& scene, const InstanceView& instance, const MeshView& mesh,
                              const MaterialParameters& material, const WorldTriangle& triangle, const Hit& hit,
                              Vec3 geometric_normal, Vec3 wo, float& tilt) {
    tilt = 0;
    if (mesh.normals == nullptr && !has_texture<kVariant>(material.normal_texture)) return make_frame(geometric_normal);
    const Vec3 local = mesh.normals != nullptr ? interpolate(mesh.normals, triangle.i, hit.u, hit.v) : Vec3{0, 0, 0};
    Vec3 normal = world_normal(instance.local_from_world, local, geometric_normal);
    if (mesh.normals != nullptr) {
        const Vec3 corners = {corner_tilt(instance.local_from_world, mesh.normals[triangle.i.a], geometric_normal),
                              corner_tilt(instance.local_from_world, mesh.normals[triangle.i.b], geometric_normal),
                              corner_tilt(instance.local_from_world, mesh.normals[triangle.i.c], geometric_normal)};
        tilt = terminator_tilt(sine_between(normal, geometric_normal),
                               dot(Vec3{1.0f - hit.u - hit.v, hit.u, hit.v}, corners));
    }
    if (has_texture<kVariant>(material.normal_texture)) {
        const TextureRef& ref = material.normal_texture;
        const Frame frame = tangent_frame(instance, mesh, triangle, hit, normal, ref);
        const Vec4 texel = texel_at(scene, mesh, ref, triangle.i, hit.u, hit.v);
        normal = mapped_normal(frame, {texel.x, texel.y, texel.z}, material.normal_scale);
    }
    const bool behind = dot(wo, geometric_normal) < 0; // valid_normal expects the front
    const float side = behind ? -1.0f : 1.0f;
    return make_frame(side * valid_normal(side * normal, side * geometric_normal, wo));
}

/// Normal of the coat in the shading frame, z > 0. It is bent by the coat's own map alone, not by the base's.
HD_CALL inline Vec3 coat_normal(const SceneView& scene, const InstanceView& instance, const MeshView& mesh,
                                const MaterialParameters& material, const WorldTriangle& triangle, const Hit& hit,
                                Vec3 geometric_normal, Vec3 wo, const Frame& frame) {
    const Vec3 local = mesh.normals != nullptr ? interpolate(mesh.normals, triangle.i, hit.u, hit.v) : Vec3{0, 0, 0};
    Vec3 normal = world_normal(instance.local_from_world, local, geometric_normal);
    if (const TextureRef& ref = material.coat_normal_texture; ref.has_image()) {
        const Frame along = tangent_frame(instance, mesh, triangle, hit, normal, ref);
        const Vec4 texel = texel_at(scene, mesh, ref, triangle.i, hit.u, hit.v);
        normal = mapped_normal(along, {texel.x, texel.y, texel.z}, material.coat_normal_scale);
    }
    const float side = dot(wo, geometric_normal) < 0 ? -1.0f : 1.0f;
    const Vec3 bent = frame.to_local(side * valid_normal(side * normal, side * geometric_normal, wo));
    return bent.z > 0 ? normalize(bent) : Vec3{0, 0, 1};
}

/// Parameters of a material by which its reflection, or its coat, is stretched.
struct StretchParameters {
    float anisotropy, rotation;
    const TextureRef &own, &normal_map;
};

/// Returns the direction and strength of anisotropy, in the shading frame `frame` (KHR_materials_anisotropy). The
/// tangent is the normal map's, or without one that of the anisotropy's own texture.
HD_CALL inline Stretch stretch_at(const SceneView& scene, const InstanceView& instance, const MeshView& mesh,
                                  const StretchParameters& of, const WorldTriangle& triangle, const Hit& hit,
                                  const Frame& frame) {
    const TextureRef& own = of.own;
    const Frame tangents =
        tangent_frame(instance, mesh, triangle, hit, frame.normal, of.normal_map.has_image() ? of.normal_map : own);
    Stretch stretch = {{1, 0}, of.anisotropy};
    Vec2 turn = {1, 0};
    if (own.has_image()) {
        const Vec4 texel = texel_at(scene, mesh, own, triangle.i, hit.u, hit.v);
        turn = {2.0f * texel.x - 1.0f, 2.0f * texel.y - 1.0f};
        stretch.anisotropy *= clamp(texel.z, 0.0f, 1.0f);
    }
    float sine, cosine;
    sin_cos(of.rotation, sine, cosine);
    const Vec3 local = frame.to_local((cosine * turn.x - sine * turn.y) * tangents.tangent +
                                      (sine * turn.x + cosine * turn.y) * tangents.bitangent);
    const float size2 = local.x * local.x + local.y * local.y;
    if (!(size2 > 1e-12f)) return stretch;
    const float inv = 1.0f / sqrt(size2);
    stretch.along = {inv * local.x, inv * local.y};
    return stretch;
}

/// Area of a cone of `width` metres where it meets a triangle, in twice the triangle's (TriangleIndices); 0 for a
/// triangle without an area.
HD inline float footprint_on(const WorldTriangle& triangle, Vec3 direction, float width) {
    const Vec3 normal = cross(triangle.ab, triangle.ac);
    const float seen = abs(dot(normal, direction)); // twice the area, times the cosine
    const float share = width * width / max(seen, 0x1p-10f * length(normal));
    return share < kInfinity ? share : 0.0f;
}

/// The surface at `hit` for a ray that arrives along `direction` (unit). `cone_width` is the width in metres of what
/// the ray stands for there, by which its textures are filtered; 0: they are not.
template <ShadingVariant kVariant = ShadingVariant::General>
HD inline Surface make_surface(const SceneView& scene, const Hit& hit, Vec3 direction, float cone_width = 0) {
    const InstanceView& instance = scene.instances[hit.instance];
    const MeshView& mesh = scene.meshes[instance.mesh];
    const MaterialParameters& material = scene.materials[instance.material];
    WorldTriangle triangle = world_triangle(instance, mesh, hit);
    if (has_textures(kVariant) && cone_width > 0) triangle.i.footprint = footprint_on(triangle, direction, cone_width);

    const Vec3 geometric_normal = front_normal(instance, mesh, triangle);
    float tilt = 0;
    const Frame frame =
        shading_frame<kVariant>(scene, instance, mesh, material, triangle, hit, geometric_normal, -direction, tilt);
    const Rgb albedo = base_color_at<kVariant>(scene, material, mesh, triangle.i, hit.u, hit.v);
    MaterialAxesOf<kVariant> axes;
    if constexpr (kVariant == ShadingVariant::General) {
        if (material.coat_weight > 0 &&
            (material.normal_texture.has_image() || material.coat_normal_texture.has_image())) {
            axes.coat_normal =
                coat_normal(scene, instance, mesh, material, triangle, hit, geometric_normal, -direction, frame);
        }
        const auto stretch_of = [&](const StretchParameters& of) {
            return stretch_at(scene, instance, mesh, of, triangle, hit, frame);
        };
        if (material.has_anisotropy())
            axes.stretch = stretch_of({material.specular_roughness_anisotropy, material.anisotropy_rotation,
                                       material.anisotropy_texture, material.normal_texture});
        if (material.has_coat_anisotropy())
            axes.coat_stretch = stretch_of({material.coat_roughness_anisotropy, material.coat_anisotropy_rotation,
                                            material.coat_anisotropy_texture, material.coat_normal_texture});
    }
    const bool is_unlit = material.is_unlit();
    Rgb emission = {};
    if (is_unlit) {
        emission = albedo;
    } else if ((material.emission.r > 0 || material.emission.g > 0 || material.emission.b > 0) &&
               (material.two_sided_emission || dot(triangle.normal, direction) < 0)) {
        emission = emitted_radiance<emitter_variant(kVariant)>(
            scene.lights, instance.material,
            texture_coordinate(mesh, material.emission_texture, triangle.i, hit.u, hit.v), triangle.normal, direction);
    }
    // In one expression, so that the BSDF is constructed in place.
    return {.position = triangle.position,
            .error = triangle.error,
            .geometric_normal = geometric_normal,
            .frame = frame,
            .bsdf = make_bsdf<kVariant>(scene, material, mesh, triangle.i, hit.u, hit.v, albedo, axes),
            .emission = emission,
            .albedo = albedo,
            .triangle = {hit.instance, hit.primitive},
            .material = instance.material,
            .is_unlit = is_unlit,
            .tilt = tilt};
}

} // namespace pertev
