#pragma once

// A flat chart of all directions about an axis, stretched so that a lobe of a given width fills the chart. It serves
// to count BSDF samples in cells and to integrate over the sphere. x in [0, 1] is t / (t + width), where t is the
// tangent of half the angle to the axis, and y in [0, 1] is the turn about it.

#include <functional>
#include <span>

#include "math/frame.h"
#include "math/vec3.h"

namespace pertev::test {

struct DirectionChart {
    Frame frame;  // +z is the axis
    double width; // > 0; about half of the lobe's width in radians, 1 for a uniform chart

    struct Point {
        double x, y;
    };
    Point point_of(Vec3 direction) const;
    struct ChartPoint {
        Vec3 direction;
        double area; // solid angle over dx dy
    };
    ChartPoint chart_point(Point p) const;
};

struct ChartRectangle {
    double x0, x1, y0, y1;
};

struct ChartIntegral {
    double value[4] = {0, 0, 0, 0};
};
/// Returns the integral over the rectangle by solid angle, in up to four channels at once. Rectangles are subdivided
/// until two rules agree to `tolerance` (halved for each level) or down to 1/256 of the side. `jumps` are the heights
/// direction.z at which f may be discontinuous. The rectangle is first divided along these circles, because two rules
/// also agree if both miss a sliver.
ChartIntegral integrate_over(const DirectionChart& chart, const ChartRectangle& rectangle, double tolerance,
                             const std::function<ChartIntegral(Vec3)>& f, std::span<const double> jumps = {});

} // namespace pertev::test
