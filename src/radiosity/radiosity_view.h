#pragma once

// A radiosity solution in device code: the irradiance at every point of a surface.

#include "math/rgb.h"
#include "radiosity/patch_tree.h"

namespace pertev {

/// Irradiance of a patch, W/m2.
struct alignas(16) PatchLight {
    Rgb corner[3]; // shared with adjacent patches
    Rgb mean;
};
static_assert(sizeof(PatchLight) == 48);

struct RadiosityView {
    PatchTreeView tree;
    const PatchLight* patches = nullptr; // null if there is no solution
    Rgb ambient;                         // irradiance added everywhere, for light that is not solved
    bool is_flat = false;                // shows patches without interpolation

    /// Irradiance at weights (1 - u - v, u, v) of a face, W/m2; black if it has no patch.
    HD Rgb irradiance(uint32_t face, float u, float v) const {
        Vec3 weights = {1.0f - u - v, u, v};
        const PatchCode code = tree.find(face, weights);
        if (!is_patch(code)) return {};
        const PatchLight& light = patches[number_of(code)];
        if (is_flat) return light.mean + ambient;
        return weights.x * light.corner[0] + (weights.y * light.corner[1] + weights.z * light.corner[2]) + ambient;
    }
};

} // namespace pertev
