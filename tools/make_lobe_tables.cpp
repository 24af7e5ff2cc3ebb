// Writes the tables of lobes into the folder that it is given: energy_table_data.h, which says how much energy GGX
// microfacets lose to single scattering, beckmann_table_data.h, the same of Beckmann's, stretched_table_data.h, of both
// if they are stretched (stretched_integrals.h), sheen_table_data.h, the directional albedo of the sheen lobe, and
// coated_table_data.h, what a coat returns to metal (coated_integrals.h). The numbers stand in *.inl, which only
// lobe_table_data.cpp and device code read.
//
// The build runs it. Axes and meaning are stated in src/shading/lobes/energy_tables.h, stretched_tables.h,
// coated_table.h and sheen_lobe.h, which must agree with this file. Doubles leave eight digits to spare, so the values
// do not depend on the compiler or on libm; other text than that of kHash is refused. tests/unit/lobe_tables_test.cpp
// holds the floats that a program reads of it.
//
// Each value is an integral by a product rule: Gauss-Legendre along one axis, and midpoints about the other, along
// which the integrand is even and periodic. Energy is integrated over the distribution of visible normals (Heitz 2018;
// Dupuy and Benyoub 2023 for the warp). The tables are interpolated linearly. Where the chord lies above the curve, a
// lookup would give energy away that was never lost, so nodes are lowered where the inside of a cell overshoots by more
// than kOvershoot.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "beckmann_integrals.h"
#include "coated_integrals.h"
#include "ggx_integrals.h"
#include "stretched_glass_integrals.h"
#include "stretched_integrals.h"

namespace {

constexpr int kMuNodes = 36, kRoughnessNodes = 20, kIorNodes = 14, kAverageNodes = 64;
constexpr int kBeckmannRoughnessNodes = 20, kBeckmannIorNodes = 14;
constexpr double kAlphaMin = 1e-3, kIorMin = 1.1, kIorMax = 3, kOvershoot = 2e-4;
constexpr int kSheenMuNodes = 24, kSheenRoughnessNodes = 16;
constexpr double kSheenRoughnessMin = 0.2;
constexpr uint64_t kHash = 0xb61edab7e2d290f0; // hash of the numbers of all tables

double mu_at(double x, double alpha) {
    const double p = x * (kMuNodes - 1);
    x = (p < 1 ? std::sqrt(p) : p) / (kMuNodes - 1); // in the first cell the curves are linear in mu
    const double t = alpha * x * x;
    return std::max(t / ((1 - x) * (1 - x) + t), 1e-7);
}

double x_at(double mu, double alpha) {
    const double p = std::sqrt(mu) / (std::sqrt(mu) + std::sqrt(alpha * (1 - mu))) * (kMuNodes - 1);
    return (p < 1 ? p * p : p) / (kMuNodes - 1);
}

double alpha_at(double r) {
    const double root = std::sqrt(kAlphaMin) + (1 - std::sqrt(kAlphaMin)) * r;
    return root * root;
}

double eta_at(double q) {
    const auto root = [](double eta) { return std::sqrt((eta - 1) / (eta + 1)); };
    const double k = root(kIorMin) + (root(kIorMax) - root(kIorMin)) * q;
    return (1 + k * k) / (1 - k * k);
}

/// A table over three axes, the first of which may have one node. Cells are looked at in places between the nodes too.
struct Grid {
    std::array<int, 3> nodes;
    int fine_mu = 4; // places a cell along the last axis, where curves bend most; 2 along the others

    int size(int axis) const { return (nodes[axis] - 1) * (axis == 2 ? fine_mu : 2) + 1; }
    double at(int axis, int place) const { return nodes[axis] == 1 ? 0 : double(place) / (size(axis) - 1); }
    size_t index(int q, int r, int x) const { return (size_t(q) * nodes[1] + r) * nodes[2] + x; }
    size_t fine_index(int q, int r, int x) const { return (size_t(q) * size(1) + r) * size(2) + x; }

    /// Makes a value of each place by `fill(row of places along the first axis, r, x)`.
    template <class Fill>
    Values tabulate(const Fill& fill) const {
        Values fine(fine_index(size(0), 0, 0));
        tbb::parallel_for(0, size(1) * size(2), [&](int i) {
            Values column(size(0));
            fill(column, at(1, i / size(2)), at(2, i % size(2)));
            for (int q = 0; q < size(0); ++q) fine[fine_index(q, i / size(2), i % size(2))] = column[q];
        });
        return fine;
    }

