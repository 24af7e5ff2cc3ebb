#pragma once

// Tabulated light that a coat on metal reflects downwards and the metal sends out again. A coat with the albedo C
// leaves 1 - max(C(o), C(i)) to what is beneath, which loses up to 5 % of what rough white metal scatters to where C is
// larger. To metal it leaves s r(o) r(i) more, with the s of returned_by_coat_scale(). For each pair of widths r is
// such that this is all that was lost, whatever the direction: sum(k(o, i) r(i)) r(o) = l(o), with the light k that
// white metal scatters and the loss l. It is reciprocal, is drawn as the metal is, and metal that absorbs gains
// nothing.
//
// Axes: widths of coat and metal as the averages of energy_tables.h; mu as there, with the metal's width. l is nearly
// proportional to 1 - f0; tools/coated_integrals.h fits r for an f0 of 0.04. What is left is lost: with metal of
// roughness 0.2 and more 0.3 %, with less 0.8 %, and within half a degree of the horizon up to 2.5 %.

#include "shading/lobes/coated_table_data.h"
#include "shading/lobes/energy_tables.h"

namespace pertev {

/// The function r of the cosine `mu`. `metal_alpha` is in [kSmoothAlpha, 1], `coat_alpha` in [0, 1].
HD_CALL inline float returned_by_coat(float mu, float coat_alpha, float metal_alpha) {
    using namespace energy_table;
    constexpr int metals = coated_table::kMetalNodes, mus = coated_table::kMuNodes;
    const Cell coat = average_cell(coat_alpha, coated_table::kCoatNodes), row = average_cell(metal_alpha, metals),
               column = mu_cell(mu, metal_alpha, mus);
    const uint32_t first = coat.node * (metals * mus);
    const auto table = [](int i) { return coated_table::returned_by_coat_at(i); };
    return kUnit * lerp(along(table, first, row, column, mus), along(table, first + metals * mus, row, column, mus),
                        coat.fraction);
}
/// The factor s of a coat of weight 1, by comparison over widths, angles and f0: rough coats lose less where they
/// reflect more, and the roughest ones where they reflect less.
HD inline float returned_by_coat_scale(float coat_alpha, float f0) {
    const float change = f0 < 0.04f ? coat_alpha * (1.0f - 25.0f * f0) : 6.5f * min(coat_alpha, 0.25f) * (f0 - 0.04f);
    return (1.0f - f0) * max(1.0f - change, 0.0f);
}

} // namespace pertev
