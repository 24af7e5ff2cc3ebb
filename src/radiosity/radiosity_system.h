#pragma once

// The linear system of a radiosity solution and its solvers. For patch i with irradiance H, reflectance r and
// exitance E:
//     B_i = E_i + r_i H_i,   H_i = direct_i + sum over j of F_ij B_j.
// All solvers converge to the same B; they differ in the order of work. Each adds in a fixed order, and simultaneous
// terms in a tree (math/tree_sum.h), so that the bytes of the solution do not depend on the number of threads.
//
// Sources: Goral et al. 1984 (elimination); Cohen, Greenberg 1985 (Gauss-Seidel); Cohen, Chen, Wallace, Greenberg, "A
// Progressive Refinement Approach to Fast Radiosity Image Generation", SIGGRAPH 1988, and Gortler, Cohen, Slusallek,
// "Radiosity and Relaxation Methods", 1994 (Southwell).

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "math/rgb.h"
#include "radiosity/form_factor_row.h"

namespace pertev {

/// Data of a patch in a system.
struct SystemPatch {
    float area = 0; // m2
    Rgb reflectance, exitance;
};

struct RadiositySystem {
    std::vector<SystemPatch> patches;
    std::vector<std::vector<FormFactor>> rows; // [patches]
    std::vector<Rgb> direct;                   // [patches] irradiance, W/m2

    std::span<const FormFactor> row(std::size_t i) const { return rows[i]; }
    uint64_t factor_count() const {
        uint64_t count = 0;
        for (const std::vector<FormFactor>& row : rows) count += row.size();
        return count;
    }
    /// Size of the system in host memory, bytes.
    std::size_t bytes() const {
        return factor_count() * sizeof(FormFactor) +
               patches.size() * (sizeof(SystemPatch) + sizeof(Rgb) + sizeof(std::vector<FormFactor>));
    }
};

struct SolvedSystem {
    std::vector<Rgb> irradiance; // [patches] W/m2
    /// Irradiance of every patch, in addition to its own, from unsent light that is distributed evenly (Cohen et al.
    /// 1988, section 4). It is 0 if all has been sent.
    Rgb ambient;
    uint64_t steps = 0; // sweeps over all patches, or sending patches
    double left = 0;    // share of the light that is unsent, or that the last sweep changed
    /// [patches] the part of each patch's radiosity, W/m2, that no patch has received yet, by Southwell. The ambient
    /// light represents it and its reflections. Empty if all has been sent.
    std::vector<Rgb> unsent;
    bool reached_limit = false; // stopped by kMaxSweeps, with more left than the tolerance
};

/// Maximum number of sweeps over all patches; for Southwell, which sends from one at a time, the maximum per patch.
/// It is insufficient only if next to nothing absorbs light.
inline constexpr uint64_t kMaxSweeps = 10000;

/// Channel k of c as a double; the solvers treat each alone.
inline double channel(Rgb c, int k) { return static_cast<double>(k == 0 ? c.r : k == 1 ? c.g : c.b); }

/// Throws Error(BadInput) if light never ends because it reaches patches that reflect all of it only to each other.
/// Then the system has no solution.
void check_light_ends(const RadiositySystem& system);

/// A function that is called often, with the share of the light that is left; false ends the solution in its present
/// state.
using KeepSolving = std::function<bool(double left)>;

/// Solves by sending light from one patch at a time. `tolerance` is the share of unsent light at which it ends. `steps`
/// is the maximum number of sending patches; 0: unlimited.
SolvedSystem solve_by_southwell(const RadiositySystem& system, double tolerance, uint64_t steps,
                                const KeepSolving& keep_going = {});
SolvedSystem solve_by_gauss_seidel(const RadiositySystem& system, double tolerance, const KeepSolving& keep_going = {});
/// Checks the size of a matrix. Throws Error(OverLimit) for more than kMaxMatrixPatches.
void check_matrix_size(std::size_t patches);
/// Solves by Gaussian elimination. Throws as check_matrix_size(). If the elimination is interrupted, the solution is
/// direct light only, with 0 steps.
SolvedSystem solve_by_matrix(const RadiositySystem& system, const KeepSolving& keep_going = {});

} // namespace pertev
