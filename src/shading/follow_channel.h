#pragma once

// Dispersed glass for light of one colour. A path that was refracted there carries one channel on, whose direction is
// known: at the next interface it needs no draw among three, so its weight does not triple each time.

#include "shading/bsdf.h"

namespace pertev {

HD_CALL inline void follow_channel_in_stack(Rgb throughput, Bsdf& bsdf) {
    const bool r = throughput.r > 0, g = throughput.g > 0, b = throughput.b > 0;
    if (int(r) + int(g) + int(b) != 1) return;
    for (int i = 0; i < bsdf.layer_count; ++i) {
        if (bsdf.layers[i].kind != LobeKind::Glass) continue;
        PackedGlassLobe& glass = bsdf.layers[i].glass;
        if (!(glass.spread > 0)) continue;
        glass.ior = glass.unpacked().of_channel(r ? 0 : g ? 1 : 2).ior;
        glass.spread = 0;
    }
}
/// Lets a BSDF refract as in the only channel of `throughput` that is not 0; if there are others, it stays as it is.
HD inline void follow_channel(Rgb throughput, Bsdf& bsdf) {
    if (bsdf.has_far_light) follow_channel_in_stack(throughput, bsdf);
}

} // namespace pertev
