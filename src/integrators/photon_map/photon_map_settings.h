#pragma once

// What `integrator=photon_map` is asked for beside scene and camera, and what follows from it.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// By which structure photons near a place are found. All of them find the same ones.
enum class PhotonSearch : uint8_t {
    Grid,   // a hash grid, built on the device
    KdTree, // accel/kd_tree/point_kd_tree.h, built on the host
    Octree, // accel/octree/point_octree.h, built on the host
};

/// How light that other surfaces send to the first diffuse one is found.
enum class PhotonGather : uint8_t {
    Direct, // in the global map, there
    Final,  // by one ray onwards; in the global map where that arrives
};

struct PhotonMapSettings {
    uint32_t photons = 1u << 16; // that leave the lights in a pass, for each of the two maps
    float radius = 0;            // metres, of the first pass's global map; 0: a share of the scene's size
    float caustic_radius = 0;    // metres, of the first pass's caustic map; 0: a quarter of the global one's
    uint32_t nearest = 0;        // light is estimated from so many photons, within the radius; 0: from all within it
    PhotonGather gather = PhotonGather::Final;
    PhotonSearch search = PhotonSearch::Grid;

    bool operator==(const PhotonMapSettings&) const = default;
};

inline constexpr uint32_t kMostPhotons = 1u << 24;    // PhotonMapSettings::photons
inline constexpr uint32_t kMostNearestPhotons = 1024; // PhotonMapSettings::nearest
inline constexpr uint32_t kMostPhotonDepth = 64;      // the largest max_depth: there is room for photons of all depths
inline constexpr uint64_t kMostStored = (1u << 30) - 1; // photons of a pass that there is room for
/// Metres: no pass has a smaller radius. Light is divided by its square, and places are no nearer to each other than
/// rounding lets them be.
inline constexpr float kLeastPhotonRadius = 1e-9f;
inline constexpr float kRadiusOfScene = 1.0f / 50; // of the radius of a sphere round the scene
inline constexpr float kCausticRadius = 1.0f / 4;  // of the global map's radius

/// Whether photons that so many scatterings let through can be kept.
constexpr bool has_room_for_photons(uint32_t photons, uint32_t max_depth) {
    return uint64_t(photons) * 2 * (max_depth > 1 ? max_depth - 1 : 1) <= kMostStored;
}

/// Of pass `pass`, times the first one's: the radius shrinks so that the mean over the passes has neither blur nor
/// noise in the end. Its square is the product over i = 1 .. pass of (i + a) / (i + 1), a = 2/3.
/// Source: Knaus, Zwicker, "Progressive Photon Mapping: A Probabilistic Approach", 2011, equation 15.
float radius_of_pass(uint32_t pass);

} // namespace pertev
