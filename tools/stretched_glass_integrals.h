#pragma once

// Integrates for make_lobe_tables.cpp what stretched GGX microfacets of glass lose, as a factor on what their metal and
// an even surface lose (src/shading/lobes/stretched_tables.h). Nodes are fitted to the places between them too, and
// lowered where light would be gained by more than kGain.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "beckmann_integrals.h"

namespace {

class StretchedGlassTable {
public:
    static constexpr int kIorNodes = 3, kWidthNodes = 4, kRatioNodes = 4, kAzimuthNodes = 5, kMuNodes = 8;
    static constexpr int kAverageIorNodes = 5, kAverageWidthNodes = 8, kAverageRatioNodes = 6;
    static constexpr double kUnit = 0.01; // unit of the factors, which are less than 256 of it

    Values factors;  // by side, index, wider width, ratio of widths, azimuth and cosine, in kUnit
    Values averages; // by side, index, wider width and ratio, in 1 / 65535 of what glass loses on average

    struct View {
        double x, y; // widths
        std::array<double, 3> w;
    };
    using Guess = std::function<double(const View&, double eta)>; // yields what the factors multiply

    /// `ior_at` is the index of a place in [0, 1] of the axis of indices.
    template <class IorAt>
    StretchedGlassTable(const Guess& guess, const IorAt& ior_at) : factors(size_t(2) * kNodes, 1.0) {
        Values etas;
        for (const bool inside : {false, true})
            for (int e = 0; e < kFine[0]; ++e) {
                const double ior = ior_at(double(e) / (kFine[0] - 1));
                etas.push_back(inside ? 1 / ior : ior);
            }
        const int views = kFine[1] * kFine[2] * kFine[3] * kFine[4];
        guess_.resize(etas.size() * views);
        lost_.resize(guess_.size());
        tbb::parallel_for(0, views, [&](int i) {
            const int m = i % kFine[4], p = i / kFine[4] % kFine[3], r = i / kFine[4] / kFine[3] % kFine[2],
                      x = i / kFine[4] / kFine[3] / kFine[2];
            const View view = view_at(double(x) / (kFine[1] - 1), double(r) / (kFine[2] - 1),
                                      double(p) / (kFine[3] - 1), double(m) / (kFine[4] - 1));
            const Values lost = lost_by(view, etas);
            for (size_t e = 0; e < etas.size(); ++e) {
                lost_[e * views + i] = lost[e];
                guess_[e * views + i] = guess(view, etas[e]);
            }
        });
        for (int pass = 0; pass < 40; ++pass) fit();
        for (int pass = 0; pass < 200; ++pass) lower();
        for (double& factor : factors) factor = std::floor(std::clamp(factor / kUnit, 0.0, 255.0));
        add_averages(guess, ior_at);
    }

private:
    using Cell = std::array<int, 5>; // index, width, ratio, azimuth and cosine
    static constexpr Cell kCounts = {kIorNodes, kWidthNodes, kRatioNodes, kAzimuthNodes, kMuNodes};
    static constexpr Cell kSteps = {2, 2, 2, 2, 4}; // places a cell; the curves bend most along the last axis
    static constexpr Cell kFine = [] {
        Cell fine = kCounts;
        for (int axis = 0; axis < 5; ++axis) fine[axis] = kSteps[axis] * (kCounts[axis] - 1) + 1;
        return fine;
    }();
    static constexpr int kNodes = kIorNodes * kWidthNodes * kRatioNodes * kAzimuthNodes * kMuNodes;
    static constexpr double kAlphaMin = 1e-3, kRatioMin = 0.03, kGain = 2e-4, kGainWeight = 8;

    Values guess_, lost_; // at nodes and between them

