#pragma once

// What `integrator=irradiance_cache` is asked for beside scene and camera, and what follows from it.

#include <algorithm>
#include <cstdint>

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

struct IrradianceCacheSettings {
    float accuracy = 0.25f;         // a record serves places up to so much of its distance to what surrounds it
    uint32_t hemisphere_rays = 768; // of a record, at most
    bool show_records = false;      // the records are drawn into the picture

    bool operator==(const IrradianceCacheSettings&) const = default;
};

inline constexpr float kLeastAccuracy = 0.01f, kMostAccuracy = 1.0f;
inline constexpr uint32_t kFewestHemisphereRays = 16, kMostHemisphereRays = 1u << 16;
inline constexpr uint32_t kMostRecords = 1u << 18;

/// A record's rays: rows from the normal to the horizon, columns round it, all cells of the same cosine-weighted size.
struct HemisphereGrid {
    uint32_t rows, columns;
    HD uint32_t cells() const { return rows * columns; }
};
/// About as high as wide: columns are pi times the rows.
inline HemisphereGrid make_hemisphere_grid(uint32_t rays) {
    const auto rows = std::max(2u, static_cast<uint32_t>(sqrt(static_cast<float>(rays) * 0.31830989f)));
    return {rows, std::max(4u, rays / rows)};
}

/// Of a picture. Where more would be wanted, light is found by paths.
inline uint32_t most_records(uint64_t pixels) {
    return static_cast<uint32_t>(std::min<uint64_t>(pixels / 4 + 256, kMostRecords));
}

} // namespace pertev