    /// Calls `visit` with the lower node of each cell.
    template <class Visit>
    void for_each_cell(const Visit& visit) const {
        for (int q = 0; q < std::max(nodes[0] - 1, 1); ++q)
            for (int r = 0; r < nodes[1] - 1; ++r)
                for (int x = 0; x < nodes[2] - 1; ++x) visit(q, r, x);
    }

    /// Returns the nodes, lowered where linear interpolation overshoots the values `fine` inside a cell.
    Values lowered(const Values& fine) const {
        Values table;
        for (int q = 0; q < nodes[0]; ++q)
            for (int r = 0; r < nodes[1]; ++r)
                for (int x = 0; x < nodes[2]; ++x) table.push_back(fine[fine_index(2 * q, 2 * r, fine_mu * x)]);
        for (int pass = 0; pass < 4; ++pass) { // a node that would fall below 0 leaves the rest to its neighbours
            Values drop(table.size());
            for_each_cell([&](int q, int r, int x) {
                const int q_end = nodes[0] == 1 ? 0 : 2;
                double excess = 0;
                for (int a = 0; a <= q_end; ++a)
                    for (int b = 0; b <= 2; ++b)
                        for (int c = 0; c <= fine_mu; ++c) {
                            const double at_mu = double(c) / fine_mu;
                            double error = -fine[fine_index(2 * q + a, 2 * r + b, fine_mu * x + c)];
                            for (int corner = 0; corner < 8; ++corner) {
                                const int i = corner >> 2, j = corner >> 1 & 1, k = corner & 1;
                                const double weight =
                                    std::abs(1 - i - a / 2.0) * std::abs(1 - j - b / 2.0) * std::abs(1 - k - at_mu);
                                if (weight > 0) error += weight * table[index(q + i, r + j, x + k)];
                            }
                            excess = std::max(excess, error - kOvershoot);
                        }
                for (int i = 0; i <= (q_end > 0); ++i)
                    for (const int j : {0, 1})
                        for (const int k : {0, 1}) {
                            double& most = drop[index(q + i, r + j, x + k)];
                            most = std::max(most, excess);
                        }
            });
            for (size_t i = 0; i < table.size(); ++i) table[i] = std::max(table[i] - drop[i], 0.0);
        }
        return table;
    }
};

/// Returns the table in units of 1 / 65535.
Values quantised(Values table) {
    for (double& v : table) v = std::nearbyint(std::clamp(v, 0.0, 1.0) * 65535);
    return table;
}

double interpolate(const double* row, int nodes, double position) {
    const int i = std::min(int(position * (nodes - 1)), nodes - 2);
    return std::lerp(row[i], row[i + 1], position * (nodes - 1) - i);
}

/// Returns the row along mu at roughness `r` of a quantised table.
Values row_at(const double* table, double r, int roughnesses = kRoughnessNodes) {
    Values row(kMuNodes);
    for (int x = 0; x < kMuNodes; ++x) {
        Values column(roughnesses);
        for (int i = 0; i < roughnesses; ++i) column[i] = table[i * kMuNodes + x] / 65535;
        row[x] = interpolate(column.data(), roughnesses, r);
    }
    return row;
}

double average_r(int i) { return std::pow(double(i) / (kAverageNodes - 1), 2); } // dense where averages change fastest

/// Returns 2 int of(mu, x) mu dmu.
template <class Function>
double average(double alpha, const Function& of) {
    static const std::vector<Node> nodes = gauss_legendre(400);
    double sum = 0;
    for (const Node& node : nodes) { // mu = x^2: dmu = 2 x dx
        const double mu = node.x * node.x;
        sum += 4 * node.x * mu * node.weight * of(mu, x_at(mu, alpha));
    }
    return sum;
}

/// Adds the averages of what is lost, over alpha, of a table of metal or one index.
void add_average_lost(const double* table, Values& averages, int roughnesses = kRoughnessNodes) {
    for (int i = 0; i < kAverageNodes; ++i) {
        const double alpha = alpha_at(average_r(i));
        const Values row = row_at(table, average_r(i), roughnesses);
        averages.push_back(average(alpha, [&](double, double x) { return interpolate(row.data(), kMuNodes, x); }) /
                           alpha);
    }
}

double sheen_albedo(double mu, double alpha) {
    static const std::vector<Node> heights = gauss_legendre(96);
    const double across_o = std::sqrt(1 - mu * mu);
    double sum = 0;
    for (const Node& node : heights)
        for (int j = 0; j < 96; ++j) {
            const double phi = (j + 0.5) / 96 * pi, h = node.x * node.x, across_i = std::sqrt(1 - h * h);
            const double x = across_o + across_i * std::cos(phi), y = across_i * std::sin(phi), z = mu + h;
            const double sine2 = (x * x + y * y) / (x * x + y * y + z * z);
            const double d = (2 + 1 / alpha) / (2 * pi) * std::pow(sine2, 0.5 / alpha);
            sum += 2 * node.x * node.weight * d * h / (4 * (mu + h - mu * h));
        }
    return sum * 2 * pi / 96;
}

struct Table {
    std::string type, name; // uint16_t or float
    Values values;

