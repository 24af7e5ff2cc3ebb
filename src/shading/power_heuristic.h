#pragma once

// The MIS weight of a sample that two techniques could have drawn.
//
// Source: Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section 9.2.4.

#include "base/host_device.h"

namespace pertev {

/// Weight of the technique with density `pdf` > 0, where the other technique has `other_pdf`.
template <class T = float>
HD inline T power_heuristic(T pdf, T other_pdf) {
    const T ratio = other_pdf / pdf;
    return 1.0f / (1.0f + ratio * ratio);
}

} // namespace pertev
