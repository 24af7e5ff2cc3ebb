#pragma once

// Values as they stand on the command line: 1280x720, 1,2,3, names. Each throws Error(BadInput) that shows the form.

#include <cstdint>
#include <string>
#include <utility>

#include "math/rgb.h"
#include "math/vec3.h"

namespace pertev {

/// "1280x720": both in [1, kMaxImageSide].
std::pair<uint32_t, uint32_t> parse_size(const std::string& flag, const std::string& text);
/// "-1.5": finite.
float parse_number(const std::string& flag, const std::string& text);
/// "1,-2.5,3e1": finite.
Vec3 parse_vec3(const std::string& flag, const std::string& text);
/// The three numbers of "r,g,b", or false when `text` does not look like numbers.
bool parse_rgb(const std::string& text, Rgb& color);

} // namespace pertev
