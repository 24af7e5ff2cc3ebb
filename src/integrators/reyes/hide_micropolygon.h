#pragma once

// Hiding: which samples a micropolygon covers, and of which it is the nearest. By the edge rule of the rasteriser
// (render/raster/scan_row.h), so of micropolygons that share an edge just one has a sample on it.
//
// Two passes over all micropolygons: the first finds the least (depth, triangle) of a sample, the second the least of
// that triangle's micropolygons with this depth. Both are minima, so no order of threads shows.

#include "device/atomic_add.h"
#include "device/atomic_min.h"
#include "device_scene/accept_hit.h"
#include "integrators/reyes/diced_triangle.h"
#include "integrators/reyes/piece.h"
#include "integrators/reyes/sample_lists.h"
#include "render/raster/local_light.h"

namespace pertev {

/// What all stages of a pass know.
struct ReyesPass {
    Pinhole camera;
    PictureView picture;
    DisplacementsView displacements;
    double rate; // ReyesSettings::shading_rate
    LocalLight light;
    uint32_t seed;
    uint32_t* wide; // cells that wide micropolygons have looked at, in units of kWideCells; null: nobody asks
    SampleLists samples;
};

/// Of a displaced surface the micropolygon's own winding tells its front.
HD inline bool is_hidden_back(const InstanceView& placed, const SeenPlane& plane) {
    if (placed.hides_back == 0) return false;
    const double away = plane.is_perspective ? plane.constant : plane.depth; // of the normal from the eye
    return placed.is_mirrored != 0 ? away < 0 : away > 0;
}

/// Work that a displaced scene may make, for each pixel of the picture in each of the two passes: pieces, and looks of
/// wide micropolygons at its cell. Surfaces displaced by half their size made 172 pieces.
inline constexpr uint64_t kMostWorkOfPixel = 1024;
inline constexpr uint64_t kWideCells = 256; // of no concern up to here

/// Of a picture; a tiny one may have as many as one of 64x64.
HD inline uint64_t most_work(uint64_t pixels) { return kMostWorkOfPixel * max(pixels, uint64_t(4096)); }
HD inline uint64_t most_wide(uint64_t pixels) { return min(most_work(pixels) / kWideCells, uint64_t(1) << 30); }

/// False where wide micropolygons have looked at so many cells that the pass is given up.
HD inline bool may_look(const ReyesPass& pass, uint64_t cells) {
    if (pass.wide == nullptr || cells <= kWideCells) return true;
    constexpr uint64_t kMost = 1u << 15; // so that the count does not go round, whatever a round of pieces adds
    const auto more = static_cast<uint32_t>(min(cells / kWideCells, kMost));
    return atomic_add(pass.wide, more) <= most_wide(pass.samples.pixels());
}

enum class HidingPass : uint8_t { FindNearest, FindMicropolygon };

template <HidingPass kPass>
HD void hide_micropolygon(const ReyesPass& pass, const DicedTriangle& triangle, const Piece& piece,
                          const DicedPoint (&points)[3]) {
    const PinholePoint corners[3] = {points[0].place, points[1].place, points[2].place};
    ProjectedTriangle projected;
    if (!project_triangle(pass.camera, corners, projected)) return;
    if (is_hidden_back(*triangle.placed, projected.plane)) return;
    int32_t left = projected.x[0], right = left, top = projected.y[0], bottom = top;
    for (int i = 1; i < projected.count; ++i) {
        left = min(left, projected.x[i]), right = max(right, projected.x[i]);
        top = min(top, projected.y[i]), bottom = max(bottom, projected.y[i]);
    }
    const SampleLists& samples = pass.samples;
    const Vec2 middle = middle_of(piece);
    const int32_t first_row = samples.row_of(top), last_row = samples.row_of(bottom);
    const int32_t first_column = samples.column_of(left), last_column = samples.column_of(right);
    if (!may_look(pass, uint64_t(last_row - first_row + 1) * uint64_t(last_column - first_column + 1))) return;
    for (int32_t row = first_row; row <= last_row; ++row) {
        for (int32_t column = first_column; column <= last_column; ++column) {
            for (uint32_t i = samples.head(column, row); i != kNoSample; i = samples.next[i]) {
                const SamplePlace at = samples.places[i];
                if (at.x < left || at.x > right || !has_sample(projected, at)) continue;
                constexpr double kStep = 1.0 / kSubpixels;
                const double x = pass.camera.x_of(kStep * at.x), y = pass.camera.y_of(kStep * at.y);
                const double depth = clamp(projected.plane.depth_at(x, y), projected.nearest, projected.farthest);
                const uint64_t key = uint64_t(bits_of(static_cast<float>(depth))) << 32 | piece.triangle;
                if (kPass == HidingPass::FindMicropolygon && key != samples.nearest[i]) continue;
                if (triangle.placed->has_alpha != 0) {
                    const SampleKey sample = {i % samples.pixels(), samples.first + i / samples.pixels(), pass.seed};
                    const AcceptHit accept = {pass.picture.scene, {}, {}, coin_key(sample, 0, false)};
                    const TriangleCorners& of = triangle.corners;
                    if (!accept.passes_alpha(of.instance, of.primitive, middle.x, middle.y)) continue;
                }
                if (kPass == HidingPass::FindNearest) {
                    atomic_min(samples.nearest + i, key);
                } else {
                    atomic_min(samples.ways + i, piece.way);
                }
            }
        }
    }
}

} // namespace pertev
