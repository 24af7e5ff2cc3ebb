#pragma once

// A camera without a lens as the rasteriser sees it: triangles in its own space, in double, and which pixels' rays can
// meet what. Its rays are those of render/camera_rays.h, wherever in the pixel filter they lie.
//
// Space: x to the right and y down in the picture, at distance 1 from the camera (perspective) or in metres
// (orthographic), so that pixels go with both; depth along the camera's axis, metres. A point is homogeneous: it is
// seen at (x / w, y / w), with w = depth or w = 1. So nothing is divided before it is clipped (Olano, Greer, "Triangle
// Scan Conversion Using 2D Homogeneous Coordinates", 1997).

#include <cstdint>
#include <string>

#include "base/host_device.h"
#include "math/double_vec3.h"
#include "math/transform.h"
#include "render/camera_rays.h"

namespace pertev {

struct PinholePoint {
    double x, y, w, depth;
};

struct Pinhole {
    DoubleVec3 row_x, row_y, row_depth; // of camera-from-world
    DoubleVec3 eye;                     // world space, metres
    bool is_perspective;
    uint32_t width, height;         // pixels
    double half_width, half_height; // of the view, x and y
    double filter_radius;           // pixels by which a sample may lie off its pixel's centre, rounding included
    double margin_x, margin_y;      // by which rounding may turn a ray, pixels
    float origin_max;               // no coordinate of a ray's origin is larger, metres
    double error_scale;             // a world error of 1 m in each coordinate is at most this much here, metres
    double distance_scale;          // a ray's t is at least depth times this

    HD PinholePoint see(DoubleVec3 world) const {
        const DoubleVec3 p = world - eye;
        const double depth = dot(row_depth, p);
        return {dot(row_x, p), dot(row_y, p), is_perspective ? depth : 1.0, depth};
    }
    /// x (y) of a place in the picture, pixels from its left (upper) edge; and back.
    HD double x_of(double place) const { return (2 * place / width - 1) * half_width; }
    HD double y_of(double place) const { return (2 * place / height - 1) * half_height; }
    HD double column_of(double x) const { return (x / half_width + 1) * 0.5 * width; }
    HD double row_of(double y) const { return (y / half_height + 1) * 0.5 * height; }
};

/// Of a camera that why_no_raster has nothing against; its transform is finite and has an inverse.
Pinhole make_pinhole(const CameraRays& camera);

/// Why no rasteriser can see by this camera; empty where one can.
std::string why_no_raster(const Camera& camera);

} // namespace pertev
