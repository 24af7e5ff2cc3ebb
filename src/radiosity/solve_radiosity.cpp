#include "radiosity/solve_radiosity.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "math/portable_math.h"
#include "radiosity/corner_light.h"
#include "radiosity/hierarchical.h"
#include "radiosity/radiosity_system.h"
#include "radiosity/row_maker.h"

namespace pertev {
namespace {

constexpr uint64_t kRowsOfThread = 4; // minimum number per thread, one after the other

[[noreturn]] void interrupt() {
    throw Error(
        ErrorCode::Interrupted,
        "interrupted while form factors were computed; nothing is written, because solving begins after all of them");
}

/// Makes `count` rows and calls take(k, row) for each, from any thread. Returns false if the watch was over before all
/// were made.
template <class PatchOf, class Take>
bool make_rows(const RowMakers& makers, WorkWatch& watch, uint64_t count, const PatchOf& patch_of, const Take& take) {
    parallel_for_ranges(count, kRowsOfThread, [&](uint64_t begin, uint64_t end) {
        const std::unique_ptr<RowMaker> maker = makers.for_thread();
        FormFactorRow row;
        for (uint64_t k = begin; k < end; ++k) {
            const auto [patch, number] = patch_of(k);
            maker->make(*patch, number, row);
            if (watch.is_over()) return; // it may be incomplete
            take(k, row);
            watch.done();
        }
    });
    return !watch.is_over();
}

struct NumberedPatch {
    const Patch* patch;
    uint32_t number;
};

RadiositySystem make_system(const SolvedScene& scene, const PatchTree& sources, const RadiositySettings& settings,
                            WorkWatch& watch) {
    RadiositySystem system;
    const uint64_t all = sources.patches.size();
    system.patches.reserve(all);
    for (const Patch& patch : sources.patches) {
        system.patches.push_back({patch.area, patch.reflectance, patch.exitance});
    }
    const RowMakers makers(scene, sources, settings, &watch);
    system.rows.resize(all);
    system.direct.resize(all);
    watch.begin("form factors", all);
    const bool is_whole = make_rows(
        makers, watch, all,
        [&](uint64_t k) {
            return NumberedPatch{&sources.patches[k], static_cast<uint32_t>(k)};
        },
        [&](uint64_t k, const FormFactorRow& row) {
            system.rows[k] = row.factors;
            system.direct[k] = row.direct;
        });
    if (!is_whole) interrupt();
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

/// Returns whether light changes over a patch by more than the share `contrast` of all that it shows.
bool changes(const PatchLight& light, Rgb ambient, float contrast) {
    float least = kInfinity, most = 0;
    for (const Rgb& corner : light.corner) {
        const float value = luminance(corner);
        least = min(least, value), most = max(most, value);
    }
    return most - least > contrast * luminance(light.mean + ambient) && most > least;
}

/// Divides patches where light changes over them, and gathers the light of the parts from `sources`.
class Divider {
public:
    /// Takes the light `sent` by the sources so far, W/m2.
    Divider(const SolvedScene& scene, const PatchTree& sources, const RadiositySettings& settings,
            const std::vector<Rgb>& sent, Rgb ambient, WorkWatch& watch)
        : scene_(scene), makers_(scene, sources, settings, &watch), settings_(settings), sent_(sent), ambient_(ambient),
          watch_(watch) {}

    /// Divides patches once. Returns true while there may be more to divide.
    bool divide(PatchTree& tree, std::vector<Rgb>& irradiance, uint32_t level) {
        const auto share = [&](uint32_t levels) { return static_cast<double>(levels) / settings_.subdivisions; };
        watch_.begin("dividing patches", 0, share(level - 1), share(level - 1));
        const std::vector<uint32_t> parts = split(tree, irradiance);
        watch_.begin("dividing patches", parts.size(), share(level - 1), share(level));
        make_rows(
            makers_, watch_, parts.size(),
            [&](uint64_t k) {
                return NumberedPatch{&tree.patches[parts[k]], hash_words(parts[k], level, 0x70617274u).x};
            },
            [&](uint64_t k, const FormFactorRow& row) {
                irradiance[parts[k]] = row.direct + gather(row.factors, sent_);
            });
        return !parts.empty() && !watch_.is_over();
    }

private:
    /// Splits patches and returns the parts, whose light is to be found; until then they have that of the whole.
    std::vector<uint32_t> split(PatchTree& tree, std::vector<Rgb>& irradiance) {
        std::vector<uint32_t> wholes;
        {
            const std::vector<PatchLight> lights = light_corners(scene_.view(), tree, irradiance);
            const std::size_t most = (kMaxPatches - tree.patches.size()) / 3;
            for (uint32_t i = 0; i < lights.size() && wholes.size() < most; ++i) {
                if (is_black(tree.patches[i].reflectance)) continue;
                if (changes(lights[i], ambient_, settings_.contrast)) wholes.push_back(i);
            }
        }
        tree.patches.reserve(tree.patches.size() + 3 * wholes.size());
        tree.quads.reserve(tree.quads.size() + wholes.size());
        irradiance.reserve(irradiance.size() + 3 * wholes.size());
        std::vector<uint32_t> parts;
        parts.reserve(4 * wholes.size());
        for (const uint32_t whole : wholes) {
            if (watch_.is_over()) break;
            parts.push_back(whole);
            for (uint32_t k = 0; k < 3; ++k) parts.push_back(static_cast<uint32_t>(tree.patches.size()) + k);
            tree.split(scene_.view(), whole);
            irradiance.insert(irradiance.end(), 3, irradiance[whole]);
        }
        return parts;
    }

    const SolvedScene& scene_;
    RowMakers makers_;
    const RadiositySettings& settings_;
    const std::vector<Rgb>& sent_;
    Rgb ambient_;
    WorkWatch& watch_;
};

float longest_side(const Bounds3& bounds) { return bounds.is_empty() ? 0.0f : max_component(bounds.size()); }

} // namespace

float patch_size_of(const PreparedScene& prepared, const RadiositySettings& settings) {
    if (settings.patch_size > 0) return settings.patch_size;
    return kPatchOfScene * longest_side(prepared.structures->bounds());
}

namespace {

/// Patches with their light, before they are divided where it changes.
struct SolvedPatches {
    PatchTree tree;
    std::vector<Rgb> irradiance;
    std::vector<Rgb> unsent; // SolvedSystem's
    Rgb ambient;

