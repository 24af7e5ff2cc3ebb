#pragma once

// The two kinds of URI that glTF 2.0 allows (section 2.8), data and a relative path, and what exporters write in place
// of the latter: absolute paths, of this system or another, and file: URIs.
//
// Source: RFC 2397 (data), RFC 3986 section 2.1 (percent encoding), RFC 4648 section 4 (base64).

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pertev::gltf {

bool is_data_uri(std::string_view uri);
/// Decodes "data:[type][;parameters][;base64],TEXT", where TEXT may be percent-encoded; nothing for anything else.
std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri);
/// Decodes a percent-encoded path for FileAccess::find: a relative or absolute path, or that of a file: URI
/// ("C:/a.png" for "file:///C:/a.png"). A '%' without two hexadecimal digits after it stands for itself. Returns
/// nothing for a URI with another scheme (http:) or with a NUL.
std::optional<std::string> decode_path_uri(std::string_view uri);

/// The path of a file: URI, decoded by decode_path_uri; any other name unchanged. For formats whose names are not
/// URIs.
std::string plain_file_name(const std::string& name);

/// The name for FileAccess::find of the file that `uri`, found in `from`, refers to: decode_path_uri, or the
/// undecoded text if only a file with that name exists. Nothing if decode_path_uri returns nothing.
std::optional<std::string> file_name_of_uri(std::string_view uri, const std::filesystem::path& from);

} // namespace pertev::gltf
