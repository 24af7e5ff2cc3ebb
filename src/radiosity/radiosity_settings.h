#pragma once

// Settings of a radiosity solution besides its scene.

#include <cstdint>

#include "base/value_names.h"

namespace pertev {

/// Method to compute form factors.
enum class FormFactors : uint8_t {
    Rays,     // rays through the scene: radiosity/ray_rows.cpp
    Hemicube, // projection on half a cube: radiosity/hemicube.h
};

/// Solver of the system of linear equations. All solvers have one solution.
enum class RadiositySolver : uint8_t {
    Southwell,    // progressive refinement: the patch with most unsent light sends next
    GaussSeidel,  // each patch gathers in turn
    Matrix,       // elimination
    Hierarchical, // links between patches and clusters of all sizes: radiosity/hierarchical.h
};

inline constexpr ValueName<FormFactors> kFormFactors[] = {{FormFactors::Rays, "rays"},
                                                          {FormFactors::Hemicube, "hemicube"}};
inline constexpr ValueName<RadiositySolver> kRadiositySolvers[] = {{RadiositySolver::Southwell, "southwell"},
                                                                   {RadiositySolver::GaussSeidel, "gauss-seidel"},
                                                                   {RadiositySolver::Matrix, "matrix"},
                                                                   {RadiositySolver::Hierarchical, "hierarchical"}};
constexpr const auto& names_of_all(FormFactors) { return kFormFactors; }
constexpr const auto& names_of_all(RadiositySolver) { return kRadiositySolvers; }

struct RadiositySettings {
    float patch_size = 0;      // maximum edge of a patch, metres; 0: kPatchOfScene of the scene's longest side
    uint32_t subdivisions = 2; // maximum number of times that a patch is divided where light varies
    float contrast = 0.1f;     // variation from which on it is divided, relative to the mean of its corners
    uint32_t rays = 256;       // per patch
    uint32_t hemicube = 128;   // pixels along an edge of a hemicube's top
    FormFactors form_factors = FormFactors::Rays;
    RadiositySolver solver = RadiositySolver::GaussSeidel;
    float tolerance = 1e-4f; // share of the light that may remain unsent
    uint32_t steps = 0;      // for Southwell: maximum number of sending patches; 0: as many as tolerance needs
    float link_error = 0.1f; // for Hierarchical: permitted error of a link relative to the mean light
    uint32_t seed = 0;

    bool operator==(const RadiositySettings&) const = default;
};

inline constexpr float kPatchOfScene = 1.0f / 16;
inline constexpr uint32_t kMaxPatches = 1u << 25;
inline constexpr uint32_t kMaxSubdivisions = 8;
inline constexpr uint32_t kMinPatchRays = 16, kMaxPatchRays = 1u << 20;
inline constexpr uint32_t kMinHemicube = 8, kMaxHemicube = 2048;
inline constexpr uint64_t kMaxLinks = uint64_t(1) << 26; // RadiositySolver::Hierarchical: 1 GiB
inline constexpr uint32_t kMaxMatrixPatches = 6000;      // RadiositySolver::Matrix: 275 MiB, a minute

} // namespace pertev