    /// Returns `all` minus a part of it, at least 0, because rounding may have made the part larger.
    static Rgb left_without(Rgb all, Rgb part) {
        return {max(all.r - part.r, 0.0f), max(all.g - part.g, 0.0f), max(all.b - part.b, 0.0f)};
    }
    /// Light that each patch has sent so far, W/m2.
    std::vector<Rgb> sent() const {
        std::vector<Rgb> all;
        all.reserve(irradiance.size());
        for (std::size_t i = 0; i < irradiance.size(); ++i) {
            const Patch& patch = tree.patches[i];
            all.push_back(patch.exitance + patch.reflectance * irradiance[i]);
            if (!unsent.empty()) all[i] = left_without(all[i], unsent[i]);
        }
        return all;
    }
};

/// Returns the progress, in [0, 1], of a solution whose remaining light falls from 1 to `tolerance` by a constant
/// factor per step.
double share_done(double left, double tolerance) {
    if (!(left > 0 && tolerance > 0 && tolerance < 1)) return 1;
    const auto halvings = [](double x) { return static_cast<double>(log2(static_cast<float>(x))); };
    return halvings(std::min(left, 1.0)) / halvings(tolerance);
}

SolvedPatches solve_rows(const SolvedScene& scene, float patch_size, const RadiositySettings& settings,
                         WorkWatch& watch, SolveStats& stats) {
    SolvedPatches solved;
    solved.tree = make_patches(scene.view(), patch_size, &watch);
    if (settings.solver == RadiositySolver::Matrix)
        check_matrix_size(solved.tree.patches.size()); // before hours of rows
    const Stopwatch row_time;
    const RadiositySystem system = make_system(scene, solved.tree, settings, watch);
    stats.factors = system.factor_count();
    stats.bytes = system.bytes();
    stats.factor_seconds = row_time.seconds();
    const Stopwatch solve_time;
    check_light_ends(system);
    watch.begin("solving", 0);
    SolvedSystem solution = solve(system, settings, [&](double left) {
        const bool is_matrix = settings.solver == RadiositySolver::Matrix;
        watch.set_share(is_matrix ? 1 - left : share_done(left, static_cast<double>(settings.tolerance)));
        return !watch.is_over();
    });
    stats.steps = solution.steps;
    stats.left = solution.left;
    stats.reached_limit = solution.reached_limit;
    stats.solve_seconds = solve_time.seconds();
    solved.irradiance = std::move(solution.irradiance);
    solved.unsent = std::move(solution.unsent);
    solved.ambient = solution.ambient;
    return solved;
}

SolvedPatches solve_links(const SolvedScene& scene, float patch_size, const RadiositySettings& settings,
                          WorkWatch& watch, uint64_t max_links, SolveStats& stats) {
    const Stopwatch time;
    HierarchicalSolution solution = solve_hierarchically(scene, make_patches(scene.view(), kInfinity, &watch),
                                                         patch_size, settings, watch, max_links);
    stats.factors = solution.links;
    stats.steps = solution.passes;
    stats.left = solution.left;
    stats.without_direct = solution.without_direct;
    stats.reached_limit = solution.reached_limit;
    stats.link_error = solution.link_error;
    stats.bytes = solution.bytes;
    stats.solve_seconds = time.seconds();
    return {std::move(solution.tree), std::move(solution.irradiance), {}, {}};
}

/// Returns whether rows were solved to the end, regardless of interrupts.
bool is_whole(const SolveStats& stats, const RadiositySettings& settings) {
    return settings.solver != RadiositySolver::Hierarchical && stats.steps > 0 &&
           stats.left <= static_cast<double>(settings.tolerance);
}

/// Extent of a solution that ended before its patches were divided.
SolvedExtent extent_of(const SolveStats& stats, RadiositySolver solver) {
    const auto share = [](double x) { return static_cast<float>(std::clamp(x, 0.0, 1.0)); };
    if (stats.without_direct > 0) return {SolvedPart::SomeDirectLight, share(stats.without_direct)};
    const bool begins_with_direct = solver == RadiositySolver::Hierarchical || solver == RadiositySolver::Matrix;
    if (begins_with_direct && stats.steps == 0) return {SolvedPart::DirectLight, 1};
    return {SolvedPart::SomeBounces, share(stats.left)};
}

} // namespace

SolvedRadiosity solve_radiosity(const PreparedScene& prepared, const RadiositySettings& settings, Sink& sink,
                                uint64_t max_links) {
    WorkWatch watch(sink);
    const SolvedScene scene(prepared);
    const float patch_size = patch_size_of(prepared, settings);
    SolvedRadiosity solved;
    SolveStats& stats = solved.stats;
    SolvedPatches shown = settings.solver == RadiositySolver::Hierarchical
                              ? solve_links(scene, patch_size, settings, watch, max_links, stats)
                              : solve_rows(scene, patch_size, settings, watch, stats);
    stats.patches = shown.tree.patches.size();
    SolvedExtent extent;
    const bool is_solved = is_whole(stats, settings);
    if (watch.is_over() && !is_solved) extent = extent_of(stats, settings.solver);
    const Stopwatch divide_time;
    if (settings.subdivisions > 0 && !watch.is_over()) {
        const PatchTree sources = shown.tree;
        const std::vector<Rgb> sent = shown.sent();
        Divider divider(scene, sources, settings, sent, shown.ambient, watch);
        for (uint32_t level = 1; level <= settings.subdivisions; ++level) {
            if (!divider.divide(shown.tree, shown.irradiance, level)) break;
        }
    }
    stats.was_interrupted = watch.is_over() && !(is_solved && settings.subdivisions == 0);
    if (stats.was_interrupted && extent.part == SolvedPart::All) extent.part = SolvedPart::SomeDivided;
    RadiositySolution& solution = solved.solution;
    solution.geometry = geometry_hash(*prepared.scene);
    solution.light = solved_light(*prepared.scene);
    RadiositySettings made = settings;
    if (stats.link_error > 0) made.link_error = stats.link_error;
    solution.made = json_of(made);
    solution.patches = light_corners(scene.view(), shown.tree, shown.irradiance);
    solution.roots = std::move(shown.tree.roots);
    solution.quads = std::move(shown.tree.quads);
    solution.ambient = shown.ambient;
    solution.extent = extent;
    stats.shown = solution.patches.size();
    stats.divide_seconds = divide_time.seconds();
    return solved;
}

void warn_of_limits(const SolveStats& stats, const RadiositySettings& settings, Sink& sink) {
    if (stats.link_error > settings.link_error) {
        sink.warn(
            {"link_error", fmt::format("{}", settings.link_error),
             fmt::format("radiosity has more than {} links, the limit; {} with `link_error={}` (set that to save time)",
                         kMaxLinks, stats.was_interrupted ? "the solution is unfinished" : "the system is solved",
                         stats.link_error)});
    }
    if (!stats.reached_limit) return;
    const bool is_ambient = settings.solver == RadiositySolver::Southwell;
    sink.warn({"tolerance", fmt::format("{}", settings.tolerance),
               fmt::format("radiosity: after {} steps, the limit, {:.2g} of the light {}, which exceeds it (almost "
                           "nothing absorbs light; lower reflectances, or use a larger tolerance)",
                           stats.steps, stats.left,
                           is_ambient ? "is unshot and displayed as ambient light" : "still changes")});
}

std::string json_of(const RadiositySettings& s) {
    return fmt::format(
        R"({{"patch_size":{},"subdivisions":{},"contrast":{},"form_factors":"{}","rays":{},"hemicube":{},"solver":"{}","tolerance":{},"steps":{},"link_error":{},"seed":{}}})",
        s.patch_size, s.subdivisions, s.contrast, name_of(s.form_factors), s.rays, s.hemicube, name_of(s.solver),
        s.tolerance, s.steps, s.link_error, s.seed);
}

} // namespace pertev
