#pragma once

// Reads the XML of Mitsuba 3 and 0.6 into objects: includes, defaults, references' names and transforms. Names of
// parameters become those of Mitsuba 3. libpugixml expands no entities of a document type, so that none can multiply.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/mitsuba/context.h"
#include "formats/mitsuba/objects.h"

namespace pertev::mitsuba {

/// The content of a file.
struct Document {
    Objects objects;
    bool is_old = false; // the file is one of Mitsuba 0.6
    uint64_t bytes = 0;  // size of all XML files
};

/// Reads a text as that of the file `path`. Unreadable and unknown elements are left out with a warning. Folders of
/// <path> are added to the context. Throws Error(OverLimit) if the files take more than the first justifies.
Document read_document(const std::filesystem::path& path, std::span<const std::byte> text, Context& context);

} // namespace pertev::mitsuba
