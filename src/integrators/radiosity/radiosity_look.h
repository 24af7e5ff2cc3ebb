#pragma once

// What `integrator=radiosity` is asked for beside scene and camera.

#include <memory>

#include "radiosity/radiosity_solution.h"

namespace pertev {

struct RadiosityLook {
    std::shared_ptr<const RadiositySolution> solution; // of the scene; null: there is none yet
    bool is_flat = false;                              // patches as they are solved, without what is between them

    bool operator==(const RadiosityLook&) const = default;
};

} // namespace pertev
