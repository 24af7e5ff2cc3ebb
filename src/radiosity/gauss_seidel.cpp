// Each patch in turn gathers what all others send by now, until a sweep changes hardly anything. The matrix is
// diagonally dominant, so that it comes to an end.

#include "radiosity/radiosity_system.h"

namespace pertev {
namespace {

double sum_of(Rgb c) { return static_cast<double>(c.r) + static_cast<double>(c.g) + static_cast<double>(c.b); }
constexpr std::size_t kPatchesAtOnce = 1024; // between two looks at whether to go on

} // namespace

SolvedSystem solve_by_gauss_seidel(const RadiositySystem& system, double tolerance, const KeepSolving& keep_going) {
    const std::size_t count = system.patches.size();
    SolvedSystem solved;
    solved.irradiance = system.direct;
    solved.left = 1;
    bool goes_on = true;
    std::vector<Rgb> radiosity(count);
    for (std::size_t i = 0; i < count; ++i) radiosity[i] = system.patches[i].exitance;
    do {
        double changed = 0, all = 0;
        for (std::size_t i = 0; i < count; ++i) {
            if (i % kPatchesAtOnce == kPatchesAtOnce - 1 && keep_going && !keep_going(solved.left)) return solved;
            const SystemPatch& patch = system.patches[i];
            double r = 0, g = 0, b = 0;
            for (const FormFactor& from : system.row(i)) {
                const auto factor = static_cast<double>(from.factor);
                const Rgb sent = radiosity[from.patch];
                r += factor * static_cast<double>(sent.r);
                g += factor * static_cast<double>(sent.g);
                b += factor * static_cast<double>(sent.b);
            }
            const Rgb gathered = {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)};
            solved.irradiance[i] = system.direct[i] + gathered;
            const Rgb now = patch.exitance + patch.reflectance * solved.irradiance[i];
            const auto area = static_cast<double>(patch.area);
            const Rgb change = now - radiosity[i];
            changed += area * sum_of({abs(change.r), abs(change.g), abs(change.b)});
            all += area * sum_of(now);
            radiosity[i] = now;
        }
        ++solved.steps;
        solved.left = all > 0 ? changed / all : 0;
        goes_on = !keep_going || keep_going(solved.left);
    } while (goes_on && solved.left > tolerance && solved.steps < kMostSweeps);
    solved.reached_limit = goes_on && solved.left > tolerance;
    return solved;
}

} // namespace pertev
