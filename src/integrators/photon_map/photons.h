#pragma once

// Photons that a pass has left on diffuse surfaces: where, from which direction, with which power.

#include <cstddef>
#include <cstdint>

#include "device/atomic_add.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "math/scalar.h"
#include "math/vec3.h"

namespace pertev {

struct Photon {
    Vec3 position; // moved world, metres
    Vec3 wi;       // unit, to where it came from
    Vec3 normal;   // unit, of the triangle, on the side where it came from
    Rgb power;     // W, of all that the lights send in the pass, over the square of the refractive index there
    uint32_t path, scatterings;
};

/// Components by 10 bits each.
HD inline uint32_t pack_normal(Vec3 normal) {
    const auto part = [](float x) { return static_cast<uint32_t>(to_int((x + 1.0f) * 511.5f, 0, 1023)); };
    return part(normal.x) << 20 | part(normal.y) << 10 | part(normal.z);
}
HD inline Vec3 unpack_normal(uint32_t bits) {
    const auto part = [](uint32_t x) { return static_cast<float>(x & 1023u) * (1.0f / 511.5f) - 1.0f; };
    return {part(bits >> 20), part(bits >> 10), part(bits)};
}

/// Their number in the order of (path, scatterings).
HD inline uint64_t photon_key(uint32_t path, uint32_t scatterings) { return uint64_t(path) << 8 | scatterings; }

struct PhotonsView {
    // Position, in a map then 1, or 0 of one that is left out (order_photons.h); wi, bits of the normal; power, bits of
    // the scatterings.
    Float4 *places, *ways, *powers;

    HD void store(std::size_t at, const Photon& photon) const {
        const Vec3 p = photon.position, wi = photon.wi;
        places[at] = {p.x, p.y, p.z, 0};
        ways[at] = {wi.x, wi.y, wi.z, float_of(pack_normal(photon.normal))};
        powers[at] = {photon.power.r, photon.power.g, photon.power.b, float_of(photon.scatterings)};
    }
    HD PhotonsView from(uint32_t first) const { return {places + first, ways + first, powers + first}; }
};

struct PhotonCounts {
    uint32_t stored, caustic; // in both maps; of these in the caustic map
};

/// Photons as they are stored, in whatever order they come.
struct StoredPhotonsView {
    PhotonsView photons;
    uint64_t* keys; // photon_key
    PhotonCounts* counts;

    HD void add(const Photon& photon, bool is_caustic) const {
        const uint32_t at = atomic_add(&counts->stored, 1u);
        if (is_caustic) atomic_add(&counts->caustic, 1u);
        photons.store(at, photon);
        keys[at] = photon_key(photon.path, photon.scatterings);
    }
};

} // namespace pertev
