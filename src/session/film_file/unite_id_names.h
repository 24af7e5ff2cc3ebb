#pragma once

// Names of ids in the metadata of parts: each part names the instances and materials of its own pixels.

#include "image/exr_file.h"

namespace pertev {

/// Adds the names of ids in the metadata `from` to those in `to`, as id_metadata() makes them for all pixels. Throws
/// Error(BadInput) if an entry has another form.
void unite_id_names(const ExrMetadata& from, ExrMetadata& to);

} // namespace pertev
