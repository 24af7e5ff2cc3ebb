#include "formats/gltf/attached_bytes.h"

#include <optional>
#include <string>
#include <utility>

#include "base/read_file.h"
#include "formats/gltf/uri.h"

namespace pertev::gltf {

std::span<const std::byte> attached_bytes(const Document& document, Buffers& buffers, const FileAccess& access,
                                          const JsonValue& holder, std::vector<std::byte>& owned, Sink& sink) {
    if (const std::optional<JsonValue> view = holder.find("bufferView")) return buffers.view(*view).bytes;
    const JsonValue uri = holder.at("uri");
    const std::string_view text = uri.to_string();
    if (is_data_uri(text)) {
        std::optional<std::vector<std::byte>> data = decode_data_uri(text);
        if (!data) throw uri.error("the data URI cannot be decoded");
        owned = *std::move(data);
    } else {
        const std::optional<std::string> name = file_name_of_uri(text, document.path());
        const auto path = name ? access.find(uri.location(), *name, sink) : std::nullopt;
        if (!path) throw uri.error("there is no such file");
        owned = read_file(*path);
    }
    return owned;
}

} // namespace pertev::gltf
