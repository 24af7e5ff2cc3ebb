#pragma once

// The flags of --integrator photon_map.

#include <cstdint>
#include <string>

#include "session/render_settings.h"

namespace CLI {
class App;
}

namespace pertev {

/// 0 and empty: not given.
struct PhotonFlags {
    uint32_t photons = 0, nearest = 0;
    float radius = 0, caustic_radius = 0;
    std::string gather, search;
};

void add_photon_flags(CLI::App& verb, PhotonFlags& flags, const char* group);

/// What they ask for. Throws Error(BadInput) where one is given to another integrator, called `name`.
PhotonMapSettings photon_map_settings(const PhotonFlags& flags, IntegratorKind integrator, const std::string& name);

} // namespace pertev
