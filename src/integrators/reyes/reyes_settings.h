#pragma once

// Settings of a picture of micropolygons, besides scene and camera.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "image/image.h"
#include "math/rgb.h"
#include "math/sampler.h"

namespace pertev {

/// Heights that displace the surfaces of a material along their interpolated normals by scale (height - middle).
struct HeightMap {
    uint32_t material;     // index in the scene
    Image heights;         // image of one channel, repeating; (u, v) = (0, 0) is the upper left corner
    float scale = 1;       // in the mesh's own unit, of any sign
    float middle = 0;      // the height without displacement
    std::string text = {}; // text of the request

    bool operator==(const HeightMap& b) const {
        return material == b.material && heights.width == b.heights.width && heights.height == b.heights.height &&
               heights.pixels == b.heights.pixels && scale == b.scale && middle == b.middle;
    }
};
using HeightMaps = std::vector<HeightMap>;

inline constexpr float kMinShadingRate = 0.125f, kMaxShadingRate = 64; // pixels

struct ReyesSettings {
    float shading_rate = 1;                    // maximum length of a micropolygon's edge, pixels
    std::shared_ptr<const HeightMaps> heights; // at most one per material; null: none
    uint32_t max_depth = 16;                   // 0: emission only; otherwise direct light too
    SamplerKind sampler = SamplerKind::Sobol;
    uint32_t seed = 0;
    bool has_ambient = false; // `ambient` was given; otherwise it is the mean of the environment
    Rgb ambient = {0, 0, 0};  // radiance from all directions that diffuse surfaces reflect, W/(sr m2)
};

} // namespace pertev
