#pragma once

// Limits of input. A scene that exceeds one is refused with ErrorCode::OverLimit and a message that names it.

#include <cstddef>
#include <cstdint>

namespace pertev {

inline constexpr float kMaxCoordinate = 0x1p40f;                 // |x| of any vertex, camera or light position, metres
inline constexpr uint32_t kMaxTrianglesPerMesh = 1u << 30;       // primitive ids are 32 bit
inline constexpr uint32_t kMaxInstances = 1u << 30;              // instance ids are 32 bit
inline constexpr uint32_t kMaxLights = 1u << 30;                 // each is selected by at least one of 2^31 numbers, so
                                                                 // half of them go by power
inline constexpr uint32_t kMaxImageSide = 1u << 16;              // pixels along one side of any image
inline constexpr uint64_t kMaxImagePixels = uint64_t(1) << 30;   // pixels of one image
inline constexpr uint64_t kFreeImageBytes = uint64_t(384) << 20; // decoded; a panorama of 8192 x 4096 in float
inline constexpr uint64_t kFreeMeshBytes = uint64_t(256) << 20;  // decompressed size of a scene's files without images
inline constexpr uint64_t kMaxExpansion = 1024;                  // bytes in memory per byte of the files
inline constexpr uint64_t kFreeBakedTriangles = 1u << 21;        // in copies of shared meshes that are baked because of
                                                                 // skewed transforms
inline constexpr uint64_t kMaxBakedExpansion = 8;               // further such triangles for each of the scene's meshes
inline constexpr uint32_t kMaxSamplesPerPixel = (1u << 23) - 1; // even of the largest value they just fit the film's
                                                                // sums
inline constexpr uint32_t kMaxPathDepth = 1u << 16;
inline constexpr uint32_t kMaxTreeDepth = 255;                // depth of a ray tree, whose branches wait in memory
inline constexpr int kMaxBvhDepth = 64;                       // levels; also the capacity of a traversal stack
inline constexpr uint64_t kMaxBruteForceTriangles = 1u << 16; // for pictures whose rays test all triangles
inline constexpr uint64_t kMaxRasterTriangles = 1u << 24;     // in view of a camera whose picture is rasterized
inline constexpr float kMaxSampleValue = 0x1p40f;             // a larger sample counts as invalid

/// Bytes that files of `file_bytes` bytes may occupy in memory. Honest files stay far below; this stops a small file
/// that multiplies itself.
constexpr uint64_t justified_bytes(uint64_t free_bytes, uint64_t file_bytes) {
    return free_bytes + kMaxExpansion * file_bytes;
}

} // namespace pertev
