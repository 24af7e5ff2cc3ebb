#pragma once

// A triangle of the scene as a surface to dice: the position of its points before and after displacement, and the
// edges on it that are too long.
//
// No cracks: a point is identified by its weights, multiples of 2^-23, whose sums and differences are exact. On an
// edge one weight is 0, so a position there is a sum of two products with the same bits in both triangles that share
// the edge, and so are its normal and height if they share those of the corners. Whether an edge is halved depends
// only on its two ends, symmetrically.

#include "device_scene/scene_view.h"
#include "device_scene/textured_factor.h"
#include "render/raster/project_triangle.h"
#include "shading/texture_lookup.h"

namespace pertev {

// Heights of a material in device code: bilinear, in our own arithmetic, repeating.

struct DisplacementView {
    const float* heights = nullptr; // [height * width]; null: the material has none
    uint32_t width = 0, height = 0;
    float scale = 0, middle = 0;
    float reach = 0; // maximum displacement, in the mesh's own unit

    HD float at(Vec2 uv) const {
        const TexelPair x = linear_texels(uv.x, Wrap::Repeat, width), y = linear_texels(uv.y, Wrap::Repeat, height);
        const float *top = heights + uint64_t(y.i0) * width, *bottom = heights + uint64_t(y.i1) * width;
        const float h = lerp(lerp(top[x.i0], top[x.i1], x.t), lerp(bottom[x.i0], bottom[x.i1], x.t), y.t);
        return scale * (h - middle);
    }
};

struct DisplacementsView {
    const DisplacementView* of_material = nullptr; // [count]
    uint32_t count = 0;                            // later materials have none

    /// Returns the displacement of a material; null if it has none.
    HD const DisplacementView* find(uint32_t material) const {
        if (material >= count || of_material[material].heights == nullptr) return nullptr;
        return of_material + material;
    }
};

/// Weights of a triangle's second and third corner, and the point in camera space.
struct DicedPoint {
    Vec2 at;
    PinholePoint base, position; // before and after displacement
};

struct DicedTriangle {
    TriangleCorners corners;
    const InstanceView* placed;
    const MeshView* mesh;
    const DisplacementView* displacement; // null if there is none
    TriangleIndices indices;
    Vec3 flat_normal;                   // by the winding, mesh space; for meshes without normals
    DoubleVec3 row_x, row_y, row_depth; // rows of camera-from-mesh
    double reach;                       // maximum displacement of any coordinate in camera space, metres

    /// Loads a triangle. Returns false if it is hidden.
    HD bool begin(const Pinhole& camera, const SceneView& scene, const DisplacementsView& displacements,
                  uint32_t number) {
        if (!triangle_corners(camera, scene, number, corners)) return false;
        placed = scene.instances + corners.instance;
        mesh = scene.meshes + placed->mesh;
        indices = triangle_indices(*mesh, corners.primitive);
        displacement = displacements.find(placed->material);
        reach = 0;
        if (displacement == nullptr) return true;
        const Transform& m = placed->world_from_local;
        const auto through = [&](DoubleVec3 row) {
            const DoubleVec3 a = to_double(m.row0), b = to_double(m.row1), c = to_double(m.row2);
            return DoubleVec3{row.x * a.x + row.y * b.x + row.z * c.x, row.x * a.y + row.y * b.y + row.z * c.y,
                              row.x * a.z + row.y * b.z + row.z * c.z};
        };
        row_x = through(camera.row_x), row_y = through(camera.row_y), row_depth = through(camera.row_depth);
        reach = static_cast<double>(displacement->reach) * static_cast<double>(row_norm(m)) * camera.error_scale *
                (1 + 0x1p-20);
        const Vec3 a = mesh->positions[indices.a];
        const Vec3 ab = mesh->positions[indices.b] - a, ac = mesh->positions[indices.c] - a;
        const float size = max(max_component(abs(ab)), max_component(abs(ac)));
        flat_normal = cross((1.0f / size) * ab, ac); // scaled, because the product of two tiny edges would underflow
        return true;
    }

