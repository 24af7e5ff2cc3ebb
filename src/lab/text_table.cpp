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
        line.erase(line.find_last_not_of(' ') + 1); // npos + 1 is 0, so a line of blanks becomes empty
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

} // namespace pertev
