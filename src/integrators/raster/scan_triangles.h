#pragma once

// Stages of a rasterized sample in order: triangles are scanned into a depth buffer, or their edges are drawn into
// it. An element of the buffer is (depth, number of the triangle) in one 64-bit number, and the minimum of all writes
// stays: the nearest triangle, or the first of equally near ones, in any order of threads.
// integrators/raster/shade_pixels.h then shades the result.

#include "device/atomic_min.h"
#include "device/atomics.h"
#include "device_scene/accept_hit.h"
#include "integrators/raster/raster_settings.h"
#include "render/picture_view.h"
#include "render/raster/scan_row.h"

namespace pertev {

inline constexpr uint64_t kNoDepth = ~uint64_t(0);

/// Data that all stages of a sample share.
struct RasterPass {
    Pinhole camera;
    PictureView picture;
    RasterSettings settings;
    uint64_t* depths; // [pixels]
    Uint2* rows;      // triangle and row, deferred to the second pass
    uint64_t* row_count;
    uint64_t max_rows;
    uint32_t sample;

    /// Position of the sample in a pixel. Sample 0 lies in the middle. Further ones follow a sequence that covers the
    /// filter evenly from its start, with the same position in every pixel: Roberts, "The Unreasonable Effectiveness of
    /// Quasirandom Sequences", 2018.
    HD SamplePosition sample_position() const {
        const uint32_t x = 0x80000000u + sample * 3242174889u, y = 0x80000000u + sample * 2447445413u;
        const auto unit = [](uint32_t bits) { return (static_cast<float>(bits >> 9) + 0.5f) * 0x1p-23f; };
        const Vec2 offset = sample_filter(picture.camera.filter, {unit(x), unit(y)});
        const auto rounded = [](float pixels) {
            return to_int(floor((pixels + 0.5f) * static_cast<float>(kSubpixels) + 0.5f), -(1 << 24), 1 << 24);
        };
        return {rounded(offset.x), rounded(offset.y)};
    }
    /// Picture position of the sample in the pixel at column `x`, row `y`.
    HD Vec2 picture_position(int32_t x, int32_t y) const {
        const SamplePosition at = sample_position();
        constexpr float kStep = 1.0f / static_cast<float>(kSubpixels);
        return {static_cast<float>(x) + kStep * static_cast<float>(at.x),
                static_cast<float>(y) + kStep * static_cast<float>(at.y)};
    }
};

/// Scan conversion of one triangle into the depth buffer.
struct TriangleScan {
    const RasterPass& pass;
    uint32_t number;
    TriangleCorners corners;
    ProjectedTriangle projected;
    bool has_alpha;

    /// Projects the triangle. Returns false if no part of it is visible.
    HD bool begin() {
        const SceneView& scene = pass.picture.scene;
        if (!triangle_corners(pass.camera, scene, number, corners)) return false;
        if (!project_triangle(pass.camera, corners.p, projected)) return false;
        const InstanceView& placed = scene.instances[corners.instance];
        has_alpha = placed.has_alpha != 0;
        if (placed.hides_back == 0) return true;
        const PictureView& picture = pass.picture;
        Vec3 direction = picture.camera.axis;
        if (pass.camera.is_perspective) {
            const MeshView& mesh = scene.meshes[placed.mesh];
            const Vec3 corner = mesh.positions[triangle_indices(mesh, corners.primitive).a];
            direction =
                transform_point(placed.world_from_local, corner) - picture.camera.view.world_from_camera.translation;
        }
        const AcceptCameraHit accept = {{scene, {}, {}, 0}, direction};
        return !accept.hits_hidden_back(corners.instance, corners.primitive);
    }
    HD void scan(int32_t row) const {
        const SamplePosition position = pass.sample_position();
        for (int k = 1; k + 1 < projected.count; ++k) {
            const PixelSpan span = span_of(projected, k, row, position, pass.camera.width);
            for (int32_t x = span.first; x <= span.last; ++x) put(x, row, position);
        }
    }

private:
    HD void put(int32_t column, int32_t row, SamplePosition position) const {
        constexpr double kStep = 1.0 / kSubpixels;
        const double x = pass.camera.x_of(column + kStep * position.x), y = pass.camera.y_of(row + kStep * position.y);
        const double depth = clamp(projected.plane.depth_at(x, y), projected.nearest, projected.farthest);
        const auto pixel = static_cast<uint32_t>(row) * pass.camera.width + static_cast<uint32_t>(column);
        if (has_alpha) {
            const Vec2 weights = weights_at(corners.p, x, y);
            const AcceptHit accept = {
                pass.picture.scene, {}, {}, coin_key({pixel, pass.sample, pass.settings.seed}, 0, false)};
            if (!accept.passes_alpha(corners.instance, corners.primitive, weights.x, weights.y)) return;
        }
        atomic_min(pass.depths + pixel, uint64_t(bits_of(static_cast<float>(depth))) << 32 | number);
    }
};

/// The stage that scans triangle i. A large one defers its rows to the second pass if there is room.
struct ScanTriangles {
    RasterPass pass;

