#pragma once

// The numbers that stages of the reconstruction hand on, as plain arrays of one element a pixel, row by row. What
// lives from frame to frame is there twice: the frame before is read while the present one is written.
//
// A *signal* is light that the first surface scatters, divided by how much of it the surface's own colour lets through
// (demodulated): what is left is smooth where a texture is not. There are two, by diffuse lobes and by others.

#include <cstdint>

#include "math/float4.h"
#include "math/rgb.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "render/noisy_frame_view.h"
#include "render/reproject.h"

namespace pertev {

/// Of a frame, all that the next one asks of it.
struct HistoryView {
    Float4* normal;   // NoisyFrameView's
    uint32_t* object; // instance; kNoHit: nothing
    Float4* diffuse;  // mean of the signal over the frames that saw this place; their number
    Float4* gloss;    // the same of the other signal
    Vec2* squares;    // mean square of the luminances of both
    Float4* recent;   // the same means over few frames: rgb diffuse, luminance of the other
    Float4* shown;    // rgb of the reconstructed picture; unused
};

/// Both signals, each with the variance of its mean's luminance.
struct SignalsView {
    Float4* diffuse; // rgb, variance
    Float4* gloss;
};

/// Least share of light that a signal is divided by.
inline constexpr float kLeastAlbedo = 0.01f;
HD inline Rgb divisor_of(Rgb albedo) {
    return {max(albedo.r, kLeastAlbedo), max(albedo.g, kLeastAlbedo), max(albedo.b, kLeastAlbedo)};
}

} // namespace pertev
