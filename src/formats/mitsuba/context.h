#pragma once

// The services that all parts of this reader share.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/sink.h"
#include "formats/files/file_access.h"
#include "formats/files/load_textures.h"
#include "formats/files/read_options.h"

namespace pertev::mitsuba {

struct Context {
    const FileAccess& access;
    const ReadOptions& options;
    TextureLoader& loader;
    Sink& sink;
    std::string file;                                                    // path of the scene
    std::vector<std::pair<FileLocation, std::string>> search_paths = {}; // folders that <path> names, and where
    bool is_old = false;                                                 // the file is one of Mitsuba 0.6
};

/// A name of a file, as if it were written at `from`.
struct FoundName {
    FileLocation from;
    std::string reference;
};

/// Returns where the file `name` of an element at `from` is: in the scene's folder, one of <path>, or that of `from`,
/// in this order, as Mitsuba searches. Throws Error(BadInput) if only a folder that may not be read could have it.
FoundName locate(const Context& context, const FileLocation& from, const std::string& name);

/// Returns the path of a file for reading; nothing, with a warning, if there is none. Throws as locate().
std::optional<std::filesystem::path> find_file(const Context& context, const FileLocation& from,
                                               const std::string& name);

} // namespace pertev::mitsuba
