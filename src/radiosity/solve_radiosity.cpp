#include "radiosity/solve_radiosity.h"

#include <atomic>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "radiosity/corner_light.h"
#include "radiosity/hierarchical.h"
#include "radiosity/radiosity_system.h"
#include "radiosity/row_maker.h"

namespace pertev {
namespace {

constexpr uint64_t kRowsAtOnce = 4096; // between two looks at whether to go on
constexpr uint64_t kRowsOfThread = 8;  // at least, one after the other

[[noreturn]] void interrupt() { throw Error(ErrorCode::Interrupted, "interrupted"); }

/// Makes rows [first, first + count), each given to take(k, row), from any thread.
template <class PatchOf, class Take>
void make_rows(const RowMakers& makers, uint64_t count, const PatchOf& patch_of, const Take& take) {
    parallel_for_ranges(count, kRowsOfThread, [&](uint64_t begin, uint64_t end) {
        const std::unique_ptr<RowMaker> maker = makers.for_thread();
        FormFactorRow row;
        for (uint64_t k = begin; k < end; ++k) {
            const auto [patch, number] = patch_of(k);
            maker->make(*patch, number, row);
            take(k, row);
        }
    });
}

struct NumberedPatch {
    const Patch* patch;
    uint32_t number;
};

RadiositySystem make_system(const SolvedScene& scene, const PatchTree& sources, const RadiositySettings& settings,
                            const SolveProgress& progress) {
    RadiositySystem system;
    for (const Patch& patch : sources.patches) {
        system.patches.push_back({patch.area, patch.reflectance, patch.exitance});
    }
    const RowMakers makers(scene, sources, settings);
    const uint64_t all = sources.patches.size();
    system.rows.resize(all);
    system.direct.resize(all);
    for (uint64_t first = 0; first < all; first += kRowsAtOnce) {
        const uint64_t count = std::min(kRowsAtOnce, all - first);
        make_rows(
            makers, count,
            [&](uint64_t k) {
                return NumberedPatch{&sources.patches[first + k], static_cast<uint32_t>(first + k)};
            },
            [&](uint64_t k, const FormFactorRow& row) {
                system.rows[first + k] = row.factors;
                system.direct[first + k] = row.direct;
            });
        const double share = static_cast<double>(first + count) / static_cast<double>(all);
        if (progress && !progress("form factors", share)) interrupt();
    }
    return system;
}

SolvedSystem solve(const RadiositySystem& system, const RadiositySettings& settings, const KeepSolving& keep_going) {
    const auto tolerance = static_cast<double>(settings.tolerance);
    switch (settings.solver) {
    case RadiositySolver::Southwell:
        return solve_by_southwell(system, tolerance, settings.steps, keep_going);
    case RadiositySolver::GaussSeidel:
        return solve_by_gauss_seidel(system, tolerance, keep_going);
    case RadiositySolver::Matrix:
    case RadiositySolver::Hierarchical: // has no rows
        break;
    }
    return solve_by_matrix(system, keep_going);
}

Rgb gathered(const FormFactorRow& row, const std::vector<Rgb>& radiosity) {
    double r = 0, g = 0, b = 0;
    for (const FormFactor& from : row.factors) {
        const auto factor = static_cast<double>(from.factor);
        const Rgb sent = radiosity[from.patch];
        r += factor * static_cast<double>(sent.r);
        g += factor * static_cast<double>(sent.g);
        b += factor * static_cast<double>(sent.b);
    }
    return row.direct + Rgb{static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)};
}

/// Whether light changes over a patch by more than the share `contrast`.
bool changes(const PatchLight& light, float contrast) {
    float least = kInfinity, most = 0;
    for (const Rgb& corner : light.corner) {
        const float value = luminance(corner);
        least = min(least, value), most = max(most, value);
    }
    return most - least > contrast * luminance(light.mean) && most > least;
}

/// Divides patches where light changes over them, and has the parts gather from `sources`.
class Divider {
public:
    Divider(const SolvedScene& scene, const PatchTree& sources, const RadiositySettings& settings,
            const std::vector<Rgb>& radiosity, float size)
        : scene_(scene), makers_(scene, sources, settings), settings_(settings), radiosity_(radiosity), size_(size) {}

