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

/// a erf(a) + exp(-a^2) / sqrt(pi), whose derivative is erf(a), by cubics of both; off by at most 1e-13.
class SlopeLengths {
public:
    SlopeLengths() {
        for (size_t i = 0; i < nodes_.size(); ++i) {
            const double a = double(i) / kPerUnit;
            nodes_[i] = {a * std::erf(a) + std::exp(-a * a) / std::sqrt(pi), std::erf(a) / kPerUnit};
        }
    }
    double at(double a) const {
        const double place = a * kPerUnit;
        if (!(place < kMost * kPerUnit)) return a; // nothing is masked
        const int i = int(place);
        const double t = place - i, u = 1 - t;
        const Ends &p = nodes_[i], &q = nodes_[i + 1];
        return u * u * ((1 + 2 * t) * p.value + t * p.slope) + t * t * ((1 + 2 * u) * q.value - u * q.slope);
    }

private:
    static constexpr int kPerUnit = 512, kMost = 6;
    struct Ends {
        double value, slope;
    };
    std::array<Ends, kPerUnit * kMost + 1> nodes_;
};

const SlopeLengths slope_lengths;

/// z (1 + 2 Lambda) of Beckmann's microfacets.
double beckmann_slope_length(double z, double alpha) {
    const double across = std::max(alpha * std::sqrt(std::max(0.0, 1 - z * z)), 1e-12);
    return across * slope_lengths.at(z / across);
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
    Values lost(etas.size(), 1.0), passed(etas.size()), of(passed), down(passed), sines(passed), slopes(passed),
        inverse, inverse2;
    for (const double eta : etas) {
        inverse.push_back(1 / eta);
        inverse2.push_back(1 / (eta * eta));
    }
    for (const Node& node : lengths) {
        const double u = node.x * node.x * (3 - 2 * node.x), r = alpha * std::sqrt(-std::log1p(-u));
        const double weight = node.weight * 6 * node.x * (1 - node.x), z = 1 / std::sqrt(1 + r * r);
        const double end = r * across > mu ? std::acos(-mu / (r * across)) : pi;
        for (const Node& angle : angles) {
            const double facing = std::min((across * r * std::cos(angle.x * end) + mu) * z, 1.0);
            if (!(facing > 0)) continue;
            const double part = weight * angle.weight * end / pi * facing / z;
            const auto masked = [&](double i, double slope_length) {
                return i > 0 ? 2 * i / (s_o * i + slope_length * mu) : 0;
            };
            const double up = 2 * facing * z - mu,
                         reflected = up > 0 ? masked(up, beckmann_slope_length(up, alpha)) : 0;
            for (size_t q = 0; q < etas.size(); ++q) { // side by side, for the vectoriser
                const double eta = etas[q], t2 = std::max(0.0, 1 - (1 - facing * facing) * inverse2[q]);
                const double t = std::sqrt(t2), s = facing + eta * t, p = eta * facing + t;
                passed[q] = 2 * eta * facing * t * (s * s + p * p); // Fresnel's transmittance, times of[q]
                of[q] = s * s * p * p;
                down[q] = std::min((mu - facing * z) * inverse[q] + t * z, 1.0);
                sines[q] = std::max(alpha * std::sqrt(1 - down[q] * down[q]), 1e-12);
                slopes[q] = down[q] / sines[q];
            }
            for (size_t q = 0; q < etas.size(); ++q) {
                if (down[q] > 0) {
                    const double length = s_o * down[q] + sines[q] * slope_lengths.at(slopes[q]) * mu;
                    lost[q] -= part * (reflected + passed[q] * (2 * down[q] - reflected * length) / (of[q] * length));
                } else {
                    lost[q] -= part * (1 - passed[q] / of[q]) * reflected;
                }
            }
        }
    }
    return lost;
}

} // namespace
