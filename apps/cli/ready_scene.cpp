#include "apps/cli/ready_scene.h"

#include <algorithm>

#include <fmt/format.h>

#include "accel/bvh/bvh_cache.h"
#include "apps/cli/parse_values.h"
#include "base/error.h"
#include "base/message_text.h"
#include "base/stopwatch.h"

namespace pertev {
namespace {

/// --strict: throws Error(BadInput) that repeats the first warning of a texture or a file of materials that is missing.
void refuse_missing(const Messages& messages) {
    const std::vector<Message>& all = messages.all();
    const auto missing = static_cast<uint64_t>(std::ranges::count_if(all, &Message::is_missing));
    if (missing == 0) return;
    throw Error(ErrorCode::BadInput,
                fmt::format("--strict: {}{}; nothing is rendered",
                            std::ranges::find_if(all, &Message::is_missing)->text,
                            missing > 1 ? fmt::format(" (and {} like it)", counted(missing - 1, "warning")) : ""));
}

} // namespace

std::unique_ptr<ReadyScene> make_ready(RenderFlags& flags, Reporter& reporter) {
    Messages& messages = reporter.messages();
    ComingMachine machine(flags.machine, messages);
    std::optional<TracerChoice> tracers; // what does not fit the device is refused before the scene is read
    if (!flags.tracer.are_empty()) tracers = tracer_choice(flags.tracer, machine.is_cuda());
    reporter.say_messages();
    reporter.set_work(fmt::format("loading {}", flags.scene.scene));
    const Stopwatch watch;
    auto ready = std::make_unique<ReadyScene>();
    ready->scene = load_scene(flags.scene, messages);
    if (flags.strict) refuse_missing(messages);
    RenderSettings& settings = ready->settings;
    settings = render_settings(flags, ready->scene);
    settings.tracers = tracers;
    aim_eye(flags.scene, ready->scene, messages);
    ready->camera = choose_camera(flags.scene, ready->scene, aspect_of(settings.width, settings.height), messages);
    ready->load_s = watch.seconds();
    PrepareOptions prepare = prepare_options(settings, machine.is_cuda());
    prepare.may_be_better = may_be_better(flags.tracer);
    if (!flags.no_cache) prepare.bvh_cache = bvh_cache_folder();
    reporter.set_work("building trees");
    ready->prepared = prepare_scene(ready->scene, prepare, messages);
    ready->queue = machine.take();
    return ready;
}

PictureRecord picture_record(const SceneOptions& options, const ReadyScene& ready) {
    PictureRecord record = {.scene = source_of(open_options(options), ready.scene),
                            .camera = source_of(camera_choice(options), ready.camera),
                            .settings = ready.settings,
                            .device = ready.queue->device_name(),
                            .display = {}};
    record.scene.load_seconds = ready.load_s;
    record.scene.build_seconds = ready.prepared.build_seconds;
    return record;
}

} // namespace pertev
