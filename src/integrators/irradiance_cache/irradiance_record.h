#pragma once

// A record of the light that comes to a place, and how records near another place are put together to the light there.
//
// Sources: Ward, Rubinstein, Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988, section 3; the
// extrapolation by gradients: Ward, Heckbert, "Irradiance Gradients", EGWR 1992. The weight falls to 0 at the end of a
// record's reach, as Tabellion and Lamorlette have it ("An Approximate Global Illumination System for Computer
// Generated Films", SIGGRAPH 2004), so that light has no step there.

#include <cstdint>

#include "accel/octree/point_octree.h"
#include "base/host_device.h"
#include "device_scene/surface.h"
#include "math/rgb.h"
#include "math/scalar.h"
#include "math/vec3.h"

namespace pertev {

/// `material` of diffuse surfaces that nothing lies on: their records serve one another.
inline constexpr uint32_t kBareDiffuse = 0xffffffffu;

/// A place that light is asked for, or that a record has.
struct CachePlace {
    Vec3 position;        // moved world, metres
    Vec3 normal;          // of shading, unit, on the side that is seen
    uint32_t scatterings; // between the camera and the place
    uint32_t material;    // kBareDiffuse, or that of a surface with a reflection on its diffuse base
};

struct alignas(16) IrradianceRecord {
    CachePlace place;
    float radius;    // mean distance to what surrounds the place, metres
    Rgb light;       // irradiance over pi, W/(sr m2)
    Vec3 by_turn[3]; // what `light` grows by with a step of the normal, of each channel; across the normal
    Vec3 by_move[3]; // and with a step of the place, in a metre
    float unused[2] = {};
};
static_assert(sizeof(IrradianceRecord) == 128);

/// The light at `place`, as the record has it.
HD inline Rgb extrapolate(const IrradianceRecord& record, const CachePlace& place) {
    const Vec3 turn = place.normal - record.place.normal, move = place.position - record.place.position;
    return {record.light.r + dot(record.by_turn[0], turn) + dot(record.by_move[0], move),
            record.light.g + dot(record.by_turn[1], turn) + dot(record.by_move[1], move),
            record.light.b + dot(record.by_turn[2], turn) + dot(record.by_move[2], move)};
}

/// All records of a picture.
struct IrradianceCacheView {
    const IrradianceRecord* records;
    const float* reaches; // of each: how far it serves, metres
    PointOctreeView tree; // of spheres of these radii
    float accuracy;

    /// [0, 1]: 1 - e / accuracy, e = distance / radius + sqrt(1 - cosine of the turn), which Ward's split sphere model
    /// bounds the relative error by. 0 where the record is of other places, or lies above the surface there: it does
    /// not see what stands between.
    HD float weight(uint32_t index, const CachePlace& place, float distance_squared) const {
        const CachePlace& own = records[index].place;
        if (own.scatterings != place.scatterings || own.material != place.material) return 0;
        const float distance = sqrt(distance_squared);
        const float height = 0.5f * dot(place.position - own.position, place.normal + own.normal);
        if (height < -0.1f * distance) return 0;
        const float turned = max(1.0f - dot(place.normal, own.normal), 0.0f);
        const float along = reaches[index] > 0 ? distance / reaches[index] : 0.0f;
        return max(1.0f - along - sqrt(turned) / accuracy, 0.0f);
    }
};

struct CachedLight {
    Rgb light = {};   // irradiance over pi, W/(sr m2)
    float weight = 0; // of all records together; 0: there is none
};

/// What the records say of `place`, in the tree's order.
HD inline CachedLight look_up(const IrradianceCacheView& cache, const CachePlace& place) {
    CachedLight found;
    visit_covering(cache.tree, place.position, [&](const NearPoint& near) {
        const float weight = cache.weight(near.index, place, near.distance_squared);
        if (!(weight > 0)) return;
        found.light += weight * extrapolate(cache.records[near.index], place);
        found.weight += weight;
    });
    if (!(found.weight > 0)) return {};
    const float scale = 1.0f / found.weight;
    found.light = {max(scale * found.light.r, 0.0f), max(scale * found.light.g, 0.0f),
                   max(scale * found.light.b, 0.0f)};
    return found;
}

// A surface as the cache sees it. Records hold the light that comes to a diffuse base, so what lies on it must let
// light in alike whatever is seen: nothing, or one reflection, whose part in f(wo, wi) is a product of one of wo and
// one of wi (lobes/passage.h). The second is in the record, with the surface's material.

/// What the diffuse base sends from local wi to wo, of the light that would come evenly: [0, 1] per channel.
HD inline Rgb diffuse_reflectance(const Bsdf& bsdf, Vec3 wo, Vec3 wi) {
    return (kPi / abs(wi.z)) * bsdf.evaluate(wo, wi, only(LobeClass::Diffuse)).f;
}

struct CachedSurface {
    bool is_cached; // light may be looked up there
    float side;     // of the shading normal, seen from wo: 1 or -1

    HD CachedSurface(const Surface& surface, Vec3 wo) {
        const Bsdf& bsdf = surface.bsdf;
        const float height = dot(wo, surface.frame.normal);
        side = height < 0 ? -1.0f : 1.0f;
        is_cached = bsdf.base.kind == LobeKind::Diffuse && !bsdf.is_stacked && height != 0 &&
                    (height > 0) == (dot(wo, surface.geometric_normal) > 0);
    }
};

/// Of a surface that is_cached.
HD inline CachePlace place_of(const Surface& surface, float side, uint32_t scatterings) {
    return {surface.position, side * surface.frame.normal, scatterings,
            surface.bsdf.layer_count == 0 ? kBareDiffuse : surface.material};
}

/// Radiance towards wo of the light of a record, by the diffuse base.
HD inline Rgb sent_on(const Surface& surface, Vec3 wo, float side, Rgb light) {
    return diffuse_reflectance(surface.bsdf, surface.frame.to_local(wo), {0, 0, side}) * light;
}

/// How much of the light along local wi comes to the base, beside that along the normal: 1 where nothing lies on it.
HD inline float let_in(const Bsdf& bsdf, float side, Vec3 wi) {
    if (bsdf.layer_count == 0) return 1;
    const float straight = max_component(diffuse_reflectance(bsdf, {0, 0, side}, {0, 0, side}));
    return straight > 0 ? max_component(diffuse_reflectance(bsdf, {0, 0, side}, wi)) / straight : 0.0f;
}

} // namespace pertev
