#include "session/photometry.h"

#include "base/file_extension.h"
#include "math/portable_math.h"

namespace pertev {

double lumens_per_watt(const std::string& scene, double requested) {
    if (requested > 0) return requested;
    const std::string extension = lower_case_extension(scene);
    return extension == ".gltf" || extension == ".glb" ? 1 : kLumensPerWatt;
}

double exposure_value(const PhysicalExposure& exposure) {
    const double squared = exposure.f_number * exposure.f_number;
    return static_cast<double>(log2(static_cast<float>(squared / exposure.shutter_s * 100 / exposure.iso)));
}

float exposure_stops(const PhysicalExposure& exposure, double lumens_per_watt) {
    return log2(static_cast<float>(lumens_per_watt / 1.2)) - static_cast<float>(exposure_value(exposure));
}

} // namespace pertev
