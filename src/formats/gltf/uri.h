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
/// The bytes of "data:[type][;parameters][;base64],TEXT", TEXT percent-encoded where need be; nothing when it is
/// anything else.
std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri);
/// The path of a file with its percent encoding undone, as FileAccess::find takes it: a relative or absolute path, or
/// that of a file: URI ("C:/a.png" of "file:///C:/a.png"). A '%' that two hexadecimal digits do not follow stands for
/// itself. Returns nothing for a URI of another scheme (http:) or one that holds a NUL.
std::optional<std::string> decode_path_uri(std::string_view uri);

/// The path of a file: URI, as decode_path_uri gives it; any other name as it stands. Of formats whose names are no
/// URIs.
std::string plain_file_name(const std::string& name);

/// The name that FileAccess::find takes for the file that `uri`, which stands in `from`, means: decode_path_uri, or the
/// text as it stands where a file has that name alone. Nothing where decode_path_uri has nothing.
std::optional<std::string> file_name_of_uri(std::string_view uri, const std::filesystem::path& from);

} // namespace pertev::gltf
