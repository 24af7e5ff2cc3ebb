#include "apps/cli/irradiance_cache_flags.h"

#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "base/error.h"

namespace pertev {

void add_irradiance_cache_flags(CLI::App& verb, IrradianceCacheFlags& flags, const char* group) {
    verb.add_option(
            "--accuracy", flags.accuracy,
            "of irradiance_cache: how far records serve, in parts of the\ndistance to what surrounds them, from "
            "0.01 to 1; less is more\nexact (0.25)")
        ->type_name("A")
        ->check(number_between(kLeastAccuracy, kMostAccuracy))
        ->group(group);
    verb.add_option("--hemisphere-rays", flags.hemisphere_rays,
                    "of irradiance_cache: rays that a record's light is found by, at\nmost, from 16 to 65536 (768)")
        ->type_name("N")
        ->check(whole_between(kFewestHemisphereRays, kMostHemisphereRays))
        ->group(group);
    verb.add_flag("--show-records", flags.show_records, "of irradiance_cache: the picture shows where records are")
        ->group(group);
}

IrradianceCacheSettings irradiance_cache_settings(const IrradianceCacheFlags& flags, IntegratorKind integrator,
                                                  const std::string& name) {
    for (const auto& [flag, is_given] :
         {std::pair("--accuracy", flags.accuracy > 0), std::pair("--hemisphere-rays", flags.hemisphere_rays > 0),
          std::pair("--show-records", flags.show_records)}) {
        if (is_given && integrator != IntegratorKind::IrradianceCache) {
            throw Error(ErrorCode::BadInput,
                        fmt::format("{}: of --integrator irradiance_cache; {} has no records", flag, name));
        }
    }
    IrradianceCacheSettings cache;
    if (flags.accuracy > 0) cache.accuracy = flags.accuracy;
    if (flags.hemisphere_rays > 0) cache.hemisphere_rays = flags.hemisphere_rays;
    cache.show_records = flags.show_records;
    return cache;
}

} // namespace pertev
