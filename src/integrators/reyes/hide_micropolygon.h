#pragma once

// Hiding: finds the samples that a micropolygon covers and for which it is the nearest. Coverage follows the edge
// rule of the rasterizer (render/raster/scan_row.h), so exactly one of the micropolygons that share an edge has a
// sample on it.
//
// Two passes run over all micropolygons: the first finds the least (depth, triangle) of a sample, the second the
// least of that triangle's micropolygons with this depth. Both are minima, so the order of threads does not matter.

#include "device/atomic_min.h"
#include "device/atomics.h"
#include "device_scene/accept_hit.h"
#include "integrators/reyes/diced_triangle.h"
#include "integrators/reyes/piece.h"
#include "integrators/reyes/reyes_settings.h"
#include "render/picture_view.h"
#include "render/raster/local_light.h"
#include "render/raster/scan_row.h"

namespace pertev {

// Sample positions of a pass: each pixel has its own, sampled like camera rays. Each position is on the list of the
// pixel cell that contains it, which may not be its own pixel if the filter is wide. Thus a micropolygon tests only
// the samples near it.
//
// Source: Cook, "Stochastic Sampling in Computer Graphics", ACM TOG 5(1), 1986, for jittered samples.

inline constexpr uint32_t kNoSample = ~uint32_t(0);
inline constexpr uint64_t kNothingThere = ~uint64_t(0);

/// Arrays of one pass; sample s of pixel p is at s * pixels + p.
struct SampleLists {
    SamplePosition* positions; // 1/256 pixels from the picture's upper left corner
    uint64_t* nearest;         // (bits of the depth, triangle) of the nearest one, or kNothingThere
    uint64_t* split_paths;     // that triangle's micropolygon (Piece::split_path)
    uint32_t* next;            // the sample that follows on the list, or kNoSample
    uint32_t* heads;           // [pixels] head of each cell's list
    float* far; // [pixels] depth beyond which everything is hidden for all samples on the list, updated by
                // FindFar
    uint32_t width, height;
    uint32_t first, count; // samples of each pixel in this pass

    /// Cell of a position; positions outside the picture belong to the cells at its edge.
    HD int32_t column_of(int32_t x) const {
        return clamp(static_cast<int32_t>(floor_divide(x, kSubpixels)), 0, static_cast<int32_t>(width) - 1);
    }
    HD int32_t row_of(int32_t y) const {
        return clamp(static_cast<int32_t>(floor_divide(y, kSubpixels)), 0, static_cast<int32_t>(height) - 1);
    }
    HD uint32_t head(int32_t column, int32_t row) const {
        return heads[static_cast<uint32_t>(row) * width + static_cast<uint32_t>(column)];
    }
    HD float far_of(int32_t column, int32_t row) const {
        return far[static_cast<uint32_t>(row) * width + static_cast<uint32_t>(column)];
    }
    HD uint32_t pixels() const { return width * height; }
};

/// The stage that finds the position of sample i of a pass.
struct PositionSamples {
    CameraRays camera;
    SamplerKind sampler;
    uint32_t seed;
    SampleLists samples;

    HD void operator()(uint32_t i) const {
        const uint32_t pixels = samples.pixels(), pixel = i % pixels;
        const SampleKey key = {pixel, samples.first + i / pixels, seed};
        const Vec2 offset = sample_filter(camera.filter, sample_2d(sampler, key, kGroupCamera));
        const auto coordinate = [](uint32_t at, float off) {
            const float rounded = floor((0.5f + off) * static_cast<float>(kSubpixels) + 0.5f);
            return static_cast<int32_t>(at) * kSubpixels + to_int(rounded, -(1 << 24), 1 << 24);
        };
        const SamplePosition at = {coordinate(pixel % samples.width, offset.x),
                                   coordinate(pixel / samples.width, offset.y)};
        samples.positions[i] = at;
        uint32_t* head = samples.heads + static_cast<uint32_t>(samples.row_of(at.y)) * samples.width +
                         static_cast<uint32_t>(samples.column_of(at.x));
        samples.next[i] = atomic_exchange(head, i); // the order does not matter
    }
};

/// The stage that finds the farthest visible depth of the samples on the list of cell i; anything beyond it stays
/// hidden.
struct FindFar {
    SampleLists samples;

    HD void operator()(uint32_t cell) const {
        float far = 0;
        for (uint32_t i = samples.heads[cell]; i != kNoSample; i = samples.next[i]) {
            const uint64_t nearest = samples.nearest[i];
            far = nearest == kNothingThere ? kInfinity : max(far, float_of(static_cast<uint32_t>(nearest >> 32)));
            if (far == kInfinity) break;
        }
        samples.far[cell] = far;
    }
};

/// Data that all stages of a pass share.
struct ReyesPass {
    Pinhole camera;
    PictureView picture;
    DisplacementsView displacements;
    double rate; // ReyesSettings::shading_rate
    LocalLight light;
    uint32_t seed;
    uint32_t* wide; // cells that wide micropolygons have visited, in units of kWideCells; null: not counted
    SampleLists samples;
};

/// Returns whether the micropolygon is a hidden back. On a displaced surface its own winding determines its front.
HD inline bool is_hidden_back(const InstanceView& placed, const ProjectedPlane& plane) {
    if (placed.hides_back == 0) return false;
    const double away = plane.is_perspective ? plane.constant : plane.depth; // component of the normal away from the
                                                                             // eye
    return placed.is_mirrored != 0 ? away < 0 : away > 0;
}

/// Limit of the work of a displaced scene, per pixel of the picture in each of the two passes: pieces, and visits of
/// its cell by wide micropolygons. Surfaces displaced by half their size made 172 pieces.
inline constexpr uint64_t kMaxWorkOfPixel = 1024;
inline constexpr uint64_t kWideCells = 256; // micropolygons up to this size are not counted

/// Limits for a picture; a tiny one has the limit of 64x64.
HD inline uint64_t max_work(uint64_t pixels) { return kMaxWorkOfPixel * max(pixels, uint64_t(4096)); }
HD inline uint64_t max_wide(uint64_t pixels) { return min(max_work(pixels) / kWideCells, uint64_t(1) << 30); }

/// Returns false if wide micropolygons have visited so many cells that the pass is aborted.
HD inline bool may_search(const ReyesPass& pass, uint64_t cells) {
    if (pass.wide == nullptr || cells <= kWideCells) return true;
    constexpr uint64_t kMaxBlocks = 1u << 15; // prevents overflow of the count, whatever a round of pieces adds
    const auto more = static_cast<uint32_t>(min(cells / kWideCells, kMaxBlocks));
    return atomic_add(pass.wide, more) <= max_wide(pass.samples.pixels());
}

enum class HidingPass : uint8_t { FindNearest, FindMicropolygon };

template <HidingPass kPass>
HD void hide_micropolygon(const ReyesPass& pass, const DicedTriangle& triangle, const Piece& piece,
                          const DicedPoint (&points)[3]) {
    const PinholePoint corners[3] = {points[0].position, points[1].position, points[2].position};
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
    if (!may_search(pass, uint64_t(last_row - first_row + 1) * uint64_t(last_column - first_column + 1))) return;
    for (int32_t row = first_row; row <= last_row; ++row) {
        for (int32_t column = first_column; column <= last_column; ++column) {
            for (uint32_t i = samples.head(column, row); i != kNoSample; i = samples.next[i]) {
                const SamplePosition at = samples.positions[i];
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
                    atomic_min(samples.split_paths + i, piece.split_path);
                }
            }
        }
    }
}

} // namespace pertev
