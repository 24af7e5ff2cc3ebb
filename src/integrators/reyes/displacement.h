#pragma once

// Heights of a material as device code reads them: bilinear, in our own arithmetic, repeating.

#include "device_scene/scene_view.h"
#include "shading/texture_lookup.h"

namespace pertev {

struct DisplacementView {
    const float* heights = nullptr; // [height * width]; null: the material has none
    uint32_t width = 0, height = 0;
    float scale = 0, middle = 0;
    float reach = 0; // no place is moved farther, in the mesh's own unit

    HD float at(Vec2 uv) const {
        const TexelPair x = linear_texels(uv.x, Wrap::Repeat, width), y = linear_texels(uv.y, Wrap::Repeat, height);
        const float *top = heights + uint64_t(y.i0) * width, *bottom = heights + uint64_t(y.i1) * width;
        const float h = lerp(lerp(top[x.i0], top[x.i1], x.t), lerp(bottom[x.i0], bottom[x.i1], x.t), y.t);
        return scale * (h - middle);
    }
};

struct DisplacementsView {
    const DisplacementView* of_material = nullptr; // [count]
    uint32_t count = 0;                            // later materials have none

    /// Null: the material has none.
    HD const DisplacementView* find(uint32_t material) const {
        if (material >= count || of_material[material].heights == nullptr) return nullptr;
        return of_material + material;
    }
};

} // namespace pertev
