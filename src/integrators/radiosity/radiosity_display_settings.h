#pragma once

// Settings of `integrator=radiosity` besides scene and camera.

#include <memory>

#include "radiosity/radiosity_solution.h"

namespace pertev {

struct RadiosityDisplay {
    std::shared_ptr<const RadiositySolution> solution; // null before the scene has one
    bool is_flat = false;                              // shows patches without interpolation

    bool operator==(const RadiosityDisplay&) const = default;
};

} // namespace pertev
