#pragma once

// One sample of every pixel in floats, separated by kinds of light, and the G-buffer of its first hit; the input of
// real-time reconstruction (denoise/). Samples are stored, not summed: each pixel's sample is one path, so no two
// threads write to one location.

#include <cstdint>

#include "base/host_device.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "math/vec3.h"
#include "render/mirror_chain_view.h"
#include "shading/emitter_point.h"

namespace pertev {

/// Distance that stands for "no hit", in metres.
inline constexpr float kFarAway = 0x1p40f;

/// Per-pixel data that a frame's samples leave for ReSTIR (restir/). Null if the samples keep all light.
struct FirstBounceView {
    // The samples omit direct light at the first surface, except by its delta lobes. Stored here is the sample point
    // on the light that the first bounce hit, if any.
    EmitterPoint* light = nullptr;

    // The arrays from here on are null unless the light from the point that the first bounce hit is needed too (the
    // samples include it):
    Float4* hit = nullptr; // bits of instance (kNoHit: no hit) and primitive, u, v of the point that the first
                           // bounce hit
    Float4* throughput_and_pdf = nullptr;   // rgb throughput of the path on arrival; density of the first bounce, 1/sr
    Float4* diffuse_contribution = nullptr; // rgb, the part of the sample that diffuse lobes there scatter
    Float4* continuation_weight = nullptr;  // rgb, share of the light of the rest of the path that passes through
                                            // these lobes

    HD bool leaves_direct_light() const { return light != nullptr; }
    HD bool records_bounce() const { return diffuse_contribution != nullptr; }
    HD void add_diffuse(uint32_t pixel, Rgb more) const {
        const Float4 s = diffuse_contribution[pixel];
        diffuse_contribution[pixel] = {s.x + more.r, s.y + more.g, s.z + more.b, 0};
    }
};

/// First hits of a frame: arrays with one element per pixel, row by row.
struct GBufferView {
    Float4* hit = nullptr;    // bits of instance (kNoHit: no hit) and primitive, u, v
    Float4* normal = nullptr; // unit shading normal on the camera's side; depth along the camera's axis, metres
    Float4* albedo = nullptr; // rgb of diffuse lobes; GGX width of the sharpest other lobe, or 1 without one
    Float4* gloss = nullptr;  // rgb, approximate reflectance of the other lobes; metres from the first surface to the
                              // path's next hit, kFarAway without one
};

/// G-buffer and light of a frame.
struct NoisyFrameView : GBufferView {
    Float4* light = nullptr;    // rgb of the sample, W/(sr m2); w is 1, or 0 for an invalid sample, which counts as
                                // black
    Float4* diffuse = nullptr;  // rgb, the part of `light` that the first surface scatters by diffuse lobes. Null:
                                // all of `light` but `emission`, in scenes without other lobes
    Float4* emission = nullptr; // rgb, the part of `light` that the camera ray hits directly; Gloss::transmittance
    FirstBounceView first_bounce;
    MirrorChainView mirrors;
    const Float4* aims = nullptr; // point in world space to which the camera ray of a pixel goes, where w is not 0.
                                  // Null: all rays go through their pixels

    HD bool is_there() const { return light != nullptr; }
    HD bool splits_light() const { return diffuse != nullptr; }
};

} // namespace pertev
