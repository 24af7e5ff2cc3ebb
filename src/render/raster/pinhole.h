#pragma once

// A camera without a lens as the rasterizer sees it: triangles in its own space, in double, and the pixels whose rays
// may hit them. Its rays are those of render/camera_rays.h, anywhere in the pixel filter.
//
// The camera's space has x to the right and y down in the picture, at distance 1 from the camera (perspective) or in
// metres (orthographic), so that both increase with pixels, and depth along the camera's axis in metres. A point is
// homogeneous: it appears at (x / w, y / w), with w = depth or w = 1. Thus nothing is divided before clipping (Olano,
// Greer, "Triangle Scan Conversion Using 2D Homogeneous Coordinates", 1997).

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
    DoubleVec3 row_x, row_y, row_depth; // rows of camera-from-world
    DoubleVec3 eye;                     // world space, metres
    bool is_perspective;
    uint32_t width, height;         // pixels
    double half_width, half_height; // x and y of the view
    double centre_x, centre_y;      // see CameraView
    double filter_radius;           // maximum offset of a sample from its pixel's centre, pixels, including rounding
    double margin_x, margin_y;      // maximum displacement of a ray by rounding, pixels
    float origin_max;               // maximum |coordinate| of a ray's origin, metres
    double error_scale;             // maximum error here, in metres, for a world error of 1 m in each coordinate
    double distance_scale;          // a ray's t is at least depth times this

    HD PinholePoint see(DoubleVec3 world) const {
        const DoubleVec3 p = world - eye;
        const double depth = dot(row_depth, p);
        return {dot(row_x, p), dot(row_y, p), is_perspective ? depth : 1.0, depth};
    }
    /// Converts a position in the picture, in pixels from its left (upper) edge, to x (y), and back.
    HD double x_of(double coordinate) const { return (2 * coordinate / width - centre_x) * half_width; }
    HD double y_of(double coordinate) const { return (2 * coordinate / height - centre_y) * half_height; }
    HD double column_of(double x) const { return (x / half_width + centre_x) * 0.5 * width; }
    HD double row_of(double y) const { return (y / half_height + centre_y) * 0.5 * height; }
};

/// Makes the pinhole of a camera that why_no_raster accepts; its transform is finite and invertible.
Pinhole make_pinhole(const CameraRays& camera);

/// Returns why this camera cannot be rasterized; empty if it can.
std::string why_no_raster(const Camera& camera);

} // namespace pertev
