#include "session/render_memory.h"

#include <fmt/format.h>

#include "base/byte_units.h"
#include "base/error.h"
#include "base/machine_memory.h"

namespace pertev {

std::size_t memory_to_render_in(const Queue& queue, const RenderSettings& settings, std::optional<std::size_t> asked) {
    if (asked) return *asked;
    if (queue.is_cuda()) return SIZE_MAX;
    const std::size_t channels = film_channel_count(settings.aovs) + std::size_t(3) * light_layers_of(settings);
    const std::size_t result = std::size_t(settings.width) * settings.height * channels * sizeof(float);
    const std::size_t all = machine_memory_bytes();
    return all > result ? all - result : 0;
}

void check_render_memory(std::size_t bytes, const RenderSettings& settings, std::size_t limit) {
    if (bytes <= limit) return;
    const uint32_t layers = light_layers_of(settings);
    const std::size_t film = Film::predicted_bytes(settings.width, settings.height, settings.aovs, layers);
    throw Error(
        ErrorCode::OutOfMemory,
        fmt::format("the render takes {:.1f} MiB of the device's memory; {:.1f} MiB are what --max-memory allows, or "
                    "without it what this machine has beside the finished picture. {}x{} pixels{} take {:.1f} MiB in "
                    "a film: {} smaller --size{} takes less",
                    mebibytes(bytes), mebibytes(limit), settings.width, settings.height,
                    layers > 0 ? fmt::format(" and {} layers of --lpe", layers) : "", mebibytes(film),
                    layers > 0 ? "fewer of them or a" : "a", settings.aovs != 0 ? ", or fewer --aov," : ""));
}

} // namespace pertev
