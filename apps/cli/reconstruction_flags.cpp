#include "apps/cli/reconstruction_flags.h"

#include "settings/value_names.h"

namespace pertev {

ReconstructionSettings reconstruction_settings(const ReconstructionOptions& options) {
    return options.none ? of_samples_alone(options.settings) : options.settings;
}

bool has_frame_options(const ReconstructionOptions& options) {
    return options.sharing.light != RestirLight::Off || options.settings.resolution_scale != 1;
}

std::string json_of(const ReconstructionOptions& options) {
    return json_of(reconstruction_settings(options), options.sharing);
}

} // namespace pertev
