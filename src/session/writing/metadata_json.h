#pragma once

// How a picture's metadata read as JSON: texts and numbers as they are, and vectors, which an EXR holds as text, as
// arrays.

#include <string>

#include "image/exr_file.h"

namespace pertev {

/// The value of an entry ("pertev.eye": "0,1,2") as JSON ("[0,1,2]"). pertev.world_from_camera is an array of four
/// columns; pertev.environment is an array where it is a radiance.
std::string metadata_json(const ExrMetadata::value_type& entry);

} // namespace pertev
