#include "session/camera_batch.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "render/film_channels.h"
#include "render/sample_layers/sample_layers.h"
#include "session/check_integrator.h"
#include "session/picture_renderer.h"

namespace pertev {
namespace {

void refuse(bool is_wrong, const char* setting, std::string value, const char* why) {
    if (is_wrong) throw Error(ErrorCode::BadInput, setting, std::move(value), why);
}

} // namespace

void check_batch(const CameraBatch& batch, const RenderSettings& settings) {
    refuse(batch.cameras.empty(), "cameras", "", "a batch needs at least one camera");
    refuse(batch.seeds.size() > 1 && batch.seeds.size() != batch.cameras.size(), "seeds",
           fmt::format("{}", batch.seeds.size()), "expected one seed, or one for each camera");
    refuse(settings.is_denoised() && settings.samples == 0, "denoise", "",
           "without samples there is no picture to denoise");
    refuse(settings.light_paths != nullptr, "lpe", "", "batches of pictures have no layers of light paths");
    refuse(settings.irradiance, "false_color", "illuminance", "batches of pictures show radiance");
    refuse((settings.aovs & kAovMotion) != 0, "aov", "motion", "pictures of a batch have no earlier frame");
    if (settings.sample_layers != 0) {
        const std::vector<std::string> names = aov_names(~static_cast<uint32_t>(kAovMotion));
        throw Error(ErrorCode::BadInput, "aov", sample_layer_names(settings.sample_layers).front(),
                    fmt::format("batches of pictures have only {}", fmt::join(names, ", ")));
    }
    refuse(settings.crop.has_value(), "crop", "", "batches of pictures are whole; crop their arrays");
    refuse(settings.time_limit_s > 0, "time_limit", "", "pictures of a batch would end at different samples");
    refuse(settings.samples == 0 && !has_centres(settings), "spp", "0",
           "without samples there are only layers at centres");
    for (const Camera& camera : batch.cameras) {
        check_camera(settings, camera);
        refuse(is_light_meter(camera.projection), "cameras", camera.name, "a light meter shows no picture");
    }
}

bool is_one_job(const RenderSettings& settings) {
    return settings.samples == 0 || (!settings.is_denoised() && describe(settings.integrator).renders_batches);
}

void BatchArrays::fit(Queue& queue, const RenderSettings& settings, uint32_t count) {
    const std::size_t pixels = std::size_t(settings.width) * settings.height * count;
    if (settings.samples > 0) color.grow(queue, pixels * (settings.transparent ? 4 : 3), "pictures of a batch");
    if (settings.is_denoised()) noisy.grow(queue, color.size(), "pictures of a batch");
    if ((settings.aovs & kAovIds) != 0) ids.grow(queue, pixels, "ids of a batch");
    std::size_t number = 0;
    for (const AovGroup& group : kAovTable) {
        if ((settings.aovs & group.bit) == 0 || !group.is_summed) continue;
        if (number == layers.size()) layers.emplace_back();
        Layer& layer = layers[number++];
        layer.group = group.bit;
        layer.channels = static_cast<uint32_t>(channel_names(group).size());
        layer.values.grow(queue, pixels * layer.channels, "layers of a batch");
    }
    layers.resize(number);
}

BatchMemory::BatchMemory(Queue& queue, const CameraBatch& batch, const RenderSettings& settings, uint32_t at_once) {
    if (!is_one_job(settings)) return;
    std::size_t keys = 0;
    for (const Camera& camera : batch.cameras) keys = std::max(keys, camera.motion.size());
    cameras = {queue, at_once, "cameras"};
    seeds = {queue, at_once, "cameras"};
    if (keys > 0) motions = {queue, keys * at_once, "cameras"};
    if (settings.samples == 0) return;
    const uint32_t aovs = has_centres(settings) ? 0 : settings.aovs; // layers at centres go straight to the arrays
    film.emplace(queue, settings.width, settings.height * at_once, aovs);
}

MemoryLimit batch_memory(const Queue& queue, const RenderSettings& settings, std::optional<std::size_t> requested) {
    MemoryLimit limit = memory_to_render_in(queue, settings, requested);
    if (queue.is_cuda() && !requested) limit.bytes = queue.free_bytes() + queue.allocated_bytes();
    return limit;
}

uint32_t pictures_at_once(const PreparedScene& scene, const CameraBatch& batch, const RenderSettings& settings,
                          std::size_t limit, bool on_cuda) {
    const uint64_t pixels = uint64_t(settings.width) * settings.height, wanted = on_cuda ? 1u << 23 : 1u << 17;
    auto count = static_cast<uint32_t>(std::clamp<uint64_t>(wanted / pixels, 1, batch.count()));
    while (count > 1 && predicted_batch_bytes(scene, batch, settings, count, on_cuda) > limit) count = (count + 1) / 2;
    return count;
}

} // namespace pertev
