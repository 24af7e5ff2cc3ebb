#pragma once

// Settings of `integrator=photon_map`, and values that follow from them.

#include <cstdint>

#include "base/host_device.h"
#include "base/value_names.h"

namespace pertev {

/// The structure that finds photons near a point. All find the same ones.
enum class PhotonSearch : uint8_t {
    Grid,   // a hash grid, built on the device
    KdTree, // accel/kd_tree/point_kd_tree.h, built on the host
    Octree, // accel/octree/point_octree.h, built on the host
};

/// Method to find indirect light at the first diffuse surface.
enum class PhotonGather : uint8_t {
    Direct, // in the global map at that surface
    Final,  // by one further ray, with the global map where it arrives
};

inline constexpr ValueName<PhotonGather> kPhotonGathers[] = {{PhotonGather::Direct, "direct"},
                                                             {PhotonGather::Final, "final"}};
inline constexpr ValueName<PhotonSearch> kPhotonSearches[] = {
    {PhotonSearch::Grid, "grid"}, {PhotonSearch::KdTree, "kd-tree"}, {PhotonSearch::Octree, "octree"}};
constexpr const auto& names_of_all(PhotonGather) { return kPhotonGathers; }
constexpr const auto& names_of_all(PhotonSearch) { return kPhotonSearches; }

struct PhotonMapSettings {
    uint32_t photons = 1u << 16; // emitted per pass for each of the two maps
    float radius = 0;            // metres, for the global map of the first pass; 0: a fraction of the scene's size
    float caustic_radius = 0;    // metres, for the caustic map of the first pass; 0: a quarter of the global one's
    uint32_t nearest = 0;        // estimates light from this many photons within the radius; 0: from all within it
    PhotonGather gather = PhotonGather::Final;
    PhotonSearch search = PhotonSearch::Grid;

    bool operator==(const PhotonMapSettings&) const = default;
};

inline constexpr uint32_t kMaxPhotons = 1u << 24;      // PhotonMapSettings::photons
inline constexpr uint32_t kMaxNearestPhotons = 1024;   // PhotonMapSettings::nearest
inline constexpr uint32_t kMaxPhotonDepth = 64;        // largest max_depth, because memory is reserved for photons of
                                                       // all depths
inline constexpr uint64_t kMaxStored = (1u << 30) - 1; // photons of a pass that may be stored
/// Minimum radius of a pass, in metres. Light is divided by its square, and rounding limits the distance of points.
inline constexpr float kMinPhotonRadius = 1e-9f;
inline constexpr float kRadiusOfScene = 1.0f / 50; // fraction of the radius of a sphere around the scene
inline constexpr float kCausticRadius = 1.0f / 4;  // fraction of the global map's radius
inline constexpr float kRadiusInMedia = 2;         // over the caustic map's radius, because photons fill a volume

/// Returns whether the photons of paths with up to max_depth scatterings can be stored.
constexpr bool photons_fit(uint32_t photons, uint32_t max_depth) {
    return uint64_t(photons) * 2 * (max_depth > 1 ? max_depth - 1 : 1) <= kMaxStored;
}

/// Radius of pass `pass` relative to the first one: it shrinks so that the mean over passes converges without blur or
/// noise. Its square is the product over i = 1 .. pass of (i + a) / (i + 1), a = 2/3. Source: Knaus, Zwicker,
/// "Progressive Photon Mapping: A Probabilistic Approach", 2011, equation 15.
float radius_of_pass(uint32_t pass);
/// Returns the radius of a pass in media, relative to the first one. Its cube is the product of radius_of_pass() with a
/// = 4/7, so that the squared errors by blur and by noise both fall with the passes to the power -4/7.
float radius_in_media_of_pass(uint32_t pass);

} // namespace pertev
