#pragma once

// A flat chart of all directions about an axis, stretched so that a lobe of a given width there fills the chart: for
// counting samples of a BSDF in cells and for integrating over the sphere. x in [0, 1] is t / (t + width) with t the
// tangent of half the angle to the axis, y in [0, 1] the turn about it.

#include <functional>
#include <span>

#include "math/frame.h"
#include "math/vec3.h"

namespace pertev::test {

struct DirectionChart {
    Frame frame;  // +z is the axis
    double width; // > 0; about the lobe's half width in radians, 1 for an even chart

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
/// Integral over the rectangle by solid angle, in up to four channels at once; quartered until two rules agree to
/// `tolerance` (half of it for each further quartering) or down to 1/256 of the side. `jumps` are the heights
/// direction.z at which f may jump: the rectangle is first cut along these circles, for two rules also agree when both
/// step over a sliver.
ChartIntegral integrate_over(const DirectionChart& chart, const ChartRectangle& rectangle, double tolerance,
                             const std::function<ChartIntegral(Vec3)>& f, std::span<const double> jumps = {});

} // namespace pertev::test
