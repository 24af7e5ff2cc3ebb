#include "tests/support/chi_square.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "math/sampler.h"

namespace pertev::test {

namespace {

struct Cell {
    double x0, x1, y0, y1;
};

using Density = std::function<double(double x, double y)>;

double gauss(const Density& f, const Cell& c) {
    constexpr int kPoints = 5;
    constexpr double kNode[kPoints] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                       0.9061798459386640};
    constexpr double kWeight[kPoints] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                                         0.2369268850561891};
    double sum = 0;
    for (int j = 0; j < kPoints; j++) {
        const double y = 0.5 * (c.y0 + c.y1) + 0.5 * (c.y1 - c.y0) * kNode[j];
        for (int i = 0; i < kPoints; i++) {
            const double x = 0.5 * (c.x0 + c.x1) + 0.5 * (c.x1 - c.x0) * kNode[i];
            sum += kWeight[i] * kWeight[j] * f(x, y);
        }
    }
    return 0.25 * (c.x1 - c.x0) * (c.y1 - c.y0) * sum;
}

/// Subdivides the cell into quarters until their sum agrees with the whole, at least `least` and at most `depth` times.
/// Along a discontinuity each further subdivision takes twice the time.
double integrate(const Density& f, const Cell& c, double whole, double tolerance, int depth, int least) {
    const double xm = 0.5 * (c.x0 + c.x1), ym = 0.5 * (c.y0 + c.y1);
    const Cell quarters[4] = {{c.x0, xm, c.y0, ym}, {xm, c.x1, c.y0, ym}, {c.x0, xm, ym, c.y1}, {xm, c.x1, ym, c.y1}};
    double parts[4], sum = 0;
    for (int k = 0; k < 4; k++) sum += parts[k] = gauss(f, quarters[k]);
    if (depth == 0 || (least <= 0 && std::fabs(sum - whole) <= tolerance)) return sum;
    sum = 0;
    for (int k = 0; k < 4; k++) sum += integrate(f, quarters[k], parts[k], 0.5 * tolerance, depth - 1, least - 1);
    return sum;
}

struct Grid {
    double x0, x1, y0, y1;
    int cells_x, cells_y;

    Cell cell(int k) const {
        const double dx = (x1 - x0) / cells_x, dy = (y1 - y0) / cells_y;
        const int i = k % cells_x, j = k / cells_x;
        return {x0 + i * dx, x0 + (i + 1) * dx, y0 + j * dy, y0 + (j + 1) * dy};
    }
    int count() const { return cells_x * cells_y; }
    /// Returns the cell of a point, or count() for a point outside.
    int find(double x, double y) const {
        if (!(x >= x0 && x <= x1 && y >= y0 && y <= y1)) return count();
        const int i = std::min(static_cast<int>((x - x0) / (x1 - x0) * cells_x), cells_x - 1);
        const int j = std::min(static_cast<int>((y - y0) / (y1 - y0) * cells_y), cells_y - 1);
        return j * cells_x + i;
    }
};

/// Counts samples. `next(i)` returns the cell of sample i.
ChiSquareResult test_grid(const Grid& grid, const std::function<int(uint32_t)>& next, const Density& pdf,
                          const ChiSquareSettings& settings) {
    const uint32_t samples = settings.samples;
    const auto count = static_cast<size_t>(grid.count());
    std::vector<double> observed(count + 1), expected(count + 1);
    for (uint32_t i = 0; i < samples; i++) observed[static_cast<size_t>(next(i))] += 1;
    double integral = 0;
    const double tolerance = std::max(1e-9, 0.1 / samples); // a tenth of a sample
    for (int k = 0; k < grid.count(); k++) {
        const Cell cell = grid.cell(k);
        const double part =
            integrate(pdf, cell, gauss(pdf, cell), tolerance, settings.max_quarterings, settings.min_quarterings);
        integral += part;
        expected[static_cast<size_t>(k)] = samples * part;
    }
    // Less than 1e-6 of the samples is the error of the integration, and not a cell.
    expected[count] = integral < 1 - 1e-6 ? samples * (1 - integral) : 0;
    ChiSquareResult result = chi_square(observed, expected);
    result.integral = integral;
    if (integral > 1 + 1e-4) result.p_value = 0; // this is not a density
    return result;
}

} // namespace

