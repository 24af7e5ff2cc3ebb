#pragma once

// Next-event estimation may select a light by a tree for the vertex that it lights; emission, which has no such vertex,
// selects it by power. Where both find a light path, their MIS weights need the ratio of the two probabilities, which
// follows from the light and the vertex next to it (Georgiev 2012, section 4.2: connect and trace densities).

#include "shading/chosen_by_tree.h"

namespace pertev {

/// Probability that emission selects a light with a position; `light` is a triangle, or a punctual light numbered after
/// them.
HD inline float emission_pmf(const LightSetView& view, uint32_t light) {
    if (light < view.triangle_count) return view.triangles[light].pmf;
    return cdf_pmf(view.choice, view.emitter_count + light - view.triangle_count);
}

/// Probability that next-event estimation selects a light for `context`, over that of emission. It is 1 for kNoLight,
/// a light from far.
template <class Choice>
HD inline float selection_ratio(const LightSetView& view, const LightContext& context, uint32_t light) {
    if constexpr (Choice::kReadsNormal) {
        if (light != kNoLight) return Choice::pmf_of_triangle(view, context, light) / emission_pmf(view, light);
    }
    return 1;
}

/// Probability that next-event estimation selects the sampled light for `context`, over that of emission.
template <class Choice>
HD inline float selection_ratio(const LightSetView& view, const LightContext& context, const LightSample& light) {
    if constexpr (Choice::kReadsNormal) {
        if (!(light.distance < kInfinity)) return 1;
        switch (light.kind()) {
        case SourceKind::Punctual:
            return light.pdf / emission_pmf(view, view.triangle_count + light.primitive);
        case SourceKind::Triangle: {
            const uint32_t number = light_of(view, light.instance, light.primitive);
            return light.pdf / pdf_light_hit(view, number, context, light.light_point);
        }
        case SourceKind::Environment: // it is infinitely far
            break;
        }
    }
    return 1;
}

} // namespace pertev