    std::string numbers() const {
        std::string text;
        for (const double v : values)
            text += type == "float" ? fmt::format("{:.9g}f,\n", double(float(v))) : fmt::format("{},\n", int(v));
        return text;
    }
    /// Host code reads one array of the program; a GPU has one in each kernel, since device code is not linked.
    std::string accessor() const {
        return fmt::format(
            "extern const {0} {1}_values[];\nHD inline {0} {1}_at(int i) {{\n"
            "#ifdef __CUDA_ARCH__\n    static constexpr {0} k[] = {{\n#include \"shading/lobes/{1}.inl\"\n    }};\n"
            "    return k[i];\n#else\n    return {1}_values[i];\n#endif\n}}\n",
            type, name);
    }
    std::string definition() const {
        return fmt::format("const {0} {1}_values[] = {{\n#include \"shading/lobes/{1}.inl\"\n}};\n", type, name);
    }
};

/// The tables of one namespace.
struct TableGroup {
    std::string space, constants;
    std::vector<Table> tables;
};

const char* const kOrigin = "// Written by tools/make_lobe_tables.cpp; src/shading/lobes/ says what it means.\n";

/// Throws std::runtime_error if it cannot.
void write(const std::string& path, const std::string& text) {
    std::ofstream file(path);
    file << text;
    file.close();
    if (!file) throw std::runtime_error(path + " could not be written");
}

/// FNV-1a.
uint64_t hash_of(const std::string& text) {
    uint64_t hash = 0xcbf29ce484222325;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    return hash;
}

TableGroup energy_tables() {
    const Grid metal{{1, kRoughnessNodes, kMuNodes}}, glass{{kIorNodes, kRoughnessNodes, kMuNodes}};
    const Values lost = quantised(metal.lowered(metal.tabulate([](Values& column, double r, double x) {
        column[0] = 1 - View(mu_at(x, alpha_at(r)), alpha_at(r)).reflected();
    })));
    // Schlick's weight of the half vector less that of mu itself: goes to 0 with alpha. Rather too much than too
    // little, since what the coat takes the base does not get.
    Values schlick = metal.lowered(metal.tabulate([](Values& column, double r, double x) {
        const View view(mu_at(x, alpha_at(r)), alpha_at(r));
        column[0] = 0.5 * (1 - (view.reflected_by_schlick() / view.reflected() - std::pow(1 - view.mu, 5)));
    }));
    for (double& v : schlick) v = 1 - v;
    schlick = quantised(schlick);

    Values average_lost, average_schlick;
    add_average_lost(lost.data(), average_lost);
    for (int i = 0; i < kAverageNodes; ++i) {
        const Values e = row_at(lost.data(), average_r(i)), b = row_at(schlick.data(), average_r(i));
        average_schlick.push_back(average(alpha_at(average_r(i)), [&](double mu, double x) {
            return (1 - interpolate(e.data(), kMuNodes, x)) *
                   (std::pow(1 - mu, 5) + 2 * interpolate(b.data(), kMuNodes, x) - 1);
        }));
    }

    Values glass_lost, average_glass;
    for (const bool inside : {false, true}) {
        const Values table = quantised(glass.lowered(glass.tabulate([&](Values& column, double r, double x) {
            const View view(mu_at(x, alpha_at(r)), alpha_at(r));
            for (int q = 0; q < glass.size(0); ++q) {
                const double eta = eta_at(glass.at(0, q));
                column[q] = 1 - view.scattered(inside ? 1 / eta : eta);
            }
        })));
        for (int q = 0; q < kIorNodes; ++q) add_average_lost(&table[glass.index(q, 0, 0)], average_glass);
        glass_lost.insert(glass_lost.end(), table.begin(), table.end());
    }
    return {
        "energy_table",
        fmt::format("inline constexpr int kMuNodes = {}, kRoughnessNodes = {}, kIorNodes = {}, kAverageNodes = {};\n"
                    "inline constexpr float kAlphaMin = {}f, kIorMin = {}f, kIorMax = {}.0f;\n",
                    kMuNodes, kRoughnessNodes, kIorNodes, kAverageNodes, kAlphaMin, kIorMin, kIorMax),
        {{"uint16_t", "metal_lost", lost},
         {"uint16_t", "metal_schlick", schlick},
         {"float", "metal_average_lost", average_lost},
         {"float", "metal_average_schlick", average_schlick},
         {"uint16_t", "glass_lost", glass_lost},
         {"float", "glass_average_lost", average_glass}}};
}

TableGroup beckmann_table() {
    const Grid grid{{1, kRoughnessNodes, kMuNodes}};
    const Values lost = quantised(grid.lowered(grid.tabulate([](Values& column, double r, double x) {
        column[0] = 1 - reflected_by_beckmann(mu_at(x, alpha_at(r)), alpha_at(r))[0];
    })));
    Values schlick = grid.lowered(grid.tabulate([](Values& column, double r, double x) { // Its form is that of GGX.
        const double mu = mu_at(x, alpha_at(r));
        const std::array<double, 2> reflected = reflected_by_beckmann(mu, alpha_at(r));
        column[0] = 0.5 * (1 - (reflected[1] / reflected[0] - std::pow(1 - mu, 5)));
    }));
    for (double& v : schlick) v = 1 - v;
    Values average_lost;
    add_average_lost(lost.data(), average_lost);
    const Grid glass{{kBeckmannIorNodes, kBeckmannRoughnessNodes, kMuNodes}, 2}; // an error function each: half as many
    Values glass_lost, average_glass;
    for (const bool inside : {false, true}) {
        Values etas;
        for (int q = 0; q < glass.size(0); ++q) {
            const double eta = eta_at(glass.at(0, q));
            etas.push_back(inside ? 1 / eta : eta);
        }
        const Values table = quantised(glass.lowered(glass.tabulate([&](Values& column, double r, double x) {
            column = lost_by_beckmann_glass(mu_at(x, alpha_at(r)), alpha_at(r), etas);
        })));
        for (int q = 0; q < kBeckmannIorNodes; ++q) {
            add_average_lost(&table[glass.index(q, 0, 0)], average_glass, kBeckmannRoughnessNodes);
        }
        glass_lost.insert(glass_lost.end(), table.begin(), table.end());
    }
    return {"beckmann_table",
            fmt::format("inline constexpr int kRoughnessNodes = {}, kIorNodes = {}; // nodes of the glass table\n",
                        kBeckmannRoughnessNodes, kBeckmannIorNodes),
            {{"uint16_t", "beckmann_lost", lost},
             {"uint16_t", "beckmann_schlick", quantised(schlick)},
             {"float", "beckmann_average_lost", average_lost},
             {"uint16_t", "beckmann_glass_lost", glass_lost},
             {"float", "beckmann_average_glass_lost", average_glass}}};
}

TableGroup sheen_table() {
    const Grid grid{{1, kSheenRoughnessNodes, kSheenMuNodes}};
    // Rather too much than too little, since what the sheen takes the lobes beneath do not get: turned over, so that
    // lowered() raises it.
    Values table = grid.lowered(grid.tabulate([](Values& column, double r, double x) {
        const double root = kSheenRoughnessMin + (1 - kSheenRoughnessMin) * r;
        column[0] = 4 - sheen_albedo(std::max(x * x, 1e-7), root * root);
    }));
    for (double& v : table) v = 4 - v;
    return {"sheen_table",
            fmt::format("inline constexpr int kMuNodes = {}, kRoughnessNodes = {};\n"
                        "inline constexpr float kRoughnessMin = {}f;\n",
                        kSheenMuNodes, kSheenRoughnessNodes, kSheenRoughnessMin),
            {{"float", "albedo", table}}};
}

/// Returns what stretched glass loses over what the even surface that loses as much as stretched metal does, on
/// average, loses, times the same of metal: stretched_tables.h has it too.
StretchedGlassTable stretched_glass(const TableGroup& energy, const StretchedTable& metal) {
    const Values &lost = energy.tables[0].values, &glass = energy.tables[4].values;
    const auto guess = [&](const StretchedGlassTable::View& view, double eta) {
        const double t = std::sqrt(view.y / view.x), mu = view.w[2];
        const double alpha = std::max(kAlphaMin, view.x * (0.67 + 0.33 * t * (0.3 + 0.7 * t)));
        const double r = (std::sqrt(alpha) - std::sqrt(kAlphaMin)) / (1 - std::sqrt(kAlphaMin)), x = x_at(mu, alpha);
        const double place = std::max(r, 0.0) * (kRoughnessNodes - 1);
        const int row = std::min(int(place), kRoughnessNodes - 2);
        const auto even = [&](const double* table) {
            const double* const at = table + row * kMuNodes;
            return std::lerp(interpolate(at, kMuNodes, x), interpolate(at + kMuNodes, kMuNodes, x), place - row) /
                   65535;
        };
        const double k = std::sqrt((std::max(eta, 1 / eta) - 1) / (std::max(eta, 1 / eta) + 1));
        const auto root = [](double ior) { return std::sqrt((ior - 1) / (ior + 1)); };
        const double q = std::clamp((k - root(kIorMin)) / (root(kIorMax) - root(kIorMin)), 0.0, 1.0) * (kIorNodes - 1);
        const int cell = std::min(int(q), kIorNodes - 2), first = (eta > 1 ? 0 : kIorNodes) + cell;
        constexpr int kStride = kRoughnessNodes * kMuNodes;
        const double of_glass =
            std::lerp(even(&glass[size_t(first) * kStride]), even(&glass[size_t(first + 1) * kStride]), q - cell);
        return of_glass * metal.at(view.x, view.y, view.w) / std::max(even(lost.data()), 1e-9);
    };
    return StretchedGlassTable(guess, eta_at);
}

TableGroup stretched_table(const TableGroup& energy) {
    using S = StretchedTable;
    using G = StretchedGlassTable;
    const S ggx(false), beckmann(true);
    const G glass = stretched_glass(energy, ggx);
    return {"stretched_table",
            fmt::format("inline constexpr int kMuNodes = {}, kAzimuthNodes = {}, kWidthNodes = {}, kRatioNodes = {},\n"
                        "kAverageWidthNodes = {}, kAverageRatioNodes = {};\ninline constexpr float kWidthMin = {}f;\n"
                        "inline constexpr int kGlassIorNodes = {}, kGlassWidthNodes = {}, kGlassRatioNodes = {},\n"
                        "kGlassAzimuthNodes = {}, kGlassMuNodes = {}, kGlassAverageIorNodes = {},\n"
                        "kGlassAverageWidthNodes = {}, kGlassAverageRatioNodes = {};\n"
                        "inline constexpr float kGlassUnit = {}f;\n",
                        S::kMuNodes, S::kAzimuthNodes, S::kWidthNodes, S::kRatioNodes, S::kAverageWidthNodes,
                        S::kAverageRatioNodes, S::kWidthMin, G::kIorNodes, G::kWidthNodes, G::kRatioNodes,
                        G::kAzimuthNodes, G::kMuNodes, G::kAverageIorNodes, G::kAverageWidthNodes,
                        G::kAverageRatioNodes, G::kUnit),
            {{"uint16_t", "stretched_lost", ggx.lost},
             {"float", "stretched_average_lost", ggx.averages},
             {"uint16_t", "stretched_beckmann_lost", beckmann.lost},
             {"float", "stretched_beckmann_average_lost", beckmann.averages},
             {"uint8_t", "stretched_glass_factor", glass.factors},
             {"uint16_t", "stretched_glass_average", glass.averages}}};
}

/// Returns what coats return to metals, from the tables of what metals lose.
TableGroup coated_table(const TableGroup& energy) {
    const Values &lost = energy.tables[0].values, &schlick = energy.tables[1].values,
                 &average = energy.tables[2].values;
    const auto r_of = [](double alpha) {
        return (std::sqrt(alpha) - std::sqrt(kAlphaMin)) / (1 - std::sqrt(kAlphaMin));
    };
    const auto average_lost = [&](double alpha) {
        return alpha * interpolate(average.data(), kAverageNodes, std::sqrt(std::max(r_of(alpha), 0.0)));
    };
    const auto scattered = [&](double mu, double alpha) {
        static const std::vector<Node> far = gauss_legendre(48);
        const View view(mu, alpha);
        const Values row = row_at(lost.data(), r_of(alpha));
        const auto lost_at = [&](double cosine) { return interpolate(row.data(), kMuNodes, x_at(cosine, alpha)); };
        const double more = lost_at(mu) / average_lost(alpha), once = (1 - lost_at(mu)) / view.reflected();
        std::vector<Node> light;
        for (int i = 0; i < kViewHeights; ++i)
            for (int j = 0; j < kViewAngles; ++j) {
                const View::Row& at = view.rows[i];
                const double cosine = 2 * at.cosine[j] * at.z[j] - mu;
                if (cosine > 0) light.push_back({std::min(cosine, 1.0), once * at.weight * at.reflected[j]});
            }
        for (const Node& node : far) {
            const double cosine = node.x * node.x;
            light.push_back({cosine, more * 4 * node.x * cosine * node.weight * lost_at(cosine)});
        }
        return light;
    };
    const auto coat_albedo = [&](double roughness) {
        constexpr double kF0 = 0.04;
        const double alpha = roughness * roughness;
        const bool is_rough = alpha >= kAlphaMin;
        Values lost_row, schlick_row;
        double average_of_coat = 0;
        if (is_rough) {
            lost_row = row_at(lost.data(), r_of(alpha));
            schlick_row = row_at(schlick.data(), r_of(alpha));
            average_of_coat = average_lost(alpha);
        }
        return [=](double cosine) {
            double e = 0, weight = std::pow(1 - cosine, 5);
            if (is_rough) {
                const double x = x_at(std::max(cosine, 1e-9), alpha);
                e = interpolate(lost_row.data(), kMuNodes, x);
                weight = std::max(weight + 2 * interpolate(schlick_row.data(), kMuNodes, x) - 1, 0.0);
            }
            const double f = kF0 + (1 - kF0) / 21;
            const double of_further = f * f * (1 - average_of_coat) / (1 - f * average_of_coat);
            return ((1 - e) * (kF0 + (1 - kF0) * weight) + e * of_further) / (1 - kF0);
        };
    };
    CoatedTable table(scattered, coat_albedo);
    return {"coated_table",
            fmt::format("inline constexpr int kCoatNodes = {}, kMetalNodes = {}, kMuNodes = {};\n",
                        CoatedTable::kCoatNodes, CoatedTable::kMetalNodes, CoatedTable::kMuNodes),
            {{"uint16_t", "returned_by_coat", quantised(std::move(table.returned))}}};
}

} // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        fmt::print(stderr, "make_lobe_tables FOLDER\n");
        return 2;
    }
    const std::string folder = std::string(arguments[1]) + "/";
    const TableGroup energy = energy_tables();
    const TableGroup groups[] = {energy, sheen_table(), beckmann_table(), stretched_table(energy),
                                 coated_table(energy)};
    std::string all_numbers, definitions = kOrigin;
    for (const TableGroup& group : groups) {
        for (const Table& table : group.tables) all_numbers += table.numbers();
    }
    // Pictures are to have the same bytes wherever they are made, so other tables would be a fault of this machine.
    if (const uint64_t hash = hash_of(all_numbers); hash != kHash) {
        fmt::print(stderr, "the tables of lobes have the hash {:#x} here; it should be {:#x}\n", hash, kHash);
        return 1;
    }
    try {
        for (const TableGroup& group : groups) {
            const std::string begin = "namespace pertev::" + group.space + " {\n";
            std::string header = "#pragma once\n" + std::string(kOrigin) +
                                 "#include <cstdint>\n#include \"base/host_device.h\"\n" + begin + group.constants;
            definitions += "#include \"shading/lobes/" + group.space + "_data.h\"\n" + begin;
            for (const Table& table : group.tables) {
                header += table.accessor();
                definitions += table.definition();
                write(folder + table.name + ".inl", table.numbers());
            }
            write(folder + group.space + "_data.h", header + "}\n");
            definitions += "}\n";
        }
        write(folder + "lobe_table_data.cpp", definitions);
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}
