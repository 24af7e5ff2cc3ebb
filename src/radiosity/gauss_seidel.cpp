// Gauss-Seidel iteration: each patch in turn gathers the current radiosity of all others, until a sweep
// changes little. It converges because the matrix is diagonally dominant.

#include "math/tree_sum.h"
#include "radiosity/radiosity_system.h"

namespace pertev {
namespace {

double sum_of(Rgb c) { return static_cast<double>(c.r) + static_cast<double>(c.g) + static_cast<double>(c.b); }
constexpr std::size_t kPatchesAtOnce = 1024; // between two queries of whether to go on

/// The light that leaves one or many patches, and its change, W.
struct Sweep {
    double changed = 0, all = 0;
};

Sweep operator+(Sweep a, Sweep b) { return {a.changed + b.changed, a.all + b.all}; }

} // namespace

SolvedSystem solve_by_gauss_seidel(const RadiositySystem& system, double tolerance, const KeepSolving& keep_going) {
    const std::size_t count = system.patches.size();
    SolvedSystem solved;
    solved.irradiance = system.direct;
    solved.left = 1;
    bool goes_on = true;
    std::vector<Rgb> radiosity(count);
    for (std::size_t i = 0; i < count; ++i) radiosity[i] = system.patches[i].exitance;
    bool is_ended = false;
    const auto relax = [&](uint64_t i) -> Sweep {
        const bool asks = !is_ended && i % kPatchesAtOnce == kPatchesAtOnce - 1;
        if (asks && keep_going && !keep_going(solved.left)) is_ended = true;
        if (is_ended) return {};
        const SystemPatch& patch = system.patches[i];
        solved.irradiance[i] = system.direct[i] + gather(system.row(i), radiosity);
        const Rgb now = patch.exitance + patch.reflectance * solved.irradiance[i];
        const auto area = static_cast<double>(patch.area);
        const Rgb change = now - radiosity[i];
        radiosity[i] = now;
        return {area * sum_of({abs(change.r), abs(change.g), abs(change.b)}), area * sum_of(now)};
    };
    do {
        const Sweep sweep = tree_sum(count, relax); // patch by patch, in order
        if (is_ended) return solved;
        ++solved.steps;
        solved.left = sweep.all > 0 ? sweep.changed / sweep.all : 0;
        goes_on = !keep_going || keep_going(solved.left);
    } while (goes_on && solved.left > tolerance && solved.steps < kMaxSweeps);
    solved.reached_limit = goes_on && solved.left > tolerance;
    return solved;
}

} // namespace pertev
