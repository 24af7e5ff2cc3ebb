#pragma once

// Integrals over Beckmann's microfacets for make_lobe_tables.cpp, and the nodes of their rules. The facets are those of
// all slopes, by the slope's length and its angle to the view.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace {

using std::numbers::pi;
using Values = std::vector<double>;

struct Node {
    double x, weight;
};

/// Returns the nodes of Gauss and Legendre in [0, 1].
std::vector<Node> gauss_legendre(int count) {
    std::vector<Node> nodes;
    for (int i = count; i-- > 0;) {
        double z = std::cos(pi * (i + 0.75) / (count + 0.5)), slope = 1;
        for (int step = 0; step < 10; ++step) { // Newton's
            double p = 1, before = 0;
            for (int k = 0; k < count; ++k) {
                const double next = ((2 * k + 1) * z * p - k * before) / (k + 1);
                before = p;
                p = next;
            }
            slope = count * (z * p - before) / (z * z - 1);
            z -= p / slope;
        }
        nodes.push_back({(z + 1) / 2, 1 / ((1 - z * z) * slope * slope)});
    }
    return nodes;
}

/// z (1 + 2 Lambda) of Beckmann's microfacets.
double beckmann_slope_length(double z, double alpha) {
    const double across = alpha * std::sqrt(std::max(0.0, 1 - z * z)), a = z / std::max(across, 1e-12);
    return z * std::erf(a) + across * std::exp(-a * a) / std::sqrt(pi);
}

/// Light that one bounce off Beckmann's microfacets with F = 1 reflects, as it is and weighted by Schlick's (1 -
/// cos)^5: an integral over the normals, by the length of their slopes and the angle to the view, of those that reflect
/// it upwards.
std::array<double, 2> reflected_by_beckmann(double mu, double alpha) {
    static const std::vector<Node> lengths = gauss_legendre(160), angles = gauss_legendre(48);
    const double across = std::sqrt(std::max(0.0, 1 - mu * mu)), s_o = beckmann_slope_length(mu, alpha);
    std::array<double, 2> sums{};
    for (const Node& node : lengths) {
        const double u = node.x * node.x * (3 - 2 * node.x), r = alpha * std::sqrt(-std::log1p(-u));
        const double weight = node.weight * 6 * node.x * (1 - node.x), z = 1 / std::sqrt(1 + r * r);
        // Facets up to `least` face the view; those behind `below` reflect it into the surface.
        const double least = r * across > mu ? std::acos(-mu / (r * across)) : pi;
        const double below = (mu / z - 2 * mu * z) / (2 * z * r * across); // where the reflected cosine is 0
        const double end = std::min(least, below > -1 ? (below < 1 ? std::acos(below) : 0) : pi);
        for (const Node& angle : angles) {
            const double facing = (across * r * std::cos(angle.x * end) + mu) * z, reflected = 2 * facing * z - mu;
            if (!(facing > 0 && reflected > 0)) continue;
            const double masked = 2 * reflected / (s_o * reflected + beckmann_slope_length(reflected, alpha) * mu);
            const double part = weight * angle.weight * end / pi * masked * facing / z;
            sums[0] += part;
            sums[1] += part * std::pow(std::max(0.0, 1 - facing), 5);
        }
    }
    return sums;
}

/// Shares that Beckmann's microfacets of glass lose of the light from one side, of each index in `etas` (far over near
/// side).
Values lost_by_beckmann_glass(double mu, double alpha, const Values& etas) {
    static const std::vector<Node> lengths = gauss_legendre(96), angles = gauss_legendre(40);
    const double across = std::sqrt(std::max(0.0, 1 - mu * mu)), s_o = beckmann_slope_length(mu, alpha);
    Values lost(etas.size(), 1.0);
    for (const Node& node : lengths) {
        const double u = node.x * node.x * (3 - 2 * node.x), r = alpha * std::sqrt(-std::log1p(-u));
        const double weight = node.weight * 6 * node.x * (1 - node.x), z = 1 / std::sqrt(1 + r * r);
        const double end = r * across > mu ? std::acos(-mu / (r * across)) : pi;
        for (const Node& angle : angles) {
            const double facing = std::min((across * r * std::cos(angle.x * end) + mu) * z, 1.0);
            if (!(facing > 0)) continue;
            const double part = weight * angle.weight * end / pi * facing / z;
            const auto masked = [&](double i) {
                return i > 0 ? 2 * i / (s_o * i + beckmann_slope_length(i, alpha) * mu) : 0;
            };
            const double reflected = masked(2 * facing * z - mu);
            for (size_t q = 0; q < etas.size(); ++q) {
                const double eta = etas[q], t2 = 1 - (1 - facing * facing) / (eta * eta);
                const double t = std::sqrt(std::max(0.0, t2));
                const double rs = (facing - eta * t) / (facing + eta * t), rp = (eta * facing - t) / (eta * facing + t);
                const double f = t2 <= 0 ? 1.0 : 0.5 * (rs * rs + rp * rp);
                lost[q] -= part * (f * reflected + (f < 1 ? (1 - f) * masked(mu / eta - (facing / eta - t) * z) : 0));
            }
        }
    }
    return lost;
}

} // namespace
