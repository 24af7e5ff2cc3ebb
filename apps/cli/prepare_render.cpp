#include "apps/cli/prepare_render.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/message_text.h"
#include "session/render_memory.h"

namespace pertev {

void report_motion(const RenderFlags& flags, const MovingScene& moving, Messages& messages) {
    const bool has_time = flags.time_s || !flags.frames.empty();
    if (moving.is_animated() && !has_time) {
        const double end_s = moving.end_s();
        messages.note(fmt::format("{}: shown at rest; --time S shows it at a time of its {} (0 to {:.4g} s)",
                                  flags.scene.scene, counted(moving.scene().animations.size(), "animation"), end_s));
    }
    if (std::ranges::count(flags.aovs, "motion") > 0 && flags.frames.empty()) {
        messages.note("--aov motion: 0 without --frames, as there is no frame before");
    }
    const bool camera_moves = !flags.camera_path.empty() || flags.turntable > 0;
    if (!moving.is_animated() && has_time && !camera_moves && !flags.real_time) { // which gather light at rest
        messages.warn(fmt::format("--{}: nothing moves in this scene (--time-limit ends a render after a time)",
                                  flags.time_s ? "time" : "frames"));
    }
}

std::unique_ptr<RenderSetup> prepare_render(RenderFlags& flags, uint32_t verbs, Reporter& reporter) {
    return prepare_render(flags, verbs, reporter, [&](RenderSetup& ready) {
        const RenderSettings& settings = ready.settings;
        if (flags.limits_memory) { // a picture for which there is no room is refused before its scene is solved
            const std::size_t film =
                Film::predicted_bytes(settings.width, settings.height, settings.aovs, light_layers_of(settings));
            check_render_memory(film, settings,
                                memory_to_render_in(*ready.queue, settings, max_memory_bytes(flags.radiosity)));
        }
        return radiosity_display(flags.radiosity, ready.prepared(), settings.path.seed, reporter);
    });
}

} // namespace pertev
