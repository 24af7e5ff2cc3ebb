#pragma once

// A radiosity solution as device code sees it: what light every place of a surface receives.

#include "math/rgb.h"
#include "radiosity/patch_tree.h"

namespace pertev {

/// Irradiance of a patch, W/m2.
struct alignas(16) PatchLight {
    Rgb corner[3]; // shared with the patches around
    Rgb mean;
};
static_assert(sizeof(PatchLight) == 48);

struct RadiosityView {
    PatchTreeView tree;
    const PatchLight* patches = nullptr; // null: there is no solution
    Rgb ambient;                         // irradiance that is on top everywhere, of light that is not solved for
    bool is_flat = false;                // patches are shown as they are, without what is between them

    /// Irradiance at weights (1 - u - v, u, v) of a face, W/m2; black where it has no patch.
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
