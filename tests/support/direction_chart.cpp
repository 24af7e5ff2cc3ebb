#include "tests/support/direction_chart.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pertev::test {

namespace {

constexpr double kFullTurn = 6.283185307179586;

/// The circle of directions of height z in the chart's polar coordinates, where a is the angle from the axis and y the
/// turn:
///     height = normal.z cos(a) + across(y) sin(a),   across(y) = tangent.z cos(2 pi y) + bitangent.z sin(2 pi y).
struct HeightCircle {
    double along, max_across, turn_of_max; // normal.z; the largest across and its y, in radians
    double height, width;                  // width of the chart

    HeightCircle(const DirectionChart& chart, double h)
        : along(static_cast<double>(chart.frame.normal.z)), height(h), width(chart.width) {
        const double x = static_cast<double>(chart.frame.tangent.z), y = static_cast<double>(chart.frame.bitangent.z);
        max_across = std::hypot(x, y);
        turn_of_max = std::atan2(y, x);
    }

    /// Appends the two x at which the circle crosses the line y, clamped to [x0, x1]. A missing one is x1.
    void add_crossings(double y, double x0, double x1, std::vector<double>& xs) const {
        const double across = max_across * std::cos(kFullTurn * y - turn_of_max), r = std::hypot(along, across);
        const double middle = std::atan2(across, along), half = std::fabs(height) < r ? std::acos(height / r) : 0;
        for (const double angle : {middle - half, middle + half}) {
            const double wrapped = std::remainder(angle, kFullTurn);
            double x = x1;
            if (half > 0 && wrapped > 0) {
                const double t = std::tan(0.5 * wrapped);
                x = std::clamp(t / (t + width), x0, x1);
            }
            xs.push_back(x);
        }
    }

    /// Appends the y at which the circle crosses the line x.
    void add_turns(double x, std::vector<double>& ys) const {
        if (!(x > 0 && x < 1)) return;
        const double angle = 2 * std::atan(width * x / (1 - x));
        add_turns_of_across((height - along * std::cos(angle)) / std::sin(angle), ys);
    }

    /// Appends the y of the lines that are tangent to the circle.
    void add_touching_turns(std::vector<double>& ys) const {
        const double square = height * height - along * along;
        if (square < 0) return;
        add_turns_of_across(std::sqrt(square), ys);
        add_turns_of_across(-std::sqrt(square), ys);
    }

private:
    void add_turns_of_across(double across, std::vector<double>& ys) const {
        if (!(std::fabs(across) < max_across)) return;
        const double half = std::acos(across / max_across);
        for (const double angle : {turn_of_max - half, turn_of_max + half}) {
            const double y = angle / kFullTurn;
            ys.push_back(y - std::floor(y));
        }
    }
};

/// The part of the chart between two neighbouring circles: for each y of a strip, from one circle's x to the next
/// one's. Integrands get it as a rectangle with s in [0, 1] and y.
struct Piece {
    const DirectionChart& chart;
    const ChartRectangle& rectangle;
    const std::vector<HeightCircle>& circles;
    size_t index; // 0 is the part from the rectangle's x0 to the first circle

    struct Sides {
        double x0, x1;
    };
    Sides sides_at(double y) const {
        if (circles.empty()) return {rectangle.x0, rectangle.x1};
        std::vector<double> xs = {rectangle.x0, rectangle.x1};
        for (const HeightCircle& circle : circles) circle.add_crossings(y, rectangle.x0, rectangle.x1, xs);
        std::sort(xs.begin(), xs.end());
        return {xs[index], xs[index + 1]};
    }
};

using Integrand = std::function<ChartIntegral(Vec3)>;

ChartIntegral gauss(const Piece& piece, const ChartRectangle& r, const Integrand& f) {
    constexpr int kPoints = 4;
    constexpr double kNode[kPoints] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                       0.8611363115940526};
    constexpr double kWeight[kPoints] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                         0.3478548451374538};
    const double half_s = 0.5 * (r.x1 - r.x0), half_y = 0.5 * (r.y1 - r.y0);
    ChartIntegral sum;
    for (int j = 0; j < kPoints; j++) {
        const double y = r.y0 + half_y * (1 + kNode[j]);
        const auto [x0, x1] = piece.sides_at(y);
        for (int i = 0; i < kPoints; i++) {
            const double s = r.x0 + half_s * (1 + kNode[i]);
            const auto place = piece.chart.chart_point({x0 + s * (x1 - x0), y});
            const ChartIntegral value = f(place.direction);
            const double weight = kWeight[i] * kWeight[j] * half_s * half_y * (x1 - x0) * place.area;
            for (int c = 0; c < 4; c++) sum.value[c] += weight * value.value[c];
        }
    }
    return sum;
}

