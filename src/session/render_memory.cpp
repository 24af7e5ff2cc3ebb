#include "session/render_memory.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/machine_memory.h"
#include "base/message_text.h"
#include "session/picture_renderer.h"

namespace pertev {
namespace {

/// Bytes of the finished picture and its layers.
std::size_t result_bytes(const RenderSettings& settings) {
    const std::size_t channels = film_channel_count(settings.aovs) + 3 * light_layers_of(settings).size() +
                                 sample_layer_channels(settings.sample_layers);
    return std::size_t{settings.window().count()} * channels * sizeof(float);
}

/// Amount in MiB, with enough digits to distinguish it from 0 and from `other`.
std::string amount(std::size_t bytes, std::size_t other = 0) {
    std::string text;
    for (int digits = 1; digits <= 7; ++digits) { // 2^-20 MiB is a byte
        const auto write = [&](std::size_t b) { return fmt::format("{:.{}f}", mebibytes(b), digits); };
        text = write(bytes);
        if (bytes == other || (text != write(other) && text != write(0))) break;
    }
    return text + " MiB";
}

std::string limit_text(std::size_t bytes, const RenderSettings& settings, const MemoryLimit& limit) {
    if (limit.is_requested) return fmt::format("the setting allows {}", amount(limit.bytes, bytes));
    return fmt::format("{} has {}, and the finished picture takes {}",
                       is_memory_of_group() ? "this container or service" : "this machine",
                       amount(machine_memory_bytes(), bytes), amount(result_bytes(settings)));
}

/// Names what dominates the memory, and the settings that reduce it.
std::string advice(const RenderSettings& settings, bool is_cuda, uint64_t textures) {
    const std::vector<std::string> layer_names = light_layers_of(settings);
    const std::size_t layers = layer_names.size();
    const PixelWindow window = settings.window();
    const std::size_t film = predicted_film_bytes(settings);
    const WorkSize size = {
        .width = settings.width, .height = settings.height, .samples = settings.samples, .traverses_on_host = !is_cuda};
    const std::size_t own = predicted_bytes(settings, size, is_cuda);
    if (textures > std::max(own, film)) {
        return fmt::format("the textures take {}; a smaller `max_texture_size` takes less", amount(textures));
    }
    if (const auto memory = describe(settings.integrator).memory; memory != nullptr && own > film) {
        const auto [what, less] = memory(settings, size);
        return fmt::format("{} take {}; {} takes less", what, amount(own), less);
    }
    return fmt::format("the film of {}x{} pixels{} takes {}: {} smaller `{}`{} takes less", window.width, window.height,
                       layers > 0 ? " and " + counted(layers, "layer") + " of `lpe`" : "", amount(film),
                       layers > 0 ? "fewer of them or a" : "a", settings.crop ? "crop" : "size",
                       settings.aovs != 0 ? ", or fewer `aov`," : "");
}

} // namespace

MemoryLimit memory_to_render_in(const Queue& queue, const RenderSettings& settings,
                                std::optional<std::size_t> requested) {
    if (requested) return {*requested, true, queue.is_cuda()};
    if (queue.is_cuda()) return {SIZE_MAX, false, true};
    const std::size_t all = machine_memory_bytes(), result = result_bytes(settings);
    return {all > result ? all - result : 0, false, false};
}

void check_render_memory(std::size_t bytes, const RenderSettings& settings, const MemoryLimit& limit,
                         uint64_t textures) {
    if (bytes <= limit.bytes) return;
    throw Error(ErrorCode::OutOfMemory, limit.is_requested ? "max_memory" : "", "",
                fmt::format("the render takes {} of {}memory; {}. {}", amount(bytes, limit.bytes),
                            limit.is_cuda ? "the GPU's " : "", limit_text(bytes, settings, limit),
                            advice(settings, limit.is_cuda, textures)));
}

} // namespace pertev
