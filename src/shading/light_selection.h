#pragma once

// How next-event estimation selects a light: by a tree for each receiver (shading/light_tree/), by power, or by the
// tree where there are many lights. Emission of particles has no receiver, so it is always by power.

#include <cstdint>

namespace pertev {

enum class LightSelection : uint8_t { Auto, Tree, Power };

/// The most lights with a position that Auto selects by power: a step down a tree costs more than tables do.
inline constexpr uint32_t kFewLights = 256;

/// Returns whether lights are selected by a tree, which holds `lights`. It does not know lights that move while the
/// shutter is open.
inline bool uses_light_tree(LightSelection selection, uint32_t lights, bool has_times) {
    switch (selection) {
    case LightSelection::Auto:
        return lights > kFewLights && !has_times;
    case LightSelection::Tree:
        return lights > 0 && !has_times;
    case LightSelection::Power:
        break;
    }
    return false;
}

} // namespace pertev
