#pragma once

// A record of the light that arrives at a point, and the interpolation of records near another point.
//
// Sources: Ward, Rubinstein, Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988, section 3;
// the extrapolation by gradients: Ward, Heckbert, "Irradiance Gradients", EGWR 1992. The weight falls to 0 at the end
// of a record's range, as in Tabellion and Lamorlette ("An Approximate Global Illumination System for Computer
// Generated Films", SIGGRAPH 2004), so that light has no step there.

#include <cstdint>

#include "accel/octree/point_octree.h"
#include "base/host_device.h"
#include "device_scene/surface.h"
#include "math/rgb.h"
#include "math/scalar.h"
#include "math/vec3.h"

namespace pertev {

/// Value of `material` for diffuse surfaces without a coating; their records are interchangeable.
inline constexpr uint32_t kBareDiffuse = 0xffffffffu;

/// A point whose light is looked up, or the point of a record.
struct CachePoint {
    Vec3 position;        // translated world, metres
    Vec3 normal;          // shading normal, unit, on the visible side
    uint32_t scatterings; // scatterings between the camera and the point
    uint32_t material;    // kBareDiffuse, or the material of a surface with a reflection on its diffuse base
};

struct alignas(16) IrradianceRecord {
    CachePoint point;
    float radius;    // mean distance to the surroundings, metres
    Rgb light;       // irradiance over pi, W/(sr m2)
    Vec3 by_turn[3]; // rotational gradient of `light` per channel; perpendicular to the normal
    Vec3 by_move[3]; // translational gradient of `light` per channel, per metre
    float unused[2] = {};
};
static_assert(sizeof(IrradianceRecord) == 128);

/// The light at `point`, extrapolated from the record.
HD inline Rgb extrapolate(const IrradianceRecord& record, const CachePoint& point) {
    const Vec3 turn = point.normal - record.point.normal, move = point.position - record.point.position;
    return {record.light.r + dot(record.by_turn[0], turn) + dot(record.by_move[0], move),
            record.light.g + dot(record.by_turn[1], turn) + dot(record.by_move[1], move),
            record.light.b + dot(record.by_turn[2], turn) + dot(record.by_move[2], move)};
}

/// All records of a picture.
struct IrradianceCacheView {
    const IrradianceRecord* records;
    const float* reaches; // [record] range, metres
    PointOctreeView tree; // octree of spheres with these radii
    float accuracy;

    /// Weight of a record in [0, 1]: 1 - e / accuracy, e = distance / radius + sqrt(1 - cosine of the rotation),
    /// which bounds the relative error in Ward's split sphere model. It is 0 if the record belongs to other surfaces,
    /// or lies above the surface there, because it does not see what is between.
    HD float weight(uint32_t index, const CachePoint& point, float distance_squared) const {
        const CachePoint& own = records[index].point;
        if (own.scatterings != point.scatterings || own.material != point.material) return 0;
        const float distance = sqrt(distance_squared);
        const float height = 0.5f * dot(point.position - own.position, point.normal + own.normal);
        if (height < -0.1f * distance) return 0;
        const float turned = max(1.0f - dot(point.normal, own.normal), 0.0f);
        const float along = reaches[index] > 0 ? distance / reaches[index] : 0.0f;
        return max(1.0f - along - sqrt(turned) / accuracy, 0.0f);
    }
};

struct CachedLight {
    Rgb light = {};   // irradiance over pi, W/(sr m2)
    float weight = 0; // sum of all records' weights; 0 if there is none
};

/// Interpolates the records at `point`, in the tree's order.
HD inline CachedLight look_up(const IrradianceCacheView& cache, const CachePoint& point) {
    CachedLight found;
    visit_covering(cache.tree, point.position, [&](const NearPoint& near) {
        const float weight = cache.weight(near.index, point, near.distance_squared);
        if (!(weight > 0)) return;
        found.light += weight * extrapolate(cache.records[near.index], point);
        found.weight += weight;
    });
    if (!(found.weight > 0)) return {};
    const float scale = 1.0f / found.weight;
    found.light = {max(scale * found.light.r, 0.0f), max(scale * found.light.g, 0.0f),
                   max(scale * found.light.b, 0.0f)};
    return found;
}

// A surface as the cache sees it. Records hold the light that arrives at a diffuse base, so a coating must let light
// in independently of the viewing direction: either there is none, or one reflection, whose part in f(wo, wi) is a
// product of a function of wo and one of wi (lobes/layer_transmittance.h). The latter is in the record, with the
// surface's material.

/// Share of uniform light that the diffuse base scatters from local wi to wo: [0, 1] per channel.
HD inline Rgb diffuse_reflectance(const Bsdf& bsdf, Vec3 wo, Vec3 wi) {
    return (kPi / abs(wi.z)) * bsdf.evaluate(wo, wi, only(LobeClass::Diffuse)).f;
}

struct CachedSurface {
    bool is_cached; // whether light may be looked up there
    float side;     // side of the shading normal as seen from wo: 1 or -1

    HD CachedSurface(const Surface& surface, Vec3 wo) {
        const Bsdf& bsdf = surface.bsdf;
        const float height = dot(wo, surface.frame.normal);
        side = height < 0 ? -1.0f : 1.0f;
        is_cached = bsdf.base.kind == LobeKind::Diffuse && !bsdf.is_stacked && height != 0 &&
                    (height > 0) == (dot(wo, surface.geometric_normal) > 0);
    }
};

/// The point of a surface that is_cached.
HD inline CachePoint cache_point(const Surface& surface, float side, uint32_t scatterings) {
    return {surface.position, side * surface.frame.normal, scatterings,
            surface.bsdf.layer_count == 0 ? kBareDiffuse : surface.material};
}

/// Radiance towards wo from the light of a record, by the diffuse base.
HD inline Rgb reflected_light(const Surface& surface, Vec3 wo, float side, Rgb light) {
    return diffuse_reflectance(surface.bsdf, surface.frame.to_local(wo), {0, 0, side}) * light;
}

/// Transmittance to the base along local wi, relative to that along the normal; 1 without a coating.
HD inline float coating_transmittance(const Bsdf& bsdf, float side, Vec3 wi) {
    if (bsdf.layer_count == 0) return 1;
    const float straight = max_component(diffuse_reflectance(bsdf, {0, 0, side}, {0, 0, side}));
    return straight > 0 ? max_component(diffuse_reflectance(bsdf, {0, 0, side}, wi)) / straight : 0.0f;
}

} // namespace pertev