    bool was_interrupted() const { return was_interrupted_; }

    /// True while there may be more to divide.
    bool divide(PatchTree& tree, std::vector<Rgb>& irradiance, uint32_t level, const SolveProgress& progress) {
        const std::vector<PatchLight> lights = light_corners(scene_.view(), tree, irradiance, size_);
        std::vector<uint32_t> parts; // whose light is to be found
        const auto before = static_cast<uint32_t>(tree.patches.size());
        for (uint32_t i = 0; i < before; ++i) {
            if (is_black(tree.patches[i].reflectance) || !changes(lights[i], settings_.contrast)) continue;
            if (tree.patches.size() + 3 > kMostPatches) break;
            parts.push_back(i);
            for (uint32_t k = 0; k < 3; ++k) parts.push_back(static_cast<uint32_t>(tree.patches.size()) + k);
            tree.split(scene_.view(), i);
            irradiance.insert(irradiance.end(), 3, irradiance[i]); // until they have gathered
        }
        for (std::size_t first = 0; first < parts.size(); first += kRowsAtOnce) {
            const std::size_t count = std::min<std::size_t>(kRowsAtOnce, parts.size() - first);
            make_rows(
                makers_, count,
                [&](uint64_t k) {
                    const uint32_t part = parts[first + k];
                    return NumberedPatch{&tree.patches[part], hash_words(part, level, 0x70617274u).x};
                },
                [&](uint64_t k, const FormFactorRow& row) {
                    irradiance[parts[first + k]] = gathered(row, radiosity_);
                });
            const double share = static_cast<double>(first + count) / static_cast<double>(parts.size());
            if (progress && !progress("dividing patches", (level - 1 + share) / settings_.subdivisions)) {
                was_interrupted_ = true;
                return false;
            }
        }
        return !parts.empty();
    }

private:
    const SolvedScene& scene_;
    RowMakers makers_;
    const RadiositySettings& settings_;
    const std::vector<Rgb>& radiosity_;
    float size_;
    bool was_interrupted_ = false;
};

float longest_side(const Bounds3& bounds) { return bounds.is_empty() ? 0.0f : max_component(bounds.size()); }

} // namespace

float patch_size_of(const PreparedScene& prepared, const RadiositySettings& settings) {
    if (settings.patch_size > 0) return settings.patch_size;
    return kPatchOfScene * longest_side(prepared.structures->bounds());
}

std::size_t predicted_bytes(uint64_t patches, const RadiositySettings& settings) {
    if (settings.solver == RadiositySolver::Hierarchical) return most_hierarchical_bytes(patches);
    const uint64_t all_rays = settings.form_factors == FormFactors::Rays
                                  ? settings.rays + settings.rays / 4
                                  : 3 * uint64_t(settings.hemicube) * settings.hemicube;
    const uint64_t entries = patches * std::min(all_rays, patches);
    std::size_t bytes = entries * sizeof(FormFactor) + patches * (2 * sizeof(Patch) + sizeof(SystemPatch) + 64);
    if (settings.solver == RadiositySolver::Southwell) bytes += entries * sizeof(FormFactor);
    if (settings.solver == RadiositySolver::Matrix) bytes += patches * patches * sizeof(double);
    return bytes;
}

uint64_t predicted_patches(const PreparedScene& prepared, const RadiositySettings& settings) {
    const SolvedScene scene(prepared);
    return count_patches(scene.view(), patch_size_of(prepared, settings));
}

