#pragma once

// Integrates for make_lobe_tables.cpp what stretched microfacets lose: over the cosine and azimuth of a view and both
// widths, as src/shading/lobes/stretched_tables.h states.

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

#include "beckmann_integrals.h"

namespace {

/// The share of light with F = 1 that one bounce off GGX's or Beckmann's microfacets of widths `x` and `y` loses.
/// Heights and angles of normals are taken in the space where both widths are 1.
double lost_by_stretched(bool is_beckmann, double x, double y, double mu, double phi) {
    constexpr int kHeights = 32, kAngles = 64;
    static const std::vector<Node> heights = gauss_legendre(kHeights);
    static const auto angles = [] {
        std::array<std::array<double, 2>, kAngles> of;
        for (int j = 0; j < kAngles; ++j) {
            of[j] = {std::cos((j + 0.5) / kAngles * 2 * pi), std::sin((j + 0.5) / kAngles * 2 * pi)};
        }
        return of;
    }();
    const double sine = std::sqrt(std::max(0.0, 1 - mu * mu)), ox = sine * std::cos(phi), oy = sine * std::sin(phi);
    const auto slope_length = [&](double wx, double wy, double wz) {
        const double across2 = x * x * wx * wx + y * y * wy * wy;
        if (!is_beckmann) return std::sqrt(wz * wz + across2);
        const double across = std::max(std::sqrt(across2), 1e-12);
        return across * slope_lengths.at(wz / across);
    };
    const double s_o = slope_length(ox, oy, mu), across = std::sqrt(x * x * ox * ox + y * y * oy * oy);
    const double length = std::sqrt(across * across + mu * mu), wz = mu / length;
    const double cosine = across > 1e-14 ? x * ox / across : 1, turn = across > 1e-14 ? y * oy / across : 0;
    double sum = 0;
    for (const Node& node : heights) {
        const double h = node.x, u = h * h * (3 - 2 * h), weight = node.weight * 6 * h * (1 - h) / kAngles;
        const double t = u * (1 + wz);
        const double radius = is_beckmann ? std::sqrt(-std::log1p(-u)) : std::sqrt(std::max(0.0, t * (2 - t)));
        const double hz = is_beckmann ? 1 : 1 - t + wz, shift = is_beckmann ? 0 : across / length;
        for (const auto& [c, s] : angles) {
            const double hx = radius * c + shift, hy = radius * s;
            double gx = x * (hx * cosine - hy * turn), gy = y * (hx * turn + hy * cosine);
            const double scale = 1 / std::sqrt(gx * gx + gy * gy + hz * hz), gz = hz * scale;
            gx *= scale;
            gy *= scale;
            const double facing = std::min(ox * gx + oy * gy + mu * gz, 1.0), iz = 2 * facing * gz - mu;
            if (!(facing > 0 && iz > 0)) continue;
            const double s_i = slope_length(2 * facing * gx - ox, 2 * facing * gy - oy, iz);
            const double seen = is_beckmann ? 2 * facing / gz : mu + s_o;
            sum += weight * seen * iz / (s_o * iz + s_i * mu);
        }
    }
    return 1 - sum;
}

/// The table of what is lost and that of its averages, all axes as in stretched_tables.h.
class StretchedTable {
public:
    static constexpr int kMuNodes = 24, kAzimuthNodes = 10, kWidthNodes = 12, kRatioNodes = 8;
    static constexpr int kAverageWidthNodes = 32, kAverageRatioNodes = 16;
    static constexpr double kWidthMin = 1e-3, kRatioMin = 0.02;

    Values lost, averages;

