#pragma once

// The two kinds of URI that glTF 2.0 allows (section 2.8): data, and a relative path.
//
// Source: RFC 2397 (data), RFC 3986 section 2.1 (percent encoding), RFC 4648 section 4 (base64).

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pertev::gltf {

bool is_data_uri(std::string_view uri);
/// The bytes of "data:[type][;parameters][;base64],TEXT", TEXT percent-encoded where need be; nothing when it is
/// anything else.
std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri);
/// A relative path with its percent encoding undone; nothing for a URI with a scheme (http:, file:), a '%' that two
/// hexadecimal digits do not follow, or a NUL.
std::optional<std::string> decode_path_uri(std::string_view uri);

} // namespace pertev::gltf
