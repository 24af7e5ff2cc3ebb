#pragma once

// Parses values such as 1280x720, 1,2,3 and names. Functions that throw, throw Error(BadInput) whose reason shows the
// format, or Error(OverLimit), with the name of the `setting` and the text.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "math/double_vec3.h"
#include "math/rgb.h"

namespace pertev {

/// Parses the whole text as a finite number. A value too small for a float is 0.
std::optional<float> number_in(std::string_view text);
/// Parses numbers between commas, each within the range of floats.
std::optional<std::vector<double>> numbers_in(std::string_view text);

/// Returns the end of a range as messages and documents have it: whole numbers without an exponent.
std::string limit_text(double limit);

// Each returns why the text is no such value, without the text: "not a number from 0 to 1". Empty if it is one.
std::string why_no_number(const std::string& text, double low, double high); // from low to high
std::string why_not_above(const std::string& text, double low, double high); // above low, up to high
std::string why_not_whole(const std::string& text, uint32_t low, uint32_t high);
std::string why_no_choice(const std::string& text, const std::vector<std::string>& choices);

/// Parses "1280x720": both in [1, kMaxImageSide], their product at most kMaxImagePixels.
std::pair<uint32_t, uint32_t> parse_size(const std::string& setting, const std::string& text);
/// Parses a finite number such as "-1.5".
float parse_number(const std::string& setting, const std::string& text);
/// Parses three finite numbers such as "1,-2.5,3e1".
Vec3 parse_vec3(const std::string& setting, const std::string& text);
/// Parses a position in the scene: three numbers of size at most kMaxCoordinate.
DoubleVec3 parse_position(const std::string& setting, const std::string& text);
/// Parses the three numbers of "r,g,b". Returns false if `text` does not look like numbers.
bool parse_rgb(const std::string& text, Rgb& color);
/// Parses a radiance, "0.5" or "r,g,b", finite and at least 0.
Rgb parse_radiance(const std::string& setting, const std::string& text);

} // namespace pertev