    explicit StretchedTable(bool is_beckmann) {
        // Nodes and the middles between them, where linear interpolation overshoots most.
        const auto fine_index = [](const Cell& i) {
            return ((size_t(i[0]) * kFine[1] + i[1]) * kFine[2] + i[2]) * kFine[3] + i[3];
        };
        Values values(fine_index({kFine[0], 0, 0, 0}));
        tbb::parallel_for(0, kFine[0] * kFine[1], [&](int row) {
            const double ratio = std::max(kRatioMin, double(row / kFine[1]) / (kFine[0] - 1));
            const double x = std::lerp(kWidthMin, 1.0, double(row % kFine[1]) / (kFine[1] - 1)), y = x * ratio * ratio;
            for (int j = 0; j < kFine[2]; ++j) {
                const double phi = azimuth_at(double(j) / (kFine[2] - 1), ratio);
                const double alpha = std::hypot(x * std::cos(phi), y * std::sin(phi));
                for (int k = 0; k < kFine[3]; ++k) {
                    values[fine_index({row / kFine[1], row % kFine[1], j, k})] =
                        lost_by_stretched(is_beckmann, x, y, mu_at(double(k) / (kFine[3] - 1), alpha), phi);
                }
            }
        });
        lost.resize(size_t(kRatioNodes) * kWidthNodes * kAzimuthNodes * kMuNodes);
        for_each({kRatioNodes, kWidthNodes, kAzimuthNodes, kMuNodes}, [&](const Cell& i) {
            lost[index(i)] = values[fine_index({2 * i[0], 2 * i[1], 2 * i[2], 2 * i[3]})];
        });
        for (int pass = 0; pass < 6; ++pass) lower(values, fine_index);
        for (double& v : lost) v = std::nearbyint(std::clamp(v, 0.0, 1.0) * 65535);
        add_averages();
    }

