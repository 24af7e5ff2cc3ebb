#pragma once

// Every limit that input can meet. A scene over one is refused with ErrorCode::OverLimit and a message that names it.

#include <cstddef>
#include <cstdint>

namespace pertev {

inline constexpr float kMaxCoordinate = 0x1p40f;           // |x| of any vertex, camera or light position, metres
inline constexpr uint32_t kMaxTrianglesPerMesh = 1u << 30; // primitive ids are 32 bit
inline constexpr uint32_t kMaxInstances = 1u << 30;        // instance ids are 32 bit
inline constexpr uint32_t kMaxLights = 1u << 30;           // each is drawn by one of 2^32 numbers, so 3/4 go by power
inline constexpr uint32_t kMaxImageSide = 1u << 16;        // pixels along one side of any image
inline constexpr uint64_t kMaxImagePixels = uint64_t(1) << 30;  // pixels of one image
inline constexpr uint32_t kMaxSamplesPerPixel = (1u << 23) - 1; // of the largest value they just fit the film's sums
inline constexpr uint32_t kMaxPathDepth = 1u << 16;
inline constexpr int kMaxBvhDepth = 64;           // levels; also the capacity of a walk's stack
inline constexpr float kMaxSampleValue = 0x1p40f; // a larger sample counts as invalid

} // namespace pertev
