#pragma once

// What a picture of micropolygons is asked for, beside scene and camera.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "image/image.h"
#include "math/rgb.h"
#include "math/sampler.h"

namespace pertev {

/// Heights that move the surfaces of a material along their interpolated normals, by scale (height - middle).
struct HeightMap {
    uint32_t material;     // of the scene
    Image heights;         // one channel; (u, v) = (0, 0) is the upper left corner, it repeats
    float scale = 1;       // in the mesh's own unit, of any sign
    float middle = 0;      // the height that moves nothing
    std::string text = {}; // as it was asked for

    bool operator==(const HeightMap& b) const {
        return material == b.material && heights.width == b.heights.width && heights.height == b.heights.height &&
               heights.pixels == b.heights.pixels && scale == b.scale && middle == b.middle;
    }
};
using HeightMaps = std::vector<HeightMap>;

inline constexpr float kLeastShadingRate = 0.125f, kMostShadingRate = 64; // pixels

struct ReyesSettings {
    float shading_rate = 1;                    // no edge of a micropolygon is longer, pixels
    std::shared_ptr<const HeightMaps> heights; // at most one a material; null: none
    uint32_t max_depth = 16;                   // 0: what emits alone; else direct light too
    SamplerKind sampler = SamplerKind::Sobol;
    uint32_t seed = 0;
    bool has_ambient = false; // it was asked for; else it is the mean of the environment
    Rgb ambient = {0, 0, 0};  // radiance from all around that diffuse surfaces reflect, W/(sr m2)
};

} // namespace pertev