    /// Interpolates for a view `w` and widths x >= y, as stretched_tables.h does.
    double at(double x, double y, const std::array<double, 3>& w) const {
        const double x2 = w[0] * w[0], y2 = w[1] * w[1], mu = w[2], sine2 = x2 + y2;
        const double alpha = sine2 > 0 ? std::sqrt((x * x * x2 + y * y * y2) / sine2) : x;
        const double a = std::sqrt(x * x2), b = std::sqrt(y * y2);
        Place m = place(std::sqrt(mu) / (std::sqrt(mu) + std::sqrt(alpha * (1 - mu))), kMuNodes);
        if (m.node == 0) m.fraction *= m.fraction;
        Place width = place((x - kWidthMin) / (1 - kWidthMin), kWidthNodes);
        if (width.node == 0) width.fraction *= width.fraction;
        const Place places[] = {place(std::sqrt(y / x), kRatioNodes), width,
                                place(a + b > 0 ? b / (a + b) : 0, kAzimuthNodes), m};
        double value = 0;
        for (int corner = 0; corner < 16; ++corner) {
            double weight = 1;
            Cell node;
            for (int axis = 0; axis < 4; ++axis) {
                node[axis] = places[axis].node + (corner >> axis & 1);
                weight *= (corner >> axis & 1) ? places[axis].fraction : 1 - places[axis].fraction;
            }
            value += weight * lost[index(node)];
        }
        return value / 65535;
    }

private:
    static constexpr std::array<int, 4> kFine = {2 * kRatioNodes - 1, 2 * kWidthNodes - 1, 2 * kAzimuthNodes - 1,
                                                 2 * kMuNodes - 1};
    using Cell = std::array<int, 4>; // It counts ratio, width, azimuth and cosine.
    static size_t index(const Cell& i) {
        return ((size_t(i[0]) * kWidthNodes + i[1]) * kAzimuthNodes + i[2]) * kMuNodes + i[3];
    }
    static double azimuth_at(double p, double ratio) { return p < 1 ? std::atan(p / ((1 - p) * ratio)) : pi / 2; }
    static double mu_at(double x, double alpha) {
        const double p = x * (kMuNodes - 1);
        x = (p < 1 ? std::sqrt(p) : p) / (kMuNodes - 1); // in the first cell the curves are linear in mu
        return std::max(alpha * x * x / ((1 - x) * (1 - x) + alpha * x * x), 1e-7);
    }
    template <class Visit>
    static void for_each(const Cell& counts, const Visit& visit) {
        for (int a = 0; a < counts[0]; ++a)
            for (int b = 0; b < counts[1]; ++b)
                for (int c = 0; c < counts[2]; ++c)
                    for (int d = 0; d < counts[3]; ++d) visit(Cell{a, b, c, d});
    }
    /// Lowers the nodes about each cell by part of what interpolation overshoots in it.
    template <class Index>
    void lower(const Values& values, const Index& fine_index) {
        constexpr double kOvershoot = 3e-4;
        Values drop(lost.size());
        for_each({kRatioNodes - 1, kWidthNodes - 1, kAzimuthNodes - 1, kMuNodes - 1}, [&](const Cell& i) {
            for_each({3, 3, 3, 3}, [&](const Cell& at) {
                double excess =
                    -values[fine_index({2 * i[0] + at[0], 2 * i[1] + at[1], 2 * i[2] + at[2], 2 * i[3] + at[3]})];
                std::array<double, 16> weights;
                for (int corner = 0; corner < 16; ++corner) {
                    weights[corner] = 1;
                    for (int axis = 0; axis < 4; ++axis) {
                        const double fraction = at[axis] / 2.0; // The first cell of widths has its square.
                        weights[corner] *= std::abs(1 - (corner >> axis & 1) -
                                                    (axis == 1 && i[1] == 0 ? fraction * fraction : fraction));
                    }
                    if (weights[corner] > 0) excess += weights[corner] * lost[index(node_of(i, corner))];
                }
                if (!(excess > kOvershoot)) return;
                for (int corner = 0; corner < 16; ++corner) {
                    double& most = drop[index(node_of(i, corner))];
                    if (weights[corner] > 0) most = std::max(most, 0.6 * (excess - kOvershoot));
                }
            });
        });
        for (size_t i = 0; i < lost.size(); ++i) lost[i] = std::max(lost[i] - drop[i], 0.0);
    }
    static Cell node_of(const Cell& i, int corner) {
        return {i[0] + (corner & 1), i[1] + (corner >> 1 & 1), i[2] + (corner >> 2 & 1), i[3] + (corner >> 3 & 1)};
    }
    struct Place {
        int node;
        double fraction;
    };
    static Place place(double x, int nodes) {
        const int node = std::min(int(x * (nodes - 1)), nodes - 2);
        return {node, x * (nodes - 1) - node};
    }
    /// Averages of the interpolated table over all directions, by the cosine, over the wider width.
    void add_averages() {
        static const std::vector<Node> roots = gauss_legendre(160);
        averages.resize(size_t(kAverageRatioNodes) * kAverageWidthNodes);
        tbb::parallel_for(0, kAverageRatioNodes * kAverageWidthNodes, [&](int at) {
            constexpr int kPlaces = 72;
            const double ratio = std::max(kRatioMin, double(at / kAverageWidthNodes) / (kAverageRatioNodes - 1));
            const double root =
                std::lerp(std::sqrt(kWidthMin), 1.0, double(at % kAverageWidthNodes) / (kAverageWidthNodes - 1));
            const double x = root * root, y = x * ratio * ratio;
            const Place r = place(ratio, kRatioNodes);
            Place w = place((x - kWidthMin) / (1 - kWidthMin), kWidthNodes);
            if (w.node == 0) w.fraction *= w.fraction;
            double sum = 0;
            for (int j = 0; j < kPlaces; ++j) {
                const double p = (j + 0.5) / kPlaces, phi = azimuth_at(p, ratio), q = p / (1 - p) / ratio;
                const double share = 2 / pi / kPlaces / (ratio * (1 - p) * (1 - p) * (1 + q * q)); // dphi
                const double alpha = std::hypot(x * std::cos(phi), y * std::sin(phi));
                const Place a = place(p, kAzimuthNodes);
                for (const Node& node : roots) { // mu = t^2: dmu = 2 t dt
                    const double mu = node.x * node.x;
                    Place m = place(node.x / (node.x + std::sqrt(alpha * (1 - mu))), kMuNodes);
                    if (m.node == 0) m.fraction *= m.fraction;
                    double value = 0;
                    for (int corner = 0; corner < 16; ++corner) {
                        const auto part = [&](const Place& of, int bit) {
                            return (corner >> bit & 1) ? of.fraction : 1 - of.fraction;
                        };
                        value += part(r, 0) * part(w, 1) * part(a, 2) * part(m, 3) *
                                 lost[index(node_of({r.node, w.node, a.node, m.node}, corner))];
                    }
                    sum += share * 4 * node.x * mu * node.weight * value / 65535;
                }
            }
            averages[at] = sum / x;
        });
    }
};

} // namespace
