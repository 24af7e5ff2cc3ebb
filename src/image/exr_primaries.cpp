#include "image/exr_primaries.h"

#include <fmt/format.h>

#include "image/exr_reader.h"

namespace pertev {

std::optional<ColorMatrix> exr_color_matrix(std::span<const std::byte> bytes, const std::string& name,
                                            Messages* messages) {
    const ExrReader reader(bytes, name);
    if (!reader.has_primaries()) return std::nullopt;
    const std::optional<ColorPrimaries> primaries = reader.primaries();
    if (primaries && is_rec709(*primaries)) return std::nullopt;
    if (primaries) {
        if (std::optional<ColorMatrix> matrix = rec709_from(*primaries)) return matrix;
    }
    if (messages != nullptr) {
        messages->warn(
            fmt::format("{}: its chromaticities are no primaries of colours: left out, its colours are taken "
                        "as Rec. 709",
                        name));
    }
    return std::nullopt;
}

} // namespace pertev