namespace {

/// Patches with their light, before they are divided where it changes.
struct SolvedPatches {
    PatchTree tree;
    std::vector<Rgb> irradiance;
    Rgb ambient;
};

SolvedPatches solve_rows(const SolvedScene& scene, float patch_size, const RadiositySettings& settings,
                         const SolveProgress& progress, SolveStats& stats) {
    SolvedPatches solved;
    solved.tree = make_patches(scene.view(), patch_size);
    if (settings.solver == RadiositySolver::Matrix)
        check_matrix_size(solved.tree.patches.size()); // before hours of rows
    const Stopwatch watch;
    const RadiositySystem system = make_system(scene, solved.tree, settings, progress);
    stats.factors = system.factor_count();
    stats.bytes = system.bytes();
    stats.factor_seconds = watch.seconds();
    SolvedSystem solution = solve(system, settings, [&](double left) {
        stats.was_interrupted = progress && !progress("solving", std::min(1.0, 1 - left));
        return !stats.was_interrupted;
    });
    stats.steps = solution.steps;
    stats.left = solution.left;
    stats.solve_seconds = watch.seconds() - stats.factor_seconds;
    solved.irradiance = std::move(solution.irradiance);
    solved.ambient = solution.ambient;
    return solved;
}

SolvedPatches solve_links(const SolvedScene& scene, float patch_size, const RadiositySettings& settings,
                          const SolveProgress& progress, SolveStats& stats) {
    const Stopwatch watch;
    HierarchicalSolution solution = solve_hierarchically(
        scene, make_patches(scene.view(), kInfinity), patch_size, settings, [&](uint32_t pass, double share) {
            const std::string what = fmt::format("links, pass {}", pass + 1);
            return !progress || progress(what.c_str(), share);
        });
    stats.was_interrupted = solution.was_interrupted;
    stats.factors = solution.links;
    stats.steps = solution.passes;
    stats.left = solution.left;
    stats.bytes = solution.bytes;
    stats.solve_seconds = watch.seconds();
    return {std::move(solution.tree), std::move(solution.irradiance), {}};
}

std::vector<Rgb> radiosities(const SolvedPatches& solved) {
    std::vector<Rgb> radiosity;
    for (std::size_t i = 0; i < solved.irradiance.size(); ++i) {
        const Patch& patch = solved.tree.patches[i];
        radiosity.push_back(patch.exitance + patch.reflectance * solved.irradiance[i]);
    }
    return radiosity;
}

} // namespace

SolvedRadiosity solve_radiosity(const PreparedScene& prepared, const RadiositySettings& settings,
                                const SolveProgress& progress) {
    const SolvedScene scene(prepared);
    const float patch_size = patch_size_of(prepared, settings);
    SolvedRadiosity solved;
    SolveStats& stats = solved.stats;
    SolvedPatches shown = settings.solver == RadiositySolver::Hierarchical
                              ? solve_links(scene, patch_size, settings, progress, stats)
                              : solve_rows(scene, patch_size, settings, progress, stats);
    stats.patches = shown.tree.patches.size();
    const Stopwatch watch;
    const PatchTree sources = shown.tree;
    const std::vector<Rgb> radiosity = radiosities(shown);
    const float size = longest_side(scene.bounds());
    Divider divider(scene, sources, settings, radiosity, size);
    for (uint32_t level = 1; level <= settings.subdivisions && !stats.was_interrupted; ++level) {
        if (!divider.divide(shown.tree, shown.irradiance, level, progress)) break;
    }
    stats.was_interrupted = stats.was_interrupted || divider.was_interrupted();
    RadiositySolution& solution = solved.solution;
    solution.geometry = geometry_hash(*prepared.scene);
    solution.made = json_of(settings);
    solution.patches = light_corners(scene.view(), shown.tree, shown.irradiance, size);
    solution.roots = std::move(shown.tree.roots);
    solution.quads = std::move(shown.tree.quads);
    solution.ambient = shown.ambient;
    stats.shown = solution.patches.size();
    stats.divide_seconds = watch.seconds();
    return solved;
}

std::string json_of(const RadiositySettings& s) {
    return fmt::format(
        R"({{"patch_size":{},"subdivisions":{},"contrast":{},"form_factors":"{}","rays":{},"hemicube":{},"solver":"{}","tolerance":{},"steps":{},"link_error":{},"seed":{}}})",
        s.patch_size, s.subdivisions, s.contrast, name_of(s.form_factors), s.rays, s.hemicube, name_of(s.solver),
        s.tolerance, s.steps, s.link_error, s.seed);
}

} // namespace pertev
