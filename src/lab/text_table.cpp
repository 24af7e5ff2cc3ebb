#include "lab/text_table.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace pertev {
namespace {

std::size_t characters(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

/// Of its power of ten, once it is rounded to so many digits: -3 of 0.00996 in two.
int exponent_of(double value, int digits) {
    const std::string text = fmt::format("{:.{}e}", value, digits - 1);
    return std::stoi(text.substr(text.find('e') + 1));
}

} // namespace

std::string align_columns(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], characters(row[i]));
    }
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string pad(widths[i] - characters(row[i]), ' ');
            line += i == 0 ? row[i] + pad : "  " + pad + row[i];
        }
        line.erase(line.find_last_not_of(' ') + 1); // npos + 1 is 0: a line of blanks is empty
        text += line + '\n';
    }
    return text;
}

std::string fixed_text(double value, int decimals) {
    double least = 10;
    for (int i = 0; i < decimals; ++i) least /= 10;
    const bool is_lost = value != 0 && std::abs(value) < least;
    return is_lost ? fmt::format("{:.2g}", value) : fmt::format("{:.{}f}", value, decimals);
}

std::string uncertain_text(double value, double uncertainty) {
    constexpr double rounding = 1e-9; // of the value: what sums of equal values are rounded by is less
    if (uncertainty <= rounding * std::abs(value)) return fmt::format("{:.3g} ± 0", value);
    const int last = exponent_of(uncertainty, 2) - 1; // power of ten of the last digit that is shown
    constexpr int most_decimals = 6;
    if (last >= 0) {
        double unit = 1;
        for (int i = 0; i < last; ++i) unit *= 10;
        return fmt::format("{:.0f} ± {:.0f}", unit * std::round(value / unit), unit * std::round(uncertainty / unit));
    }
    if (last >= -most_decimals) return fmt::format("{:.{}f} ± {:.{}f}", value, -last, uncertainty, -last);
    const int digits = std::max(0, (value != 0 ? exponent_of(value, 3) : last) - last);
    return fmt::format("{:.{}e} ± {:.1e}", value, digits, uncertainty);
}

} // namespace pertev
