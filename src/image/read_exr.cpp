#include "image/read_exr.h"

#include "base/error.h"
#include "base/read_file.h"
#include "image/exr_reader.h"
#include "image/image_format.h"

namespace pertev {

ExrFile read_exr(std::span<const std::byte> bytes, const std::string& name) {
    if (recognise_image(bytes) != ImageFormat::Exr)
        throw Error(ErrorCode::BadInput, FileLocation{name}, "not an OpenEXR file (wrong first bytes)");
    ExrReader reader(bytes, name);
    ExrFile file{reader.width(), reader.height(), {}, reader.metadata()};
    for (std::size_t part = 0; part < reader.part_count(); ++part) {
        const std::string prefix = reader.part_count() > 1 ? reader.part_name(part) + "." : "";
        for (ExrChannel& channel : reader.read(part, reader.channels(part), false)) {
            channel.name = prefix + channel.name;
            file.channels.push_back(std::move(channel));
        }
    }
    return file;
}

ExrFile read_exr(const std::filesystem::path& path) { return read_exr(read_file(path), path.string()); }

} // namespace pertev
