#include "image/picture_primaries.h"

#include <fmt/format.h>

#include "image/decode_hdr.h"
#include "image/exr_reader.h"
#include "image/image_format.h"

namespace pertev {
namespace {

struct Found {
    bool is_given = false;
    std::optional<ColorPrimaries> primaries; // nothing also where they cannot be read
};

Found find_primaries(std::span<const std::byte> bytes, const std::string& name) {
    switch (recognise_image(bytes).value_or(ImageFormat::Png)) {
    case ImageFormat::Exr: {
        const ExrReader reader(bytes, name);
        return {reader.has_primaries(), reader.primaries()};
    }
    case ImageFormat::Hdr: {
        const std::optional<ColorPrimaries> primaries = read_hdr_primaries(bytes, name);
        return {primaries.has_value(), primaries};
    }
    case ImageFormat::Png:
    case ImageFormat::Jpeg:
        break;
    }
    return {};
}

} // namespace

std::optional<ColorMatrix> color_matrix_of(std::span<const std::byte> bytes, const std::string& name, Sink& sink) {
    const Found found = find_primaries(bytes, name);
    if (!found.is_given || (found.primaries && is_rec709(*found.primaries))) return std::nullopt;
    if (found.primaries) {
        if (std::optional<ColorMatrix> matrix = rec709_from(*found.primaries)) return matrix;
    }
    sink.leave_out(fmt::format(
        "{}: the chromaticities are not valid primaries and are left out; the colours are read as Rec. 709", name));
    return std::nullopt;
}

} // namespace pertev
