// Solves the system as a dense matrix by elimination, as Goral et al. 1984 do. It needs no pivoting, because the
// diagonal dominates. Each colour channel has its own matrix, because reflectances differ.

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "math/tree_sum.h"
#include "radiosity/radiosity_settings.h"
#include "radiosity/radiosity_system.h"

namespace pertev {
namespace {

/// Returns the radiosities of channel `k`; empty if the elimination was interrupted.
std::vector<double> eliminate(const RadiositySystem& system, int k, const KeepSolving& keep_going) {
    const std::size_t n = system.patches.size();
    std::vector<double> matrix(n * n, 0.0), b(n);
    for (std::size_t i = 0; i < n; ++i) {
        const SystemPatch& patch = system.patches[i];
        const double reflectance = channel(patch.reflectance, k);
        matrix[i * n + i] = 1;
        for (const FormFactor& from : system.row(i)) {
            matrix[i * n + from.patch] -= reflectance * static_cast<double>(from.factor);
        }
        b[i] = channel(patch.exitance, k) + reflectance * channel(system.direct[i], k);
    }
    for (std::size_t pivot = 0; pivot < n; ++pivot) {
        const double* from = matrix.data() + pivot * n;
        parallel_for(n - pivot - 1, 32, [&](uint64_t below) {
            double* row = matrix.data() + (pivot + 1 + below) * n;
            if (row[pivot] == 0) return;
            const double factor = row[pivot] / from[pivot];
            for (std::size_t column = pivot; column < n; ++column) row[column] -= factor * from[column];
            b[pivot + 1 + below] -= factor * b[pivot];
        });
        const double left = static_cast<double>(3 - k) / 3 - static_cast<double>(pivot) / static_cast<double>(3 * n);
        if (keep_going && !keep_going(left)) return {};
    }
    for (std::size_t i = n; i-- > 0;) {
        const double *row = matrix.data() + i * n, *known = row + i + 1, *of = b.data() + i + 1;
        const double others = tree_sum(n - i - 1, [&](uint64_t j) { return known[j] * of[j]; });
        b[i] = (b[i] - others) / row[i];
    }
    return b;
}

/// Returns direct light of emitters and other lights, without reflections: the solution as far as it is known before
/// the elimination is complete.
SolvedSystem solve_direct_light(const RadiositySystem& system) {
    std::vector<Rgb> exitance;
    for (const SystemPatch& patch : system.patches) exitance.push_back(patch.exitance);
    SolvedSystem solved;
    for (std::size_t i = 0; i < system.patches.size(); ++i) {
        solved.irradiance.push_back(system.direct[i] + gather(system.row(i), exitance));
    }
    solved.left = 1;
    return solved;
}

} // namespace

void check_matrix_size(std::size_t patches) {
    if (patches <= kMaxMatrixPatches) return;
    throw Error(ErrorCode::OverLimit, "solver", "matrix",
                fmt::format("the scene has {} patches; the limit is {} (`solver=gauss-seidel` or southwell solves "
                            "more, and a larger `patch_size` makes fewer)",
                            patches, kMaxMatrixPatches));
}

SolvedSystem solve_by_matrix(const RadiositySystem& system, const KeepSolving& keep_going) {
    const std::size_t n = system.patches.size();
    check_matrix_size(n);
    SolvedSystem solved;
    std::vector<Rgb> radiosity(n);
    for (int k = 0; k < 3; ++k) {
        const std::vector<double> found = eliminate(system, k, keep_going);
        if (found.empty() && n > 0) return solve_direct_light(system);
        for (std::size_t i = 0; i < n; ++i) {
            const auto value = static_cast<float>(found[i]);
            (k == 0 ? radiosity[i].r : k == 1 ? radiosity[i].g : radiosity[i].b) = value;
        }
    }
    solved.steps = n;
    for (std::size_t i = 0; i < n; ++i) {
        solved.irradiance.push_back(system.direct[i] + gather(system.row(i), radiosity));
    }
    return solved;
}

} // namespace pertev
