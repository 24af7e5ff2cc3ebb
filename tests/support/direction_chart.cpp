#include "tests/support/direction_chart.h"

#include <algorithm>
#include <cmath>

namespace pertev::test {

namespace {

constexpr double kFullTurn = 6.283185307179586;

ChartIntegral gauss(const DirectionChart& chart, const ChartRectangle& r, const std::function<ChartIntegral(Vec3)>& f) {
    constexpr int kPoints = 4;
    constexpr double kNode[kPoints] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                       0.8611363115940526};
    constexpr double kWeight[kPoints] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                         0.3478548451374538};
    const double half_x = 0.5 * (r.x1 - r.x0), half_y = 0.5 * (r.y1 - r.y0);
    ChartIntegral sum;
    for (int j = 0; j < kPoints; j++)
        for (int i = 0; i < kPoints; i++) {
            const auto place = chart.place_of({r.x0 + half_x * (1 + kNode[i]), r.y0 + half_y * (1 + kNode[j])});
            const ChartIntegral value = f(place.direction);
            const double weight = kWeight[i] * kWeight[j] * half_x * half_y * place.area;
            for (int c = 0; c < 3; c++) sum.value[c] += weight * value.value[c];
        }
    return sum;
}

ChartIntegral refine(const DirectionChart& chart, const ChartRectangle& r, double tolerance,
                     const std::function<ChartIntegral(Vec3)>& f, const ChartIntegral& whole, int depth) {
    const double xm = 0.5 * (r.x0 + r.x1), ym = 0.5 * (r.y0 + r.y1);
    const ChartRectangle quarters[4] = {
        {r.x0, xm, r.y0, ym}, {xm, r.x1, r.y0, ym}, {r.x0, xm, ym, r.y1}, {xm, r.x1, ym, r.y1}};
    ChartIntegral parts[4], sum;
    for (int k = 0; k < 4; k++) {
        parts[k] = gauss(chart, quarters[k], f);
        for (int c = 0; c < 3; c++) sum.value[c] += parts[k].value[c];
    }
    double error = 0;
    for (int c = 0; c < 3; c++) error = std::max(error, std::fabs(sum.value[c] - whole.value[c]));
    if (depth == 0 || error <= tolerance) return sum;
    sum = {};
    for (int k = 0; k < 4; k++) {
        const ChartIntegral part = refine(chart, quarters[k], tolerance, f, parts[k], depth - 1);
        for (int c = 0; c < 3; c++) sum.value[c] += part.value[c];
    }
    return sum;
}

} // namespace

DirectionChart::Point DirectionChart::point_of(Vec3 direction) const {
    const Vec3 d = frame.to_local(direction);
    const double across = std::hypot(static_cast<double>(d.x), static_cast<double>(d.y));
    const double angle = std::atan2(across, static_cast<double>(d.z));
    const double t = std::tan(0.5 * angle);
    const double turn = std::atan2(static_cast<double>(d.y), static_cast<double>(d.x)) / kFullTurn;
    return {t / (t + width), turn < 0 ? turn + 1 : turn};
}

DirectionChart::Place DirectionChart::place_of(Point p) const {
    const double t = width * p.x / (1 - p.x), s = 1 + t * t;
    const double sine = 2 * t / s, cosine = (1 - t * t) / s;
    const double dt = width / ((1 - p.x) * (1 - p.x));
    const Vec3 local = {static_cast<float>(sine * std::cos(kFullTurn * p.y)),
                        static_cast<float>(sine * std::sin(kFullTurn * p.y)), static_cast<float>(cosine)};
    return {frame.to_world(local), sine * (2 / s) * dt * kFullTurn};
}

ChartIntegral integrate_over(const DirectionChart& chart, const ChartRectangle& rectangle, double tolerance,
                             const std::function<ChartIntegral(Vec3)>& f) {
    return refine(chart, rectangle, tolerance, f, gauss(chart, rectangle, f), 8);
}

} // namespace pertev::test
