#pragma once

// Integrals over GGX's microfacets for make_lobe_tables.cpp, by the visible normals of a view (Heitz 2018; Dupuy and
// Benyoub 2023 for the warp).

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "beckmann_integrals.h"

namespace {

constexpr int kViewHeights = 96, kViewAngles = 48; // sizes of the rule over the cap of visible normals

struct Angles {
    std::array<double, kViewAngles> cosine, sine;
    Angles() {
        for (int j = 0; j < kViewAngles; ++j) {
            cosine[j] = std::cos((j + 0.5) / kViewAngles * pi);
            sine[j] = std::sin((j + 0.5) / kViewAngles * pi);
        }
    }
};

double smith_lambda(double z, double alpha) {
    const double z2 = std::max(z * z, 1e-24);
    return 0.5 * (std::sqrt(1 + alpha * alpha * std::max(0.0, 1 - z2) / z2) - 1);
}

/// The visible normals of one view, by height and angle, which all indices of refraction share.
struct View {
    struct Row {
        std::array<double, kViewAngles> z, cosine,
            reflected; // about the normal; between normal and view; masking of reflection
        double weight;
    };
    double mu, alpha, lambda;
    std::array<Row, kViewHeights> rows;

    View(double mu_of_view, double alpha_of_view)
        : mu(mu_of_view), alpha(alpha_of_view), lambda(smith_lambda(mu, alpha)) {
        static const std::vector<Node> heights = gauss_legendre(kViewHeights);
        static const Angles angles;
        const double across = std::sqrt(std::max(0.0, 1 - mu * mu)), length = std::hypot(across * alpha, mu);
        const double wx = across * alpha / length, wz = mu / length;
        for (int i = 0; i < kViewHeights; ++i) {
            const double h = heights[i].x, t = h * h * (3 - 2 * h) * (1 + wz); // nodes gather at both ends of the cap
            const double s = std::sqrt(t * (2 - t));
            rows[i].weight = heights[i].weight * 6 * h * (1 - h) / kViewAngles;
            for (int j = 0; j < kViewAngles; ++j) {
                const double x = alpha * (s * angles.cosine[j] + wx), y = alpha * s * angles.sine[j], z = 1 - t + wz;
                const double norm = std::sqrt(x * x + y * y + z * z);
                rows[i].z[j] = z / norm;
                rows[i].cosine[j] = std::clamp((across * x + mu * z) / norm, 0.0, 1.0);
                rows[i].reflected[j] = masking(2 * rows[i].cosine[j] * rows[i].z[j] - mu);
            }
        }
    }

    double masking(double z) const {
        const double length = std::sqrt(z * z + alpha * alpha * std::max(0.0, 1 - z * z)); // z (1 + 2 Lambda)
        return z > 0 ? (2 + 2 * lambda) * z / ((1 + 2 * lambda) * z + length) : 0;
    }

    /// Returns the integral of `of(cosine, z, masking of reflection)` over the visible normals.
    template <class Function>
    double integrate(const Function& of) const {
        std::array<double, kViewAngles> sums{}; // side by side, for the vectoriser
        for (const Row& row : rows)
            for (int j = 0; j < kViewAngles; ++j) sums[j] += row.weight * of(row.cosine[j], row.z[j], row.reflected[j]);
        double sum = 0;
        for (const double s : sums) sum += s;
        return sum;
    }

    /// The energy of one bounce off a reflector with F = 1.
    double reflected() const {
        return integrate([](double, double, double masked) { return masked; });
    }
    /// Reflected light weighted by Schlick's (1 - cos)^5.
    double reflected_by_schlick() const {
        return integrate([](double c, double, double masked) { return masked * std::pow(1 - c, 5); });
    }
    /// The energy of reflection and refraction; `eta` is the far side's index over the near side's.
    double scattered(double eta) const {
        const double inverse = 1 / eta, inverse2 = inverse * inverse, both = 1 + 2 * lambda, most = 2 + 2 * lambda;
        return integrate([&](double c, double z, double masked) {
            const double t = std::sqrt(std::max(0.0, 1 - (1 - c * c) * inverse2));
            const double s = c + eta * t, p = eta * c + t, sp = s * p;
            const double passed = 2 * eta * c * t * (s * s + p * p),
                         of = sp * sp; // Fresnel's transmittance is passed / of
            const double down = std::max(0.0, t * z - (c * z - mu) * inverse);
            const double length = both * down + std::sqrt(down * down + alpha * alpha * std::max(0.0, 1 - down * down));
            return masked +
                   passed * (most * down - masked * length) / (of * length); // with masking(down), in one division
        });
    }
};

} // namespace
