#include "formats/mitsuba/parse_values.h"

#include <charconv>
#include <cmath>

#include "formats/files/parse_number.h"
#include "image/srgb.h"

namespace pertev::mitsuba {

std::vector<double> parse_numbers(std::string_view text) {
    constexpr std::string_view kBetween = " \t\r\n,";
    std::vector<double> numbers;
    while (true) {
        const std::size_t begin = text.find_first_not_of(kBetween);
        if (begin == std::string_view::npos) return numbers;
        text.remove_prefix(begin);
        const auto number = parse_float<double>(text);
        if (!number || (!text.empty() && kBetween.find(text[0]) == std::string_view::npos)) return {};
        numbers.push_back(*number);
    }
}

std::vector<double> parse_color(std::string_view text, bool is_encoded) {
    std::vector<double> numbers;
    if (text.size() == 7 && text[0] == '#') {
        unsigned all = 0;
        const auto read = std::from_chars(text.data() + 1, text.data() + 7, all, 16);
        if (read.ec != std::errc() || read.ptr != text.data() + 7) return {};
        for (const unsigned shift : {16u, 8u, 0u}) numbers.push_back((all >> shift & 255) / 255.0);
        is_encoded = true;
    } else {
        numbers = parse_numbers(text);
        if (numbers.size() == 1) numbers = {numbers[0], numbers[0], numbers[0]};
    }
    for (double& number : numbers) {
        if (!std::isfinite(number)) return {};
        if (is_encoded) number = static_cast<double>(srgb_decode(static_cast<float>(number)));
    }
    return numbers;
}

} // namespace pertev::mitsuba
