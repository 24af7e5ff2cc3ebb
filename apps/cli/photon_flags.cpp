#include "apps/cli/photon_flags.h"

#include <limits>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "base/error.h"
#include "session/settings_text.h"

namespace pertev {

void add_photon_flags(CLI::App& verb, PhotonFlags& flags, const char* group) {
    verb.add_option("--photons", flags.photons,
                    "of photon_map: photons that leave the lights for each sample, as\nmany again aimed at mirrors and "
                    "glass (65536)")
        ->type_name("N")
        ->check(whole_between(1, kMostPhotons))
        ->group(group);
    verb.add_option("--gather", flags.gather,
                    "of photon_map: light of other surfaces by a ray onwards, or\ndirect, from the map (final)")
        ->type_name("NAME")
        ->check(one_of(gather_names()))
        ->group(group);
    verb.add_option("--radius", flags.radius,
                    "of photon_map: from how far photons count, of the first sample;\nit shrinks (a hundredth of the "
                    "scene)")
        ->type_name("METRES")
        ->check(number_between(kLeastPhotonRadius, std::numeric_limits<float>::max()))
        ->group(group);
    verb.add_option("--caustic-radius", flags.caustic_radius, "the same of caustics (a quarter of --radius)")
        ->type_name("METRES")
        ->check(number_between(kLeastPhotonRadius, std::numeric_limits<float>::max()))
        ->group(group);
    verb.add_option("--nearest", flags.nearest,
                    "of photon_map: the N nearest photons count, within the radius\n(all within it)")
        ->type_name("N")
        ->check(whole_between(2, kMostNearestPhotons))
        ->group(group);
    verb.add_option("--photon-search", flags.search,
                    "of photon_map: how photons are found; the picture is the same\n(grid)")
        ->type_name("NAME")
        ->check(one_of(photon_search_names()))
        ->group(group);
}

PhotonMapSettings photon_map_settings(const PhotonFlags& flags, IntegratorKind integrator, const std::string& name) {
    for (const auto& [flag, is_given] :
         {std::pair("--photons", flags.photons > 0), std::pair("--gather", !flags.gather.empty()),
          std::pair("--radius", flags.radius > 0), std::pair("--caustic-radius", flags.caustic_radius > 0),
          std::pair("--nearest", flags.nearest > 0), std::pair("--photon-search", !flags.search.empty())}) {
        if (is_given && integrator != IntegratorKind::PhotonMap) {
            throw Error(ErrorCode::BadInput,
                        fmt::format("{}: of --integrator photon_map; {} has no photons", flag, name));
        }
    }
    PhotonMapSettings map;
    if (flags.photons > 0) map.photons = flags.photons;
    map.radius = flags.radius;
    map.caustic_radius = flags.caustic_radius;
    map.nearest = flags.nearest;
    if (!flags.gather.empty()) map.gather = *gather_named(flags.gather);
    if (!flags.search.empty()) map.search = *photon_search_named(flags.search);
    return map;
}

} // namespace pertev
