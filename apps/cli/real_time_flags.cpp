#include "apps/cli/real_time_flags.h"

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/flag_checks.h"

namespace pertev {
namespace {

constexpr const char* kGroup = "In real time";

} // namespace

void add_real_time_flags(CLI::App& verb, RenderFlags& flags) {
    verb.add_flag("--real-time", flags.real_time,
                  "frames as pertev view shows them while it moves: one sample a\npixel each, reconstructed with the "
                  "frames before (--spp is 1);\nthe flags below are of such frames alone")
        ->group(kGroup);
    add_reconstruction_flags(verb, flags.reconstruction, kGroup);
}

void note_real_time_flags(const CLI::App& verb, RenderFlags& flags) {
    if (flags.real_time && verb.count("--spp") == 0) flags.samples = 1;
    for (const CLI::Option* option : verb.get_options()) {
        if (option->get_group() == kGroup && option->count() > 0) flags.real_time_flag = option->get_name();
    }
}

void check_real_time_flags(const RenderFlags& flags) {
    refuse(!flags.real_time && !flags.real_time_flag.empty(),
           fmt::format("{}: of frames in real time; say --real-time", flags.real_time_flag));
    if (!flags.real_time) return;
    refuse(!frame_sequence(flags),
           "--real-time: a frame is made of those before it; say --frames A-B or --turntable N");
    refuse(flags.samples != 1, fmt::format("--spp {}: a frame of --real-time has one sample a pixel", flags.samples));
    RenderSettings settings;
    set_integrator(settings, flags.integrator);
    refuse(
        !makes_frames(settings.integrator),
        fmt::format("--real-time: frames are reconstructed of the samples of --integrator path, direct, indirect and "
                    "hybrid, not of {}'s",
                    flags.integrator));
    refuse(flags.denoise != name_of(Denoise::None),
           fmt::format("--denoise {}: frames of --real-time are reconstructed already; leave out one of them",
                       flags.denoise));
    refuse(flags.reconstruction.settings.orders_samples && flags.sampler == name_of(SamplerKind::Independent),
           "--sample-order: samples of --sampler independent have no order");
    refuse(flags.transparent, "--transparent: frames of --real-time have no alpha");
    refuse(!flags.shutter.empty(), "--shutter: a frame of --real-time is of one moment");
    refuse(!flags.light_paths.empty(), "--lpe: light paths are not told apart in frames of --real-time");
    refuse(flags.false_color == "illuminance",
           "--false-color illuminance: frames of --real-time have radiance alone; luminance shows that");
    refuse(std::ranges::find(flags.aovs, "motion") != flags.aovs.end(),
           "--aov motion: not with --real-time; --spp 1 --max-depth 0 without it writes the motion of the same frames");
}

} // namespace pertev
