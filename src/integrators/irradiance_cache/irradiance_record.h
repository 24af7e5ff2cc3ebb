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

} // namespace pertev
