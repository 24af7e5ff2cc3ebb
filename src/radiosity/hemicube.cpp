#include "radiosity/hemicube.h"

#include <algorithm>

#include "math/tree_sum.h"

namespace pertev {
namespace {

constexpr double kNearestShare = 1e-9; // relative to the triangle; anything nearer to the face's plane sets no bound

uint32_t pixel_within(double coordinate, double lowest, double extent, uint32_t pixels) {
    const double at = (coordinate - lowest) / extent * pixels;
    if (!(at > 0)) return 0;
    return at >= pixels ? pixels : static_cast<uint32_t>(at);
}

} // namespace

HemicubePixels::HemicubePixels(uint32_t resolution) : resolution_(resolution) {
    const double pixel = 2.0 / resolution;
    std::vector<double> top, side;
    for (uint32_t row = 0; row < resolution; ++row) {
        for (uint32_t column = 0; column < resolution; ++column) {
            const double x = pixel_coordinate(column, resolution, -1, 2), y = pixel_coordinate(row, resolution, -1, 2);
            const double r = x * x + y * y + 1;
            top.push_back(pixel * pixel / (static_cast<double>(kPi) * r * r));
        }
    }
    for (uint32_t row = 0; row < resolution / 2; ++row) {
        for (uint32_t column = 0; column < resolution; ++column) {
            const double x = pixel_coordinate(column, resolution, -1, 2),
                         z = pixel_coordinate(row, resolution / 2, 0, 1);
            const double r = x * x + z * z + 1;
            side.push_back(z * pixel * (1.0 / (resolution / 2)) / (static_cast<double>(kPi) * r * r));
        }
    }
    const auto sum_of = [](const std::vector<double>& shares) {
        return tree_sum(shares.size(), [&](uint64_t i) { return shares[i]; });
    };
    const double sum = sum_of(top) + 4 * sum_of(side);
    for (const double share : top) top_.push_back(static_cast<float>(share / sum));
    for (const double share : side) side_.push_back(static_cast<float>(share / sum));
}

HemicubePixels::Face HemicubePixels::face(const Frame& frame, uint32_t number) const {
    const Vec3 n = frame.normal, t = frame.tangent, b = frame.bitangent;
    const uint32_t half = resolution_ / 2;
    switch (number) {
    case 0:
        return {t, b, n, resolution_, resolution_, -1, top_.data()};
    case 1:
        return {-b, n, t, resolution_, half, 0, side_.data()};
    case 2:
        return {b, n, -t, resolution_, half, 0, side_.data()};
    case 3:
        return {t, n, b, resolution_, half, 0, side_.data()};
    default:
        return {-t, n, -b, resolution_, half, 0, side_.data()};
    }
}

bool project_to_face(const HemicubePixels::Face& face, const Vec3 (&corners)[3], HemicubeTriangle& seen) {
    DoubleVec3 p[3]; // right, up, depth
    double size = 0;
    bool any_before = false;
    for (int i = 0; i < 3; ++i) {
        const DoubleVec3 at = to_double(corners[i]);
        p[i] = {dot(to_double(face.right), at), dot(to_double(face.up), at), dot(to_double(face.forward), at)};
        size = std::max({size, ::fabs(p[i].x), ::fabs(p[i].y), ::fabs(p[i].z)});
        any_before = any_before || p[i].z > 0;
    }
    if (!any_before) return false;
    constexpr double top = 1; // up coordinate of the upper edge, of both kinds of face
    const double nearest = kNearestShare * size;
    double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
    const auto extend = [&](double x, double y, double w) {
        x0 = std::min(x0, x / w), x1 = std::max(x1, x / w);
        y0 = std::min(y0, y / w), y1 = std::max(y1, y / w);
    };
    for (int i = 0; i < 3; ++i) {
        const DoubleVec3 &a = p[i], &b = p[(i + 1) % 3];
        if (a.z > nearest) extend(a.x, a.y, a.z);
        if ((a.z > nearest) == (b.z > nearest)) continue;
        const double t = (nearest - a.z) / (b.z - a.z);
        extend(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), nearest);
    }
    if (x1 < -1 || x0 > 1 || y1 < face.lowest || y0 > top) return false;
    const double extent = top - face.lowest;
    seen.x0 = pixel_within(x0, -1, 2, face.width);
    seen.x1 = std::min(pixel_within(x1, -1, 2, face.width) + 1, face.width);
    seen.y0 = pixel_within(y0, face.lowest, extent, face.height);
    seen.y1 = std::min(pixel_within(y1, face.lowest, extent, face.height) + 1, face.height);
    for (int i = 0; i < 3; ++i) seen.edge[i] = cross(p[(i + 1) % 3], p[(i + 2) % 3]);
    seen.det = dot(p[0], seen.edge[0]);
    if (seen.det < 0) {
        for (DoubleVec3& edge : seen.edge) edge = {-edge.x, -edge.y, -edge.z};
        seen.det = -seen.det;
    }
    return seen.det > 0;
}

} // namespace pertev
