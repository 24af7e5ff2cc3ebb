#pragma once

// Projects a mesh's triangle to the picture: modelling and viewing transforms, clipping, conversion to fixed point.
// Vertex positions are rounded to 1/256 of a pixel once for each vertex of the mesh and each point where an edge is
// clipped, so triangles that share an edge have identical ends of it.

#include <cstdint>

#include "render/raster/clip_triangle.h"
#include "render/raster/tile_lists.h"

namespace pertev {

inline constexpr int32_t kSubpixels = 256;
inline constexpr double kNearest = 0x1p-20; // metres; anything nearer is clipped

struct TriangleCorners {
    PinholePoint p[3]; // in camera space
    uint32_t instance, primitive;
};

/// Writes the corners of triangle `number` of the scene. Returns false if it is hidden.
HD inline bool triangle_corners(const Pinhole& camera, const SceneView& scene, uint32_t number,
                                TriangleCorners& corners) {
    corners.instance = instance_of(scene, number);
    const InstanceView& placed = scene.instances[corners.instance];
    if (placed.is_hidden != 0) return false;
    corners.primitive = number - scene.first_triangle[corners.instance];
    const MeshView& mesh = scene.meshes[placed.mesh];
    const TriangleIndices at = triangle_indices(mesh, corners.primitive);
    const uint32_t indices[] = {at.a, at.b, at.c};
    for (int i = 0; i < 3; ++i) {
        corners.p[i] = camera.see(transform_in_double(placed.world_from_local, mesh.positions[indices[i]]));
    }
    return true;
}

/// The plane of a triangle, and its depth at (x, y) in camera space.
struct ProjectedPlane {
    double x, y, depth, constant; // x px + y py + depth pd = constant
    bool is_perspective;

    HD double depth_at(double px, double py) const {
        if (is_perspective) return constant / (x * px + y * py + depth);
        return (constant - x * px - y * py) / depth;
    }
};

HD inline ProjectedPlane plane_of(const PinholePoint (&corners)[3], bool is_perspective) {
    const auto point = [](const PinholePoint& p) { return DoubleVec3{p.x, p.y, p.depth}; };
    const DoubleVec3 a = point(corners[0]), normal = cross(point(corners[1]) - a, point(corners[2]) - a);
    return {normal.x, normal.y, normal.z, dot(normal, a), is_perspective};
}

struct ProjectedTriangle {
    int32_t x[kMaxCorners], y[kMaxCorners]; // 1/256 pixels from the picture's upper left corner
    int count;                              // number of corners of a convex polygon
    ProjectedPlane plane;
    double nearest = 0, farthest = 0; // depth of its corners, metres
};

/// Clips a triangle (or a line, whose third corner equals the second) to the picture widened by the pixel filter.
HD inline ClippedTriangle clip_to_picture(const Pinhole& camera, const PinholePoint (&corners)[3]) {
    const double beyond = camera.filter_radius + 2; // pixels
    const double x = camera.x_of(camera.width + beyond), y = camera.y_of(camera.height + beyond);
    ClippedTriangle seen;
    seen.count = 3;
    bool is_inside = true;
    for (int i = 0; i < 3; ++i) {
        const PinholePoint& p = seen.corners[i] = corners[i];
        is_inside = is_inside && p.depth >= kNearest && ::fabs(p.x) <= x * p.w && ::fabs(p.y) <= y * p.w;
    }
    if (is_inside) return seen;
    clip(seen, {0, 0, 0, 1}, -kNearest);
    clip(seen, {1, 0, x, 0}, 0);
    clip(seen, {-1, 0, x, 0}, 0);
    clip(seen, {0, 1, y, 0}, 0);
    clip(seen, {0, -1, y, 0}, 0);
    return seen;
}

/// Rounds a coordinate in pixels to 1/256 of a pixel.
HD inline int32_t to_subpixels(double coordinate) {
    return pixel_of(coordinate * kSubpixels + 0.5, -(1 << 28), 1 << 28);
}

/// Projects a triangle. Returns false if no part of it is visible.
HD inline bool project_triangle(const Pinhole& camera, const PinholePoint (&corners)[3], ProjectedTriangle& out) {
    const ClippedTriangle seen = clip_to_picture(camera, corners);
    out.count = seen.count;
    if (seen.count < 3) return false;
    for (int i = 0; i < seen.count; ++i) {
        const PinholePoint& p = seen.corners[i];
        out.x[i] = to_subpixels(camera.column_of(p.x / p.w));
        out.y[i] = to_subpixels(camera.row_of(p.y / p.w));
        out.nearest = i == 0 ? p.depth : min(out.nearest, p.depth);
        out.farthest = i == 0 ? p.depth : max(out.farthest, p.depth);
    }
    out.plane = plane_of(corners, camera.is_perspective);
    return true;
}

/// Weights of the second and third corner at the point of the triangle's plane on the ray through (x, y) in camera
/// space; each at least 0, their sum at most 1.
HD inline Vec2 weights_at(const PinholePoint (&corners)[3], double x, double y) {
    double b[3];
    for (int i = 0; i < 3; ++i) {
        const PinholePoint &p = corners[(i + 1) % 3], &q = corners[(i + 2) % 3];
        // (x, y, 1) . (p x q) / ..., each w being a third coordinate: with w = 1 that is twice the flat area.
        b[i] = x * (p.y * q.w - p.w * q.y) + y * (p.w * q.x - p.x * q.w) + (p.x * q.y - p.y * q.x);
    }
    const double sum = b[0] + b[1] + b[2];
    const auto u = static_cast<float>(b[1] / sum), v = static_cast<float>(b[2] / sum);
    if (!(is_finite(u) && is_finite(v))) return {1.0f / 3, 1.0f / 3};
    const Vec2 inside = {clamp(u, 0.0f, 1.0f), clamp(v, 0.0f, 1.0f)};
    const float both = inside.x + inside.y;
    return both > 1 ? Vec2{inside.x / both, inside.y / both} : inside;
}

} // namespace pertev
