#pragma once

// The flags of --integrator irradiance_cache.

#include <cstdint>
#include <string>

#include "session/render_settings.h"

namespace CLI {
class App;
}

namespace pertev {

/// 0 and false: not given.
struct IrradianceCacheFlags {
    float accuracy = 0;
    uint32_t hemisphere_rays = 0;
    bool show_records = false;
};

void add_irradiance_cache_flags(CLI::App& verb, IrradianceCacheFlags& flags, const char* group);

/// What they ask for. Throws Error(BadInput) where one is given to another integrator, called `name`.
IrradianceCacheSettings irradiance_cache_settings(const IrradianceCacheFlags& flags, IntegratorKind integrator,
                                                  const std::string& name);

} // namespace pertev
