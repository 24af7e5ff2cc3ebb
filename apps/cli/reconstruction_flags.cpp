#include "apps/cli/reconstruction_flags.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "session/settings_text.h"

namespace pertev {

void add_reconstruction_flags(CLI::App& verb, ReconstructionFlags& flags, const std::string& group) {
    flags.restir = name_of(flags.sharing.light);
    verb.add_flag("--no-reconstruction", flags.none, "show the samples as they are")->group(group);
    verb.add_flag("--no-firefly-limit", flags.no_firefly_limit, "samples stay as bright as they are")->group(group);
    verb.add_flag("--no-history-limit", flags.no_history_limit, "means are not held within what recent frames say")
        ->group(group);
    verb.add_flag("--no-follow-light", flags.no_follow_light,
                  "where the scene moves: means are not changed as light has")
        ->group(group);
    verb.add_flag("--no-anti-alias", flags.no_anti_alias, "no mean of shown pictures over time")->group(group);
    verb.add_option("--history", flags.settings.history, "frames of a mean at most")
        ->type_name("N")
        ->check(whole_between(1, 1024))
        ->capture_default_str()
        ->group(group);
    verb.add_option("--passes", flags.settings.passes, "of the wavelet filter")
        ->type_name("N")
        ->check(whole_between(0, 8))
        ->capture_default_str()
        ->group(group);
    verb.add_option("--restir", flags.restir,
                    "light that pixels share: off, di (what lights send to the\nfirst surface), gi (what its "
                    "surroundings send there, too)")
        ->type_name("NAME")
        ->check(one_of(restir_names()))
        ->capture_default_str()
        ->group(group);
    verb.add_option("--restir-history", flags.sharing.history, "frames that it takes from the ones before for at most")
        ->type_name("N")
        ->check(whole_between(0, 1024))
        ->capture_default_str()
        ->group(group);
    verb.add_option("--resolution-scale", flags.settings.resolution_scale,
                    "find light at a lower resolution, by this factor of each side;\nedges and textures stay")
        ->type_name("X")
        ->check(number_between(0.1f, 1.0f))
        ->capture_default_str()
        ->group(group);
    verb.add_flag("--sample-order", flags.settings.orders_samples,
                  "draw samples so that errors are blue noise over the picture and\nover time")
        ->group(group);
}

ReconstructionSettings reconstruction_settings(const ReconstructionFlags& flags) {
    if (flags.none) return of_samples_alone(flags.settings);
    ReconstructionSettings settings = flags.settings;
    settings.limit_fireflies = !flags.no_firefly_limit;
    settings.limit_history = !flags.no_history_limit;
    settings.follow_light = !flags.no_follow_light;
    settings.anti_alias = !flags.no_anti_alias;
    return settings;
}

RestirSettings restir_settings(const ReconstructionFlags& flags) {
    RestirSettings settings = flags.sharing;
    settings.light = restir_named(flags.restir).value();
    refuse(
        flags.settings.orders_samples && settings.light != RestirLight::Off,
        fmt::format("--sample-order: nothing orders samples that pixels share, as --restir {} has them; leave out one "
                    "of them",
                    flags.restir));
    return settings;
}

bool ask_for_frames(const ReconstructionFlags& flags) {
    return flags.restir != name_of(RestirLight::Off) || flags.settings.resolution_scale != 1 ||
           flags.settings.orders_samples;
}

std::string json_of(const ReconstructionFlags& flags) {
    return json_of(reconstruction_settings(flags), restir_settings(flags));
}

} // namespace pertev
