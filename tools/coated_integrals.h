#pragma once

// Integrates for make_lobe_tables.cpp how a coat on white metal returns to the metal what it reflects downwards, as
// src/shading/lobes/coated_table.h states.
//
// The function r of the cosine is to fulfil r(o) sum(k(o, i) r(i)) = l(o) for each pair of widths, where k is the light
// that the metal scatters from o and l what the coat loses of it. Factors that are raised where the left side is too
// small converge to it (Sinkhorn & Knopp 1967). Nodes are fitted to the places between them too, and lowered where
// light would be gained by more than kGain.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "beckmann_integrals.h"

namespace {

class CoatedTable {
public:
    static constexpr int kCoatNodes = 10, kMetalNodes = 12, kMuNodes = 28;

    Values returned; // by coat, metal and cosine

    /// `scattered(mu, alpha)` returns the light of white metal by cosine; `coat_albedo(roughness)` returns a function
    /// of the cosine that has the coat's albedo over 1 - f0.
    template <class Scattered, class CoatAlbedo>
    CoatedTable(const Scattered& scattered, const CoatAlbedo& coat_albedo)
        : returned(size_t(kCoatNodes) * kMetalNodes * kMuNodes, 0.1), kernels_(size_t(kMetals) * kMus),
          lost_(size_t(kCoats) * kMetals * kMus) {
        std::vector<Values> albedos(kCoats); // at even places of the root of the cosine
        tbb::parallel_for(0, kCoats, [&](int c) {
            const auto albedo = coat_albedo(roughness_at(double(c) / (kCoats - 1)));
            for (int i = 0; i <= kPlaces; ++i) albedos[c].push_back(albedo(std::pow(double(i) / kPlaces, 2)));
        });
        tbb::parallel_for(0, kMetals * kMus, [&](int row) {
            const double alpha = std::pow(roughness_at(double(row / kMus) / (kMetals - 1)), 2);
            const double mu = mu_at(double(row % kMus) / (kMus - 1), alpha);
            const std::vector<Node> light = scattered(mu, alpha);
            std::vector<std::pair<int, double>> places;
            for (const Node& node : light) {
                const auto [k, part] = place(x_at(node.x, alpha), kMuNodes);
                kernels_[row][k] += node.weight * (1 - part);
                kernels_[row][k + 1] += node.weight * part;
                places.push_back(place(std::sqrt(node.x), kPlaces + 1));
            }
            const auto albedo_at = [&](int c, const std::pair<int, double>& at) {
                return std::lerp(albedos[c][at.first], albedos[c][at.first + 1], at.second);
            };
            for (int c = 0; c < kCoats; ++c) {
                const double at_o = albedo_at(c, place(std::sqrt(mu), kPlaces + 1));
                double& lost = lost_[size_t(c) * kMetals * kMus + row];
                for (size_t i = 0; i < light.size(); ++i) {
                    lost += light[i].weight * std::max(albedo_at(c, places[i]) - at_o, 0.0);
                }
            }
        });
        for (int pass = 0; pass < 200; ++pass) fit();
        for (int pass = 0; pass < 400; ++pass) lower();
    }

private:
    static constexpr int kCoats = 2 * kCoatNodes - 1, kMetals = 2 * kMetalNodes - 1, kMus = 2 * kMuNodes - 1;
    static constexpr int kPlaces = 2048;
    static constexpr double kRootMin = 0.0316227766, kGain = 5e-4, kGainWeight = 10;

    std::vector<std::array<double, kMuNodes>> kernels_; // light by node, of metals and cosines
    Values lost_;                                       // by coat, metal and cosine

    static double roughness_at(double x) { return kRootMin + (1 - kRootMin) * x * x; }
    static double mu_at(double x, double alpha) {
        const double p = x * (kMuNodes - 1);
        x = (p < 1 ? std::sqrt(p) : p) / (kMuNodes - 1); // the first cell as in energy_tables.h
        const double t = alpha * x * x;
        return std::max(t / ((1 - x) * (1 - x) + t), 1e-7);
    }
    static double x_at(double mu, double alpha) {
        const double p = std::sqrt(mu) / (std::sqrt(mu) + std::sqrt(alpha * (1 - mu))) * (kMuNodes - 1);
        return (p < 1 ? p * p : p) / (kMuNodes - 1);
    }
    static std::pair<int, double> place(double x, int nodes) {
        const int node = std::min(int(x * (nodes - 1)), nodes - 2);
        return {node, x * (nodes - 1) - node};
    }

    /// Calls `visit(nodes, weights, returned, lost)` for each place.
    template <class Visit>
    void for_each_place(const Visit& visit) const {
        for (int c = 0; c < kCoats; ++c)
            for (int b = 0; b < kMetals; ++b) {
                std::array<double, kMuNodes> row{};
                for (int j = 0; j < kMuNodes; ++j)
                    for (int corner = 0; corner < 4; ++corner) row[j] += 0.25 * returned[node(c, b, 2 * j, corner * 2)];
                for (int k = 0; k < kMus; ++k) {
                    const auto& kernel = kernels_[size_t(b) * kMus + k];
                    double sum = 0;
                    for (int j = 0; j < kMuNodes; ++j) sum += kernel[j] * row[j];
                    const double at_o = 0.5 * (row[k / 2] + row[(k + 1) / 2]);
                    visit(c, b, k, at_o * sum, lost_[(size_t(c) * kMetals + b) * kMus + k]);
                }
            }
    }
    /// Returns one of the eight nodes about a place, the same several times where the place is at nodes.
    static size_t node(int c, int b, int k, int corner) {
        return (size_t((c + (corner >> 2)) / 2) * kMetalNodes + (b + (corner >> 1 & 1)) / 2) * kMuNodes +
               (k + (corner & 1)) / 2;
    }
    void fit() {
        Values is(returned.size()), should(returned.size());
        for_each_place([&](int c, int b, int k, double light, double lost) {
            for (int corner = 0; corner < 8; ++corner) {
                const double weight = light > lost + kGain ? kGainWeight : 1;
                is[node(c, b, k, corner)] += weight * light;
                should[node(c, b, k, corner)] += weight * lost;
            }
        });
        for (size_t i = 0; i < returned.size(); ++i) {
            if (is[i] > 0) returned[i] *= std::sqrt(should[i] / is[i]);
        }
    }
    void lower() {
        Values least(returned.size(), 1);
        for_each_place([&](int c, int b, int k, double light, double lost) {
            if (!(light > lost + kGain)) return;
            for (int corner = 0; corner < 8; ++corner) {
                double& scale = least[node(c, b, k, corner)];
                scale = std::min(scale, std::pow((lost + kGain) / light, 0.1));
            }
        });
        for (size_t i = 0; i < returned.size(); ++i) returned[i] *= least[i];
    }
};

} // namespace