    static View view_at(double x, double ratio, double azimuth, double root) {
        const double wide = std::pow(std::lerp(std::sqrt(kAlphaMin), 1.0, x), 2), t = std::max(ratio, kRatioMin);
        const double mu = std::max(root * root, 1e-3), across = std::sqrt(1 - mu * mu);
        const double length = std::hypot(azimuth, 1 - azimuth);
        return {wide,
                std::min(std::max(wide * t * t, kAlphaMin), wide),
                {across * (1 - azimuth) / length, across * azimuth / length, mu}};
    }
    /// Shares lost of the light from one side, of each index in `etas` (far over near side).
    static Values lost_by(const View& view, const Values& etas) {
        constexpr int kHeights = 40, kAngles = 44;
        static const std::vector<Node> heights = gauss_legendre(kHeights);
        const auto [ox, oy, oz] = view.w;
        const auto slope_length = [&](double wx, double wy, double wz) {
            return std::sqrt(wz * wz + view.x * view.x * wx * wx + view.y * view.y * wy * wy);
        };
        const double s_o = slope_length(ox, oy, oz), wx = view.x * ox / s_o, wy = view.y * oy / s_o, wz = oz / s_o;
        Values lost(etas.size(), 1.0);
        for (const Node& node : heights)
            for (int j = 0; j < kAngles; ++j) {
                const double h = node.x, weight = node.weight * 6 * h * (1 - h) / kAngles;
                const double drop = h * h * (3 - 2 * h) * (1 + wz), s = std::sqrt(std::max(0.0, drop * (2 - drop)));
                const double phi = (j + 0.5) / kAngles * 2 * pi;
                double nx = view.x * (s * std::cos(phi) + wx), ny = view.y * (s * std::sin(phi) + wy);
                double nz = 1 - drop + wz;
                const double scale = 1 / std::sqrt(nx * nx + ny * ny + nz * nz);
                nx *= scale;
                ny *= scale;
                nz *= scale;
                const double c = std::clamp(ox * nx + oy * ny + oz * nz, 0.0, 1.0);
                const auto masked = [&](double ix, double iy, double iz) {
                    return iz > 0 ? (oz + s_o) * iz / (s_o * iz + slope_length(ix, iy, iz) * oz) : 0;
                };
                const double up = masked(2 * c * nx - ox, 2 * c * ny - oy, 2 * c * nz - oz);
                for (size_t e = 0; e < etas.size(); ++e) {
                    const double eta = etas[e], t2 = 1 - (1 - c * c) / (eta * eta);
                    double passed = 0, down = 0;
                    if (t2 > 0) {
                        const double t = std::sqrt(t2), a = (c - eta * t) / (c + eta * t),
                                     b = (eta * c - t) / (eta * c + t);
                        passed = 1 - 0.5 * (a * a + b * b);
                        const double k = c / eta - t;
                        down = masked(k * nx - ox / eta, k * ny - oy / eta, -(k * nz - oz / eta));
                    }
                    lost[e] -= weight * ((1 - passed) * up + passed * down);
                }
            }
        return lost;
    }

    static size_t index(const Cell& i, const Cell& counts) {
        size_t at = 0;
        for (int axis = 0; axis < 5; ++axis) at = at * counts[axis] + i[axis];
        return at;
    }
    struct Corner {
        size_t node;
        double weight;
    };
    /// Calls `visit(corners, light, lost)` for each place with what the table yields there.
    template <class Visit>
    void for_each_place(const Visit& visit) const {
        const size_t places = lost_.size() / 2;
        std::array<Corner, 32> corners;
        for (size_t at = 0; at < lost_.size(); ++at) {
            Cell i;
            size_t rest = at % places;
            for (int axis = 5; axis-- > 0; rest /= kFine[axis]) i[axis] = int(rest % kFine[axis]);
            double sum = 0;
            for (int corner = 0; corner < 32; ++corner) {
                Cell node;
                double weight = 1;
                for (int axis = 0; axis < 5; ++axis) {
                    const bool is_upper = (corner >> axis & 1) != 0;
                    const double fraction = double(i[axis] % kSteps[axis]) / kSteps[axis];
                    node[axis] = std::min(i[axis] / kSteps[axis] + (is_upper ? 1 : 0), kCounts[axis] - 1);
                    weight *= is_upper ? fraction : 1 - fraction;
                }
                corners[corner] = {at / places * kNodes + index(node, kCounts), weight};
                sum += weight * factors[corners[corner].node];
            }
            visit(corners, sum * guess_[at], lost_[at]);
        }
    }
    void fit() {
        Values is(factors.size(), 1e-9), should(is);
        for_each_place([&](const auto& corners, double light, double lost) {
            const double weight = light > lost + kGain ? kGainWeight : 1;
            for (const Corner& corner : corners) {
                is[corner.node] += weight * corner.weight * light;
                should[corner.node] += weight * corner.weight * lost;
            }
        });
        for (size_t i = 0; i < factors.size(); ++i) factors[i] = std::min(factors[i] * should[i] / is[i], 255 * kUnit);
    }
    void lower() {
        Values least(factors.size(), 1.0);
        for_each_place([&](const auto& corners, double light, double lost) {
            if (!(light > lost + kGain)) return;
            const double scale = std::pow((std::max(lost, 0.0) + kGain) / light, 0.1);
            for (const auto& [node, weight] : corners) {
                if (weight > 0) least[node] = std::min(least[node], scale);
            }
        });
        for (size_t i = 0; i < factors.size(); ++i) factors[i] *= least[i];
    }

