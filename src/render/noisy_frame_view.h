#pragma once

// One sample of every pixel as plain numbers, told apart by the kind of light, and the surface that its camera ray met:
// what a picture in real time is reconstructed from (denoise/). Stored, not summed: each pixel's sample is one path's,
// so no two threads write to one place.

#include <cstdint>

#include "base/host_device.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "math/vec3.h"

namespace pertev {

/// A distance that stands for "met nothing", metres.
inline constexpr float kFarAway = 0x1p40f;

/// Arrays of one element a pixel, row by row.
struct NoisyFrameView {
    Float4* light = nullptr;    // rgb of the sample, W/(sr m2); w: 0 where it was invalid, and counts as black, else 1
    Float4* diffuse = nullptr;  // rgb, what of `light` the first surface scatters by its diffuse lobes. Null: all of
                                // `light` but `emission`, in scenes that have no other lobes
    Float4* emission = nullptr; // rgb, what of `light` the camera's ray meets itself
    Float4* place = nullptr;    // bits of instance (kNoHit: nothing) and primitive, u, v
    Float4* normal = nullptr;   // unit shading normal on the camera's side; depth along the camera's axis, metres
    Float4* albedo = nullptr;   // rgb of diffuse lobes; GGX width of the sharpest other lobe, 1 without one
    Float4* gloss = nullptr;    // rgb, about the share of light that other lobes reflect; metres from the first surface
                                // to what the path met next (kFarAway: nothing)

    HD bool is_there() const { return light != nullptr; }
    HD bool splits_light() const { return diffuse != nullptr; }
};

} // namespace pertev
