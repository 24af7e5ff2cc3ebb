#pragma once

// Converts a picture's metadata to JSON: texts and numbers as they are, and vectors, which an EXR stores as text, as
// arrays.

#include <string>

#include "image/exr_file.h"

namespace pertev {

/// Converts the value of an entry ("pertev.eye": "0,1,2") to JSON ("[0,1,2]"). pertev.world_from_camera is an array
/// of four columns; pertev.environment is an array if it is a radiance.
std::string metadata_json(const ExrMetadata::value_type& entry);

} // namespace pertev