    static std::pair<int, double> place(double x, int nodes) {
        const int node = std::clamp(int(x * (nodes - 1)), 0, nodes - 2);
        return {node, x * (nodes - 1) - node};
    }
    /// Returns what the lookup of the finished table yields without its factor at the horizon; `at` has the places of
    /// index, width and ratio.
    double looked_up(const Guess& guess, bool inside, double eta, const std::array<double, 3>& at,
                     const View& view) const {
        const double a = std::abs(view.w[0]), b = std::abs(view.w[1]);
        const std::array<double, 5> x = {at[0], at[1], at[2], a + b > 0 ? b / (a + b) : 0, std::sqrt(view.w[2])};
        double factor = 0;
        for (int corner = 0; corner < 32; ++corner) {
            double weight = 1;
            Cell node;
            for (int axis = 0; axis < 5; ++axis) {
                const auto [lower, fraction] = place(x[axis], kCounts[axis]);
                node[axis] = lower + (corner >> axis & 1);
                weight *= (corner >> axis & 1) ? fraction : 1 - fraction;
            }
            factor += weight * factors[(inside ? kNodes : 0) + index(node, kCounts)];
        }
        return std::min(factor * kUnit * guess(view, eta), 1.0);
    }
    /// Averages of the finished table over all directions, by the cosine. Interpolation is to be no less than they are.
    template <class IorAt>
    void add_averages(const Guess& guess, const IorAt& ior_at) {
        constexpr std::array<int, 3> counts = {kAverageIorNodes, kAverageWidthNodes, kAverageRatioNodes};
        constexpr std::array<int, 3> fine = {2 * counts[0] - 1, 2 * counts[1] - 1, 2 * counts[2] - 1};
        constexpr int kPlaces = fine[0] * fine[1] * fine[2];
        static const std::vector<Node> roots = gauss_legendre(24);
        Values exact(size_t(2) * kPlaces);
        tbb::parallel_for(0, 2 * kPlaces, [&](int i) {
            constexpr int kAngles = 16;
            const bool inside = i >= kPlaces;
            const int e = i % kPlaces / (fine[1] * fine[2]), x = i / fine[2] % fine[1], r = i % fine[2];
            const std::array<double, 3> at = {double(e) / (fine[0] - 1), double(x) / (fine[1] - 1),
                                              double(r) / (fine[2] - 1)};
            const double ior = ior_at(at[0]), eta = inside ? 1 / ior : ior;
            for (int j = 0; j < kAngles; ++j) {
                const double phi = (j + 0.5) / kAngles * pi / 2;
                for (const Node& node : roots) { // mu = t^2: dmu = 2 t dt
                    const double mu = node.x * node.x, across = std::sqrt(1 - mu * mu);
                    View view = view_at(at[1], at[2], 0, 1);
                    view.w = {across * std::cos(phi), across * std::sin(phi), mu};
                    exact[i] += 4 * node.x * mu * node.weight / kAngles * looked_up(guess, inside, eta, at, view);
                }
            }
        });
        const auto node = [&](int side, int e, int x, int r) {
            return ((size_t(side) * counts[0] + e) * counts[1] + x) * counts[2] + r;
        };
        averages.assign(node(2, 0, 0, 0), 0.0);
        const auto for_each = [&](const auto& visit) {
            for (int i = 0; i < 2 * kPlaces; ++i) {
                const int e = i % kPlaces / (fine[1] * fine[2]), x = i / fine[2] % fine[1], r = i % fine[2];
                std::array<size_t, 8> nodes;
                for (int corner = 0; corner < 8; ++corner) {
                    nodes[corner] = node(i / kPlaces, (e + (corner & 1)) / 2, (x + (corner >> 1 & 1)) / 2,
                                         (r + (corner >> 2 & 1)) / 2);
                }
                visit(nodes, exact[i]);
            }
        };
        for_each([&](const auto& nodes, double value) {
            if (nodes.front() == nodes.back()) averages[nodes.front()] = value;
        });
        for (int pass = 0; pass < 20; ++pass) {
            Values raise(averages.size());
            for_each([&](const auto& nodes, double value) {
                double sum = 0;
                for (const size_t i : nodes) sum += averages[i] / 8;
                for (const size_t i : nodes) raise[i] = std::max(raise[i], 0.5 * (value - sum));
            });
            for (size_t i = 0; i < averages.size(); ++i) averages[i] += raise[i];
        }
        for (double& average : averages) average = std::ceil(std::min(1.003 * average, 1.0) * 65535);
    }
};

} // namespace
