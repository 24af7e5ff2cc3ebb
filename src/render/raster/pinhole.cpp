#include "render/raster/pinhole.h"

#include <algorithm>

namespace pertev {

Pinhole make_pinhole(const CameraRays& camera) {
    const Transform& m = camera.view.world_from_camera;
    const auto size = [](Vec3 v) { return static_cast<double>(abs(v.x) + abs(v.y) + abs(v.z)); };
    const auto size_of = [](DoubleVec3 v) { return ::fabs(v.x) + ::fabs(v.y) + ::fabs(v.z); };
    const DoubleVec3 c0 = to_double(column(m, 0)), c1 = to_double(column(m, 1)), c2 = to_double(column(m, 2));
    const double inverse_determinant = 1 / dot(c0, cross(c1, c2));
    const auto scaled = [](double k, DoubleVec3 v) { return DoubleVec3{k * v.x, k * v.y, k * v.z}; };
    Pinhole p = {};
    p.row_x = scaled(inverse_determinant, cross(c1, c2));
    p.row_y = scaled(-inverse_determinant, cross(c2, c0));
    p.row_depth = scaled(-inverse_determinant, cross(c0, c1));
    p.eye = to_double(m.translation);
    p.is_perspective = !growth_of(camera.view).is_constant;
    p.width = camera.width;
    p.height = camera.height;
    p.half_width = static_cast<double>(camera.view.half_width);
    p.half_height = static_cast<double>(camera.view.half_height);
    p.centre_x = static_cast<double>(camera.view.centre.x);
    p.centre_y = static_cast<double>(camera.view.centre.y);
    p.filter_radius = static_cast<double>(camera.filter.radius) * (1 + 0x1p-10) + 0x1p-10;

    // Bound on the ray's rotation by rounding, with u = 2^-24 and M the linear part: position and view contribute at
    // most 10 u of the view, and the direction's product with M and its length 8 u |M| |direction|, which is at most
    // |M^-1| times that much here.
    const double norm = std::max(size(m.row0), std::max(size(m.row1), size(m.row2)));
    p.error_scale = std::max(size_of(p.row_x), std::max(size_of(p.row_y), size_of(p.row_depth)));
    const double condition = norm * p.error_scale;
    const auto farther = [](double centre) { return 1 + ::fabs(centre - 1); }; // farther of two opposite edges
    const double view = std::max(farther(p.centre_x) * p.half_width, farther(p.centre_y) * p.half_height) *
                        (1 + 2 * (p.filter_radius + 1) / std::min(p.width, p.height));
    const double reach = std::max(1.0, view);
    const double margin = 0x1p-18 * condition * (p.is_perspective ? reach * (1 + reach) : view);
    p.margin_x = margin / p.half_width * 0.5 * p.width;
    p.margin_y = margin / p.half_height * 0.5 * p.height;
    p.origin_max = max_component(abs(m.translation));
    if (!p.is_perspective) p.origin_max += static_cast<float>(2 * norm * view);

    // t is depth times the length of M (x, y, -1): for a rotation at least 1, less the deviation of M from one.
    double off = 0;
    for (const DoubleVec3 a : {c0, c1, c2}) {
        double row = -1; // sum of |M^T M - 1| along a row; its diagonal is positive
        for (const DoubleVec3 b : {c0, c1, c2}) row += ::fabs(dot(a, b));
        const double diagonal = dot(a, a);
        off = std::max(off, row - diagonal + 1 + ::fabs(diagonal - 1));
    }
    p.distance_scale = off < 0.5 ? (1 - off) * (1 - 0x1p-18) : 0;
    return p;
}

std::string why_no_raster(const Camera& camera) {
    if (camera.aperture_radius > 0) {
        return "rasterisation does not support this camera's lens (`aperture=0` removes it; `integrator=path` supports "
               "it)";
    }
    if (!has_straight_lens(camera)) {
        return "rasterisation does not support this camera's distortion (`integrator=path` supports it)";
    }
    if (is_light_meter(camera.projection)) {
        return "rasterisation supports only perspective and orthographic cameras";
    }
    return {};
}

} // namespace pertev
