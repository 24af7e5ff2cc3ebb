#pragma once

// Arrays that hold what a frame's samples meet along perfect mirrors and smooth glass, for denoisers. A *chain* is the
// part of a path from the camera up to the first surface that scatters by another than a delta lobe; it may leave the
// scene instead.

#include <cstdint>

#include "base/host_device.h"
#include "math/float4.h"

namespace pertev {

/// Maximum number of mirrors that the guides of a picture follow.
inline constexpr uint32_t kMostMirrors = 8;

/// Arrays with one element per pixel. Null if the frame does not need them.
struct MirrorChainView {
    Float4* end = nullptr;    // position of the last surface, translated world; bits of its instance, kNoHit for the
                              // background
    Float4* normal = nullptr; // unit normal there on the ray's side; bits of the turns: 1 followed by a bit for each
                              // mirror, 1 if light passed through it. 1 alone: there is no mirror
    Float4* color = nullptr;  // rgb, throughput times reflectance of that surface; probability of the turns
    Float4* seen = nullptr;   // rgb, light that the path saw after a mirror and before it was scattered otherwise

    // The number that chooses the lobe of the first surface; negative: that of the sample. Otherwise the path ends with
    // the chain, and takes the likelier turn at further mirrors.
    float lobe = -1;

    HD bool is_there() const { return end != nullptr; }
    HD bool is_guide() const { return is_there() && lobe >= 0; }
};

} // namespace pertev
