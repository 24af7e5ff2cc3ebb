#include "image/cube_lut.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/read_file.h"
#include "math/scalar.h"

namespace pertev {
namespace {

constexpr std::string_view kBlanks = " \t\r";

/// Removes and returns the first word of a line; empty at its end.
std::string_view take_word(std::string_view& line) {
    line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
    line.remove_prefix(word.size());
    return word;
}

std::optional<float> number_of(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    float value = 0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (fault != std::errc() || end != word.data() + word.size() || !is_finite(value)) return std::nullopt;
    return value;
}

/// Reads the lines of a file.
struct Lines {
    std::string_view text;
    std::string name;
    std::size_t number = 0; // the line that was read last

    bool next(std::string_view& line) {
        if (text.empty()) return false;
        ++number;
        const std::size_t end = text.find('\n');
        line = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        return true;
    }
    [[noreturn]] void fail(const std::string& why) const {
        throw Error(ErrorCode::BadInput, FileLocation{name, number}, why);
    }
    /// Reads the three numbers of the rest of a line.
    Rgb color(std::string_view rest) const {
        const auto r = number_of(take_word(rest)), g = number_of(take_word(rest)), b = number_of(take_word(rest));
        if (!r || !g || !b || !take_word(rest).empty()) fail("expected three numbers");
        return {*r, *g, *b};
    }
};

} // namespace

CubeLut CubeLut::parse(std::span<const std::byte> bytes, const std::string& name) {
    Lines lines = {{reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name};
    CubeLut lut;
    std::size_t count = 0; // lines of the table
    for (std::string_view line; lines.next(line);) {
        std::string_view rest = line;
        const std::string_view word = take_word(rest);
        if (word.empty() || word.starts_with('#') || word == "TITLE") continue;
        if (word == "LUT_1D_SIZE") lines.fail("a table of one dimension; a LUT with LUT_3D_SIZE is needed");
        if (word == "LUT_3D_SIZE") {
            const auto side = number_of(take_word(rest));
            if (!side || *side < 2 || *side > float(kMaxLutSide) || *side != floor(*side) || lut.side_ != 0)
                lines.fail(fmt::format("expected one LUT_3D_SIZE from 2 to {}", kMaxLutSide));
            lut.side_ = static_cast<uint32_t>(*side);
            count = static_cast<std::size_t>(lut.side_) * lut.side_ * lut.side_;
        } else if (word == "DOMAIN_MIN") {
            lut.low_ = lines.color(rest);
        } else if (word == "DOMAIN_MAX") {
            lut.high_ = lines.color(rest);
        } else if (number_of(word)) {
            if (count == 0) lines.fail("LUT_3D_SIZE must precede the table");
            if (lut.table_.size() == count) lines.fail(fmt::format("the table has more than {} lines", count));
            lut.table_.push_back(lines.color(line));
        } else {
            lines.fail(fmt::format("unknown keyword {}", std::string(word.substr(0, 40))));
        }
    }
    if (count == 0) lines.fail("the file has no LUT_3D_SIZE");
    if (lut.table_.size() != count)
        lines.fail(fmt::format("the table has {} of {} lines; the file is cut off", lut.table_.size(), count));
    if (!(lut.low_.r < lut.high_.r && lut.low_.g < lut.high_.g && lut.low_.b < lut.high_.b))
        lines.fail("DOMAIN_MIN must be less than DOMAIN_MAX");
    return lut;
}

CubeLut CubeLut::read(const std::filesystem::path& path) { return parse(read_file(path), path.string()); }

Rgb CubeLut::operator()(Rgb color) const {
    const auto most = static_cast<float>(side_ - 1);
    uint32_t cell[3]; // the corner below
    float share[3];   // share of the cell, from that corner
    const float values[3] = {color.r, color.g, color.b}, low[3] = {low_.r, low_.g, low_.b},
                high[3] = {high_.r, high_.g, high_.b};
    for (int c = 0; c < 3; ++c) {
        const float x = (values[c] - low[c]) / (high[c] - low[c]) * most;
        const float inside = x > 0 ? min(x, most) : 0.0f; // NaN is 0
        cell[c] = static_cast<uint32_t>(to_int(inside, 0, static_cast<int>(side_) - 2));
        share[c] = inside - static_cast<float>(cell[c]);
    }
    // The path from the lowest to the highest corner along the axes, the largest share first, has the corners of the
    // tetrahedron.
    int order[3] = {0, 1, 2};
    std::stable_sort(order, order + 3, [&](int a, int b) { return share[a] > share[b]; });
    uint32_t corner[3] = {cell[0], cell[1], cell[2]};
    Rgb sum = (1.0f - share[order[0]]) * at(corner[0], corner[1], corner[2]);
    for (int i = 0; i < 3; ++i) {
        ++corner[order[i]];
        const float weight = share[order[i]] - (i < 2 ? share[order[i + 1]] : 0.0f);
        sum = sum + weight * at(corner[0], corner[1], corner[2]);
    }
    return sum;
}

} // namespace pertev
