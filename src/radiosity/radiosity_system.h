#pragma once

// The linear system of a radiosity solution and its solvers. Of patch i, with irradiance H, reflectance r and exitance
// E:
//     B_i = E_i + r_i H_i,   H_i = direct_i + sum over j of F_ij B_j.
// All solvers come to the same B; they differ in what they work on first. Each of them adds in an order that is fixed,
// what is there at once in a tree (math/tree_sum.h), so that the bytes of the solution do not depend on the number of
// threads.
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

/// What a system knows of a patch.
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
    /// Of this machine's memory.
    std::size_t bytes() const {
        return factor_count() * sizeof(FormFactor) +
               patches.size() * (sizeof(SystemPatch) + sizeof(Rgb) + sizeof(std::vector<FormFactor>));
    }
};

struct SolvedSystem {
    std::vector<Rgb> irradiance; // [patches] W/m2
    /// Of light that has not been sent yet, spread evenly: irradiance of every patch beside its own (Cohen et al. 1988,
    /// section 4). 0 where all has been.
    Rgb ambient;
    uint64_t steps = 0; // sweeps over all patches, or patches that have sent
    double left = 0;    // share of the light that is unsent, or that the last sweep changed
    /// Of Southwell: [patches] of each patch's radiosity, W/m2, what no patch has received yet: the ambient light
    /// stands for it, and for what becomes of it. Empty where all has been sent.
    std::vector<Rgb> unsent;
    bool reached_limit = false; // ended by kMostSweeps, with more left than the tolerance
};

/// Sweeps over all patches at most; of Southwell, which sends from one at a time, so many for each patch. Only where
/// next to nothing absorbs is it not enough.
inline constexpr uint64_t kMostSweeps = 10000;

/// Throws Error(BadInput) where light has no end: where it reaches patches that reflect all of it, to each other alone.
/// There the system has no solution.
void check_light_ends(const RadiositySystem& system);

/// Called often, with the share of the light that is left; false ends the solution where it is.
using KeepSolving = std::function<bool(double left)>;

/// `tolerance`: ends where no more than this share is left. `steps`: at most so many patches send; 0: any number.
SolvedSystem solve_by_southwell(const RadiositySystem& system, double tolerance, uint64_t steps,
                                const KeepSolving& keep_going = {});
SolvedSystem solve_by_gauss_seidel(const RadiositySystem& system, double tolerance, const KeepSolving& keep_going = {});
/// Throws Error(OverLimit) for more than kMostMatrixPatches.
void check_matrix_size(std::size_t patches);
/// As check_matrix_size(). Of an elimination that was ended the solution is direct light alone, by 0 steps.
SolvedSystem solve_by_matrix(const RadiositySystem& system, const KeepSolving& keep_going = {});

} // namespace pertev