ChartIntegral refine(const Piece& piece, const ChartRectangle& r, double tolerance, const Integrand& f,
                     const ChartIntegral& whole, int depth) {
    const double xm = 0.5 * (r.x0 + r.x1), ym = 0.5 * (r.y0 + r.y1);
    const ChartRectangle quarters[4] = {
        {r.x0, xm, r.y0, ym}, {xm, r.x1, r.y0, ym}, {r.x0, xm, ym, r.y1}, {xm, r.x1, ym, r.y1}};
    ChartIntegral parts[4], sum;
    for (int k = 0; k < 4; k++) {
        parts[k] = gauss(piece, quarters[k], f);
        for (int c = 0; c < 4; c++) sum.value[c] += parts[k].value[c];
    }
    double error = 0;
    for (int c = 0; c < 4; c++) error = std::max(error, std::fabs(sum.value[c] - whole.value[c]));
    if (depth == 0 || error <= tolerance) return sum;
    sum = {};
    for (int k = 0; k < 4; k++) {
        const ChartIntegral part = refine(piece, quarters[k], 0.5 * tolerance, f, parts[k], depth - 1);
        for (int c = 0; c < 4; c++) sum.value[c] += part.value[c];
    }
    return sum;
}

} // namespace

DirectionChart::Point DirectionChart::point_of(Vec3 direction) const {
    const Vec3 d = frame.to_local(direction);
    const double x = static_cast<double>(d.x), y = static_cast<double>(d.y), z = static_cast<double>(d.z);
    const double across = std::sqrt(x * x + y * y), length = std::sqrt(x * x + y * y + z * z);
    // The tangent of half the angle, without cancellation. It is infinite behind the axis.
    const double t = z >= 0 ? across / (length + z) : (length - z) / across;
    const double turn = std::atan2(y, x) / kFullTurn;
    return {1 / (1 + width / t), turn < 0 ? turn + 1 : turn};
}

DirectionChart::ChartPoint DirectionChart::chart_point(Point p) const {
    const double t = width * p.x / (1 - p.x), s = 1 + t * t;
    const double sine = 2 * t / s, cosine = (1 - t * t) / s;
    const double dt = width / ((1 - p.x) * (1 - p.x));
    const Vec3 local = {static_cast<float>(sine * std::cos(kFullTurn * p.y)),
                        static_cast<float>(sine * std::sin(kFullTurn * p.y)), static_cast<float>(cosine)};
    return {frame.to_world(local), sine * (2 / s) * dt * kFullTurn};
}

ChartIntegral integrate_over(const DirectionChart& chart, const ChartRectangle& rectangle, double tolerance,
                             const std::function<ChartIntegral(Vec3)>& f, std::span<const double> jumps) {
    constexpr int kMaxQuarterings = 8;
    // Returns strips of y in which the same circles cross the same sides of the rectangle.
    std::vector<double> turns;
    std::vector<HeightCircle> circles;
    for (const double height : jumps) {
        const HeightCircle circle(chart, height);
        circle.add_turns(rectangle.x0, turns);
        circle.add_turns(rectangle.x1, turns);
        circle.add_touching_turns(turns);
        circles.push_back(circle);
    }
    std::erase_if(turns, [&](double y) { return !(y > rectangle.y0 && y < rectangle.y1); });
    turns.push_back(rectangle.y0);
    turns.push_back(rectangle.y1);
    std::sort(turns.begin(), turns.end());

    ChartIntegral sum;
    for (size_t strip = 0; strip + 1 < turns.size(); strip++) {
        const ChartRectangle whole = {0, 1, turns[strip], turns[strip + 1]};
        for (size_t k = 0; k < 2 * circles.size() + 1; k++) {
            const Piece piece = {chart, rectangle, circles, k};
            const auto [x0, x1] = piece.sides_at(0.5 * (whole.y0 + whole.y1));
            if (x1 <= x0) continue;
            const ChartIntegral part = refine(piece, whole, tolerance, f, gauss(piece, whole, f), kMaxQuarterings);
            for (int c = 0; c < 4; c++) sum.value[c] += part.value[c];
        }
    }
    return sum;
}

} // namespace pertev::test