double upper_gamma(double a, double x) {
    if (x <= 0) return 1;
    int sign; // std::lgamma() stores the sign in a global, which would be a data race
    const double scale = std::exp(a * std::log(x) - x - ::lgamma_r(a, &sign));
    if (x < a + 1) { // series of the lower function
        double term = 1 / a, sum = term;
        for (double n = a + 1; term > 1e-16 * sum; n += 1) sum += term *= x / n;
        return std::max(0.0, 1 - scale * sum);
    }
    // The continued fraction of the upper function (modified Lentz).
    double b = x + 1 - a, c = 1e300, d = 1 / b, fraction = d;
    for (int n = 1; n < 100'000; n++) {
        const double numerator = -n * (n - a);
        b += 2;
        d = 1 / (numerator * d + b);
        c = b + numerator / c;
        fraction *= c * d;
        if (std::fabs(c * d - 1) < 1e-15) break;
    }
    return scale * fraction;
}

bool ChiSquareResult::passes(int tests) const { return p_value >= 1 - std::pow(1 - 0.01, 1.0 / tests); }

std::string ChiSquareResult::describe() const {
    return "chi-square " + std::to_string(statistic) + " with " + std::to_string(degrees_of_freedom) +
           " degrees of freedom, p = " + std::to_string(p_value) + ", integral " + std::to_string(integral) +
           ", worst cell: " + worst_cell;
}

ChiSquareResult chi_square(std::span<const double> observed, std::span<const double> expected) {
    constexpr double kMinExpected = 5;
    std::vector<size_t> order(expected.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return expected[a] < expected[b]; });

    ChiSquareResult result;
    double pooled_observed = 0, pooled_expected = 0, worst = -1;
    bool impossible = false;
    int cells = 0;
    const auto add = [&](double o, double e, const std::string& name) {
        const double term = (o - e) * (o - e) / e;
        result.statistic += term;
        cells++;
        if (term <= worst) return;
        worst = term;
        result.worst_cell = name + " (" + std::to_string(o) + " observed, " + std::to_string(e) + " expected)";
    };
    for (const size_t k : order) {
        if (expected[k] == 0 && observed[k] > 0) {
            impossible = true;
            result.worst_cell = "cell " + std::to_string(k) + ", where the density is 0";
            break;
        }
        if (expected[k] >= kMinExpected && (pooled_expected == 0 || pooled_expected >= kMinExpected)) {
            add(observed[k], expected[k], "cell " + std::to_string(k));
        } else {
            pooled_observed += observed[k];
            pooled_expected += expected[k];
        }
    }
    if (pooled_expected > 0) add(pooled_observed, pooled_expected, "the pooled rare cells");
    result.degrees_of_freedom = cells - 1;
    if (impossible) {
        result.p_value = 0;
    } else if (result.degrees_of_freedom > 0) {
        result.p_value = upper_gamma(0.5 * result.degrees_of_freedom, 0.5 * result.statistic);
    }
    return result;
}

ChiSquareResult chi_square_of_directions(const std::function<std::optional<Vec3>(float lobe, Vec2 u)>& sample,
                                         const std::function<double(Vec3)>& pdf, const ChiSquareSettings& settings) {
    constexpr double kTurn = 6.283185307179586;
    const Grid grid{0, kTurn, -1, 1, settings.cells_x, settings.cells_y};
    const auto next = [&](uint32_t i) {
        const SampleKey key{.stream = 0, .sample = i, .seed = settings.seed};
        const Vec2 u = sample_2d(SamplerKind::Independent, key, 0);
        const float lobe = sample_1d(SamplerKind::Independent, key, 1);
        const std::optional<Vec3> w = sample(lobe, u);
        if (!w) return grid.count();
        const double phi = std::atan2(static_cast<double>(w->y), static_cast<double>(w->x));
        return grid.find(phi < 0 ? phi + kTurn : phi, std::clamp(static_cast<double>(w->z), -1.0, 1.0));
    };
    const auto density = [&](double phi, double z) {
        const double r = std::sqrt(std::max(0.0, 1 - z * z));
        return pdf(
            {static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)), static_cast<float>(z)});
    };
    return test_grid(grid, next, density, settings);
}

ChiSquareResult chi_square_of_points(const std::function<Vec2(Vec2 u)>& sample, const std::function<double(Vec2)>& pdf,
                                     Vec2 lo, Vec2 hi, const ChiSquareSettings& settings) {
    const Grid grid{static_cast<double>(lo.x), static_cast<double>(hi.x), static_cast<double>(lo.y),
                    static_cast<double>(hi.y), settings.cells_x,          settings.cells_y};
    const auto next = [&](uint32_t i) {
        const SampleKey key{.stream = 0, .sample = i, .seed = settings.seed};
        const Vec2 p = sample(sample_2d(SamplerKind::Independent, key, 0));
        return grid.find(static_cast<double>(p.x), static_cast<double>(p.y));
    };
    const auto density = [&](double x, double y) { return pdf({static_cast<float>(x), static_cast<float>(y)}); };
    return test_grid(grid, next, density, settings);
}

} // namespace pertev::test
