#pragma once

// Values in words: 1280x720, 1,2,3, names. What throws, throws Error(BadInput) that shows the form, or
// Error(OverLimit); its message begins with `what` the value is of and the text, or with the text alone where `what` is
// empty.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "math/double_vec3.h"
#include "math/rgb.h"

namespace pertev {

/// The finite number that `text` is from its first character to its last. One too near 0 for a float is 0.
std::optional<float> number_in(std::string_view text);

// Each says why the text is no such value; it is empty where it is one.
std::string why_no_number(const std::string& text, double low, double high); // from low to high
std::string why_not_above(const std::string& text, double low, double high); // above low, up to high
std::string why_not_whole(const std::string& text, uint32_t low, uint32_t high);
std::string why_no_choice(const std::string& text, const std::vector<std::string>& choices);

/// "1280x720": both in [1, kMaxImageSide], their product at most kMaxImagePixels.
std::pair<uint32_t, uint32_t> parse_size(const std::string& what, const std::string& text);
/// "-1.5": finite.
float parse_number(const std::string& what, const std::string& text);
/// "1,-2.5,3e1": finite.
Vec3 parse_vec3(const std::string& what, const std::string& text);
/// A place in the scene: as parse_vec3, each at most kMaxCoordinate away from 0.
DoubleVec3 parse_position(const std::string& what, const std::string& text);
/// The three numbers of "r,g,b", or false when `text` does not look like numbers.
bool parse_rgb(const std::string& text, Rgb& color);
/// "0.5", or "r,g,b": a radiance, finite and at least 0.
Rgb parse_radiance(const std::string& what, const std::string& text);

} // namespace pertev
