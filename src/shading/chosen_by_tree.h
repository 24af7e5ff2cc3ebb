#pragma once

// ChosenByTree selects lights with a position by a tree (light_tree/light_tree.h) for the receiver. The environment and
// directional lights stand beside the tree, with the shares that ChosenByPower gives them.

#include "shading/light_set.h"
#include "shading/light_tree/light_tree.h"

namespace pertev {

struct ChosenByTree {
    static constexpr bool kReadsNormal = true;

    template <class ToKind>
    HD INLINE_ON_DEVICE static bool draw(const LightSetView& view, const LightContext& context, SampleBits u,
                                         const ToKind& to) {
        if (!view.has_lights()) return false;
        const uint32_t more = bits_behind(u), number = u.x >> 1, of_near = numbers_of_near(view);
        if (number < of_near) {
            const LightTreeDraw near =
                draw_from_tree(view.tree, receiver(context), uint64_t(number) << 32 | more, uint64_t(of_near) << 32);
            const float pmf = cdf_pmf(of_near) * near.pmf;
            if (near.light == kNoLight) return false;
            if (near.light >= view.triangle_count) return to.punctual(near.light - view.triangle_count, pmf);
            return to.triangle(near.light, sample_uniform_triangle(Vec2{near.rest, unit_interval(u.y)}), pmf);
        }
        const CdfDraw far = draw_ordered(view.choice, u.x, more);
        const float pmf = cdf_pmf(far.owned);
        switch (view.kind_of(far.index)) {
        case SourceKind::Environment:
            return to.environment(pmf, SampleBits{number_of_rest(far), u.y});
        case SourceKind::Triangle: // in the tree
        case SourceKind::Punctual:
            break;
        }
        return to.punctual(far.index - view.emitter_count, pmf);
    }
    HD static float pmf_of_triangle(const LightSetView& view, const LightContext& context, uint32_t light) {
        return cdf_pmf(numbers_of_near(view)) * pmf_in_tree(view.tree, receiver(context), light);
    }
    HD static float pmf_of_environment(const LightSetView& view, const LightContext& context) {
        return ChosenByPower::pmf_of_environment(view, context);
    }

    /// Returns how many of 2^31 numbers select lights of the tree.
    HD static uint32_t numbers_of_near(const LightSetView& view) { return view.choice.starts[view.near_count]; }

private:
    HD static LightReceiver receiver(const LightContext& context) { return {context.point, context.normal}; }
};

} // namespace pertev
