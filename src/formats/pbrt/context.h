#pragma once

// The services that all parts of this reader share.

#include <string>

#include "base/sink.h"
#include "formats/files/file_access.h"
#include "formats/files/load_textures.h"
#include "formats/files/read_options.h"

namespace pertev::described {}

namespace pertev::pbrt {

using namespace described; // parts that it shares with the reader of Mitsuba's scenes

struct Context {
    const FileAccess& access;
    const ReadOptions& options;
    TextureLoader& loader;
    Sink& sink;
    std::string file;          // path of the scene, to whose folder the names of all its files are relative
    bool is_version_3 = false; // the file ends with WorldEnd, which pbrt-v4 does not have
};

/// Returns the location from which the file `name`, written at `from`, is found: the scene's file, as pbrt does it, or
/// `from` if there is no such file, as users of included files expect.
FileLocation base_of(const Context& context, const FileLocation& from, const std::string& name);

} // namespace pertev::pbrt