    HD void operator()(uint32_t i) const {
        TriangleScan scan = {pass, i, {}, {}, false};
        if (!scan.begin()) return;
        const PixelSpan rows = rows_of(scan.projected, pass.sample_position(), pass.camera.height);
        if (int64_t(rows.last - rows.first) * (columns_of(scan.projected) + 8) >= 1024) {
            const auto count = static_cast<uint64_t>(rows.last - rows.first + 1);
            const uint64_t first = atomic_add(pass.row_count, count);
            if (first + count <= pass.max_rows) {
                for (uint64_t k = 0; k < count; ++k) {
                    pass.rows[first + k] = {i, static_cast<uint32_t>(rows.first) + static_cast<uint32_t>(k)};
                }
                return;
            }
            for (uint64_t k = first; k < min(first + count, pass.max_rows); ++k) pass.rows[k] = {kNoHit, 0};
        }
        for (int32_t row = rows.first; row <= rows.last; ++row) scan.scan(row);
    }
};

/// The stage that scans row i of the deferred ones.
struct ScanRows {
    RasterPass pass;

    HD void operator()(uint32_t i) const {
        if (i >= *pass.row_count) return;
        const Uint2 at = pass.rows[i];
        if (at.x == kNoHit) return; // the triangle found no room
        TriangleScan scan = {pass, at.x, {}, {}, false};
        if (scan.begin()) scan.scan(static_cast<int32_t>(at.y));
    }
};

/// The stage that draws the edges of triangle i in place of its interior. Source: Bresenham, "Algorithm for Computer
/// Control of a Digital Plotter", IBM Systems Journal 4(1), 1965.
struct DrawEdges {
    RasterPass pass;

    HD void operator()(uint32_t i) const {
        TriangleScan scan = {pass, i, {}, {}, false};
        if (!scan.begin()) return;
        for (int k = 0; k < 3; ++k) {
            const PinholePoint &a = scan.corners.p[k], &b = scan.corners.p[(k + 1) % 3];
            const PinholePoint line[3] = {a, b, b};
            const ClippedTriangle seen = clip_to_picture(pass.camera, line);
            if (seen.count >= 2) draw(i, farthest_pair(seen));
        }
    }

private:
    struct Ends {
        int32_t x[2], y[2];
        double depth[2];
    };
    /// Ends of a degenerate polygon: its first corner and the one farthest from it in the picture.
    HD Ends farthest_pair(const ClippedTriangle& seen) const {
        const SamplePosition position = pass.sample_position();
        Ends ends = {};
        double farthest = -1;
        double x0 = 0, y0 = 0;
        for (int i = 0; i < seen.count; ++i) {
            const PinholePoint& p = seen.corners[i];
            const double x = pass.camera.column_of(p.x / p.w), y = pass.camera.row_of(p.y / p.w);
            if (i == 0) x0 = x, y0 = y;
            const double distance = ::fabs(x - x0) + ::fabs(y - y0);
            const int end = i == 0 ? 0 : 1;
            if (!(distance > farthest)) continue;
            farthest = i == 0 ? -1 : distance;
            // The pixel whose sample is nearest.
            ends.x[end] = static_cast<int32_t>(floor_divide(to_subpixels(x) - position.x + kSubpixels / 2, kSubpixels));
            ends.y[end] = static_cast<int32_t>(floor_divide(to_subpixels(y) - position.y + kSubpixels / 2, kSubpixels));
            ends.depth[end] = p.depth;
        }
        return ends;
    }
    HD void draw(uint32_t number, Ends e) const {
        if (e.y[1] < e.y[0] || (e.y[1] == e.y[0] && e.x[1] < e.x[0])) { // one direction for all triangles that share
                                                                        // the edge
            e = {{e.x[1], e.x[0]}, {e.y[1], e.y[0]}, {e.depth[1], e.depth[0]}};
        }
        const int32_t across = e.x[1] < e.x[0] ? e.x[0] - e.x[1] : e.x[1] - e.x[0], down = e.y[1] - e.y[0];
        const int32_t step = e.x[1] < e.x[0] ? -1 : 1, steps = max(across, down);
        int32_t x = e.x[0], y = e.y[0], error = across - down;
        for (int32_t i = 0; i <= steps; ++i) {
            put(number, x, y, e, steps > 0 ? static_cast<double>(i) / steps : 0.0);
            const int32_t twice = 2 * error;
            if (twice > -down) error -= down, x += step;
            if (twice < across) error += across, ++y;
        }
    }
    HD void put(uint32_t number, int32_t x, int32_t y, const Ends& e, double t) const {
        const auto width = static_cast<int32_t>(pass.camera.width), height = static_cast<int32_t>(pass.camera.height);
        if (x < 0 || y < 0 || x >= width || y >= height) return;
        const double depth = pass.camera.is_perspective // the reciprocal of depth is linear in the picture
                                 ? 1 / (1 / e.depth[0] + t * (1 / e.depth[1] - 1 / e.depth[0]))
                                 : e.depth[0] + t * (e.depth[1] - e.depth[0]);
        const float least = static_cast<float>(max(depth, kNearest));
        atomic_min(pass.depths + (static_cast<uint32_t>(y) * pass.camera.width + static_cast<uint32_t>(x)),
                   uint64_t(bits_of(least)) << 32 | number);
    }
};

} // namespace pertev