    /// Displacement of a point, in mesh space.
    HD DoubleVec3 moved(Vec2 at) const {
        const Vec3 normal = mesh->normals != nullptr ? interpolate(mesh->normals, indices, at.x, at.y) : flat_normal;
        const DoubleVec3 n = to_double(normal);
        const double square = dot(n, n);
        if (!(square > 0)) return {0, 0, 0};
        const Vec2 uv = mesh->uv[0] != nullptr ? interpolate(mesh->uv[0], indices, at.x, at.y) : Vec2{0, 0};
        const double by = static_cast<double>(displacement->at(uv)) / ::sqrt(square);
        return {by * n.x, by * n.y, by * n.z};
    }

    HD DicedPoint point(bool is_perspective, Vec2 at) const {
        const auto u = static_cast<double>(at.x), v = static_cast<double>(at.y), w = 1 - u - v;
        const PinholePoint &a = corners.p[0], &b = corners.p[1], &c = corners.p[2];
        const auto mix = [&](double of_a, double of_b, double of_c) { return w * of_a + u * of_b + v * of_c; };
        DicedPoint point;
        point.at = at;
        point.base = {mix(a.x, b.x, c.x), mix(a.y, b.y, c.y), 1, mix(a.depth, b.depth, c.depth)};
        point.position = point.base;
        if (displacement != nullptr) {
            const DoubleVec3 by = moved(at);
            point.position.x += dot(row_x, by), point.position.y += dot(row_y, by),
                point.position.depth += dot(row_depth, by);
        }
        if (is_perspective) point.base.w = point.base.depth, point.position.w = point.position.depth;
        return point;
    }

    /// Returns whether the edge must be halved: its length through its middle exceeds `rate` pixels, or is undefined
    /// because the edge crosses the plane of the eye.
    HD bool is_long(const Pinhole& camera, double rate, const DicedPoint& a, const DicedPoint& b) const {
        const float u = 0.5f * (a.at.x + b.at.x) * 0x1p23f, v = 0.5f * (a.at.y + b.at.y) * 0x1p23f;
        if (!(floor(u) == u && floor(v) == v)) return false; // the edge's middle would have no exact weights
        if (is_long(camera, rate, a.base, b.base)) return true;
        if (displacement == nullptr) return false;
        const PinholePoint middle = point(camera.is_perspective, 0.5f * (a.at + b.at)).position; // it may bulge
        return is_long(camera, 0.5 * rate, a.position, middle) || is_long(camera, 0.5 * rate, middle, b.position);
    }

    /// Returns whether no part of the triangle between the points can be in the picture.
    HD bool is_outside(const Pinhole& camera, const DicedPoint (&p)[3]) const {
        const double beyond = camera.filter_radius + 2; // pixels
        const double x = camera.x_of(camera.width + beyond), y = camera.y_of(camera.height + beyond);
        const double per_w = camera.is_perspective ? reach : 0;
        const double off_x = reach + per_w * x, off_y = reach + per_w * y;
        bool is_near = true, is_left = true, is_right = true, is_up = true, is_down = true;
        for (const DicedPoint& point : p) {
            const PinholePoint& q = point.base;
            is_near = is_near && q.depth < kNearest - reach;
            is_left = is_left && q.x < -x * q.w - off_x;
            is_right = is_right && q.x > x * q.w + off_x;
            is_up = is_up && q.y < -y * q.w - off_y;
            is_down = is_down && q.y > y * q.w + off_y;
        }
        return is_near || is_left || is_right || is_up || is_down;
    }

private:
    HD bool is_long(const Pinhole& camera, double rate, const PinholePoint& a, const PinholePoint& b) const {
        if (camera.is_perspective && (a.depth < kNearest || b.depth < kNearest)) {
            if (a.depth < kNearest && b.depth < kNearest) return false;
            const double size = ::fabs(a.x - b.x) + ::fabs(a.y - b.y) + ::fabs(a.depth - b.depth);
            return size > max(kNearest, 0x1p-6 * reach);
        }
        const double dx = camera.column_of(a.x / a.w) - camera.column_of(b.x / b.w);
        const double dy = camera.row_of(a.y / a.w) - camera.row_of(b.y / b.w);
        return dx * dx + dy * dy > rate * rate;
    }
};

} // namespace pertev
