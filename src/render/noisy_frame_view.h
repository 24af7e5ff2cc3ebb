#pragma once

// One sample of every pixel as plain numbers, told apart by the kind of light, and the surface that its camera ray met:
// what a picture in real time is reconstructed from (denoise/). Stored, not summed: each pixel's sample is one path's,
// so no two threads write to one place.

#include <cstdint>

#include "base/host_device.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "math/vec3.h"
#include "shading/light_place.h"

namespace pertev {

/// A distance that stands for "met nothing", metres.
inline constexpr float kFarAway = 0x1p40f;

/// What a frame's samples leave to ReSTIR (restir/), of each pixel. Null where they keep all light.
struct FirstBounceView {
    // The samples leave out what lights send to the first surface, but by delta lobes of it; here stands the place on a
    // light that the first bounce ran into, or nowhere.
    LightPlace* light = nullptr;

    // Null unless what the place met by the first bounce sends is wanted too (the samples keep it):
    Float4* place = nullptr;   // bits of its instance (kNoHit: nothing) and primitive, u, v
    Float4* way = nullptr;     // rgb throughput of the path when it came there; density of the first bounce, 1/sr
    Float4* sent = nullptr;    // rgb, what of the sample the diffuse lobes there send
    Float4* onwards = nullptr; // rgb, while the path goes on: share of what it finds that goes through these lobes

    HD bool leaves_direct_light() const { return light != nullptr; }
    HD bool tells_bounce() const { return sent != nullptr; }
    HD void add_sent(uint32_t pixel, Rgb more) const {
        const Float4 s = sent[pixel];
        sent[pixel] = {s.x + more.r, s.y + more.g, s.z + more.b, 0};
    }
};

/// Arrays of one element a pixel, row by row.
struct NoisyFrameView {
    Float4* light = nullptr;    // rgb of the sample, W/(sr m2); w: 0 where it was invalid, and counts as black, else 1
    Float4* diffuse = nullptr;  // rgb, what of `light` the first surface scatters by its diffuse lobes. Null: all of
                                // `light` but `emission`, in scenes that have no other lobes
    Float4* emission = nullptr; // rgb, what of `light` the camera's ray meets itself; Gloss::passage
    Float4* place = nullptr;    // bits of instance (kNoHit: nothing) and primitive, u, v
    Float4* normal = nullptr;   // unit shading normal on the camera's side; depth along the camera's axis, metres
    Float4* albedo = nullptr;   // rgb of diffuse lobes; GGX width of the sharpest other lobe, 1 without one
    Float4* gloss = nullptr;    // rgb, about the share of light that other lobes reflect; metres from the first surface
                                // to what the path met next (kFarAway: nothing)
    FirstBounceView first_bounce;

    HD bool is_there() const { return light != nullptr; }
    HD bool splits_light() const { return diffuse != nullptr; }
};

} // namespace pertev
