#pragma once

// Settings of `integrator=irradiance_cache`, and values that follow from them.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

struct IrradianceCacheSettings {
    float accuracy = 0.25f;         // a record covers points up to this fraction of its distance to its surroundings
    uint32_t hemisphere_rays = 768; // maximum number of rays per record
    bool show_records = false;      // draws the records into the picture
    /// Bytes of all records of the picture, which are taken from here; empty: they are made and left here; null: they
    /// are not shared.
    std::shared_ptr<std::vector<std::byte>> shared = {};

    bool operator==(const IrradianceCacheSettings&) const = default;
};

inline constexpr float kMinAccuracy = 0.01f, kMaxAccuracy = 1.0f;
inline constexpr uint32_t kFewestHemisphereRays = 16, kMaxHemisphereRays = 1u << 16;
inline constexpr uint32_t kMaxRecords = 1u << 18;

/// Stratification of a record's rays: rows from the normal to the horizon, columns around it; all cells have the same
/// cosine-weighted size.
struct HemisphereGrid {
    uint32_t rows, columns;
    HD uint32_t cells() const { return rows * columns; }
};
/// Makes a grid with about square cells: there are pi times as many columns as rows.
inline HemisphereGrid make_hemisphere_grid(uint32_t rays) {
    const auto rows = std::max(2u, static_cast<uint32_t>(sqrt(static_cast<float>(rays) * 0.31830989f)));
    return {rows, std::max(4u, rays / rows)};
}

/// Maximum number of records of a picture. Beyond it, paths find the light.
inline uint32_t max_records(uint64_t pixels) {
    return static_cast<uint32_t>(std::min<uint64_t>(pixels / 4 + 256, kMaxRecords));
}

} // namespace pertev
