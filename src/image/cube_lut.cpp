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

/// A place between two points of an axis.
struct GridPoint {
    uint32_t cell; // the point below
    float share;   // the part of the way to the next
};

/// Returns the place of a value among `count` points, at least two, that divide [low, high] evenly.
GridPoint grid_point_of(float value, float low, float high, uint32_t count) {
    const auto most = static_cast<float>(count - 1);
    const float x = (value - low) / (high - low) * most;
    const float inside = x > 0 ? min(x, most) : 0.0f; // NaN is 0
    const auto cell = static_cast<uint32_t>(to_int(inside, 0, static_cast<int>(count) - 2));
    return {cell, inside - static_cast<float>(cell)};
}

} // namespace

/// Reads the lines of a file.
struct CubeLut::Lines {
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

/// Reads a file into a table.
struct CubeLut::Reading {
    CubeLut& lut;
    Lines& lines;
    std::size_t points = 0, entries = 0; // lines of the curves and of the table
    bool has_domain = false;

    bool has_size() const { return points + entries > 0; }

    uint32_t size(std::string_view word, std::string_view rest, uint32_t most, std::size_t known) const {
        const auto value = number_of(take_word(rest));
        if (!value || *value < 2 || *value > float(most) || *value != floor(*value) || known != 0)
            lines.fail(fmt::format("expected one {} from 2 to {}", std::string(word), most));
        if (!lut.curves_.empty() || !lut.table_.empty())
            lines.fail(fmt::format("{} must precede the table", std::string(word)));
        return static_cast<uint32_t>(*value);
    }

    Domain range(std::string_view rest) const {
        const auto low = number_of(take_word(rest)), high = number_of(take_word(rest));
        if (!low || !high || !take_word(rest).empty()) lines.fail("expected two numbers");
        return {grey(*low), grey(*high)};
    }

    void entry(std::string_view line) {
        if (!has_size()) lines.fail("LUT_3D_SIZE or LUT_1D_SIZE must precede the table");
        std::vector<Rgb>& to = lut.curves_.size() < points ? lut.curves_ : lut.table_;
        if (lut.curves_.size() + lut.table_.size() == points + entries)
            lines.fail(fmt::format("the table has more than {} lines", points + entries));
        to.push_back(lines.color(line));
    }

    void take(std::string_view word, std::string_view rest, std::string_view line) {
        if (word == "LUT_1D_SIZE") {
            points = size(word, rest, kMaxLutCurve, points);
        } else if (word == "LUT_3D_SIZE") {
            lut.side_ = size(word, rest, kMaxLutSide, entries);
            entries = static_cast<std::size_t>(lut.side_) * lut.side_ * lut.side_;
        } else if (word == "LUT_1D_INPUT_RANGE") {
            lut.curve_domain_ = range(rest);
        } else if (word == "LUT_3D_INPUT_RANGE") {
            lut.domain_ = range(rest);
        } else if (word == "DOMAIN_MIN" || word == "DOMAIN_MAX") {
            const Rgb bound = lines.color(rest);
            for (Domain* domain : {&lut.curve_domain_, &lut.domain_})
                (word == "DOMAIN_MIN" ? domain->low : domain->high) = bound;
            has_domain = true;
        } else if (number_of(word)) {
            entry(line);
        } else {
            lines.fail(fmt::format("unknown keyword {}", std::string(word.substr(0, 40))));
        }
    }

    void end() const {
        if (!has_size()) lines.fail("the file has neither LUT_3D_SIZE nor LUT_1D_SIZE");
        if (const std::size_t count = lut.curves_.size() + lut.table_.size(); count != points + entries)
            lines.fail(fmt::format("the table has {} of {} lines; the file is cut off", count, points + entries));
        if (has_domain && points > 0 && entries > 0)
            lines.fail(
                "DOMAIN_MIN and DOMAIN_MAX are those of one table; curves before a table have LUT_1D_INPUT_RANGE "
                "and LUT_3D_INPUT_RANGE");
        if (!lut.domain_.is_valid() || !lut.curve_domain_.is_valid())
            lines.fail("the domain is empty: DOMAIN_MIN must be less than DOMAIN_MAX, and a range must ascend");
    }
};

CubeLut CubeLut::parse(std::span<const std::byte> bytes, const std::string& name) {
    Lines lines = {{reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name};
    CubeLut lut;
    Reading reading{lut, lines};
    for (std::string_view line; lines.next(line);) {
        std::string_view rest = line;
        const std::string_view word = take_word(rest);
        if (!word.empty() && !word.starts_with('#') && word != "TITLE") reading.take(word, rest, line);
    }
    reading.end();
    return lut;
}

CubeLut CubeLut::read(const std::filesystem::path& path) { return parse(read_file(path), path.string()); }

Rgb CubeLut::operator()(Rgb color) const {
    if (!curves_.empty()) color = on_curves(color);
    return side_ == 0 ? color : in_table(color);
}

Rgb CubeLut::on_curves(Rgb color) const {
    const auto count = static_cast<uint32_t>(curves_.size());
    const auto on = [&](float value, float low, float high, float Rgb::*channel) {
        const GridPoint at = grid_point_of(value, low, high, count);
        return lerp(curves_[at.cell].*channel, curves_[at.cell + 1].*channel, at.share);
    };
    const auto& [low, high] = curve_domain_;
    return {on(color.r, low.r, high.r, &Rgb::r), on(color.g, low.g, high.g, &Rgb::g),
            on(color.b, low.b, high.b, &Rgb::b)};
}

Rgb CubeLut::in_table(Rgb color) const {
    const auto& [low, high] = domain_;
    const GridPoint points[3] = {grid_point_of(color.r, low.r, high.r, side_),
                                 grid_point_of(color.g, low.g, high.g, side_),
                                 grid_point_of(color.b, low.b, high.b, side_)};
    const float share[3] = {points[0].share, points[1].share, points[2].share};
    // The path from the lowest to the highest corner along the axes, the largest share first, has the corners of the
    // tetrahedron.
    int order[3] = {0, 1, 2};
    std::stable_sort(order, order + 3, [&](int a, int b) { return share[a] > share[b]; });
    uint32_t corner[3] = {points[0].cell, points[1].cell, points[2].cell};
    Rgb sum = (1.0f - share[order[0]]) * at(corner[0], corner[1], corner[2]);
    for (int i = 0; i < 3; ++i) {
        ++corner[order[i]];
        const float weight = share[order[i]] - (i < 2 ? share[order[i + 1]] : 0.0f);
        sum = sum + weight * at(corner[0], corner[1], corner[2]);
    }
    return sum;
}

} // namespace pertev
