#pragma once

// Locates patches on triangles. Each side of a triangle is a face with its own tree: a quad divides its part into
// four by the middles of the edges, and the leaves are patches.
//
// Faces are numbered 2 t + s, with the triangle's number t in the scene (SceneView::first_triangle) and its side s: 0
// in the direction of its geometric normal, 1 behind it.

#include <cstdint>

#include "base/host_device.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev {

/// Code of a root or of a quad's child: a patch's number with kIsPatch, a quad's number, or kNoPatch.
using PatchCode = uint32_t;
inline constexpr PatchCode kIsPatch = 0x80000000u, kNoPatch = 0xffffffffu;
HD inline constexpr bool is_patch(PatchCode code) { return code >= kIsPatch && code != kNoPatch; }
HD inline constexpr uint32_t number_of(PatchCode code) { return code & ~kIsPatch; }

/// A divided patch: its children at the corners, then the middle one, whose corners are the middles of the opposite
/// edges. A child quad has a greater number than its parent.
struct PatchQuad {
    PatchCode child[4];
};

struct PatchTreeView {
    const PatchCode* roots; // [faces]
    const PatchQuad* quads;

    /// The patch of `face` at `weights` of the triangle's corners, which become weights of the patch's corners.
    /// kNoPatch if the face has none.
    HD PatchCode find(uint32_t face, Vec3& weights) const {
        PatchCode code = roots[face];
        while (code < kIsPatch) code = quads[code].child[descend(weights)];
        return code;
    }

    /// The child that contains `weights`, which become weights of its corners.
    HD static uint32_t descend(Vec3& weights) {
        const Vec3 twice = 2.0f * weights;
        if (twice.x >= 1) {
            weights = {twice.x - 1.0f, twice.y, twice.z};
            return 0;
        }
        if (twice.y >= 1) {
            weights = {twice.x, twice.y - 1.0f, twice.z};
            return 1;
        }
        if (twice.z >= 1) {
            weights = {twice.x, twice.y, twice.z - 1.0f};
            return 2;
        }
        weights = {1.0f - twice.x, 1.0f - twice.y, 1.0f - twice.z};
        return 3;
    }
};

/// Corners of a patch as positions on its triangle (weights of the second and third corner).
struct PatchCorners {
    Vec2 at[3] = {{0, 0}, {1, 0}, {0, 1}};

    HD PatchCorners child(uint32_t number) const {
        const Vec2 ab = 0.5f * (at[0] + at[1]), bc = 0.5f * (at[1] + at[2]), ca = 0.5f * (at[2] + at[0]);
        switch (number) {
        case 0:
            return {{at[0], ab, ca}};
        case 1:
            return {{ab, at[1], bc}};
        case 2:
            return {{ca, bc, at[2]}};
        default:
            return {{bc, ca, ab}};
        }
    }
    /// Position on the triangle at `b`, the weights of the second and third corner of the patch.
    HD Vec2 uv_at(Vec2 b) const { return at[0] + (b.x * (at[1] - at[0]) + b.y * (at[2] - at[0])); }
    HD Vec2 middle() const { return uv_at({1.0f / 3, 1.0f / 3}); }
};

} // namespace pertev
