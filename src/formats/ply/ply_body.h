#pragma once

// The body of a PLY file as a sequence of values of any type. All of it is inline, because a value takes a few
// instructions and files have millions.

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"
#include "base/sink.h"
#include "formats/files/parse_number.h"
#include "formats/ply/ply_header.h"

namespace pertev {

/// Reads values and tracks the position of the next one for messages.
class PlyBody {
public:
    PlyBody(std::span<const std::byte> bytes, const PlyHeader& header, const std::string& file)
        : begin_(reinterpret_cast<const char*>(bytes.data())), at_(begin_ + header.size), end_(begin_ + bytes.size()),
          format_(header.format), file_(file) {
        find_lines(header);
    }

    Error fault(const std::string& what) const {
        const std::string value = fmt::format("{} {}: {}", element_, number_, what);
        if (format_ == PlyFormat::Ascii) return Error(ErrorCode::BadInput, FileLocation{file_, line()}, value);
        return Error(ErrorCode::BadInput, FileLocation{file_}, fmt::format("byte {}: {}", at_ - begin_, value));
    }
    void set_location(const std::string& element, uint64_t number) {
        element_ = element;
        number_ = number;
    }
    bool is_binary() const { return format_ != PlyFormat::Ascii; }
    void set_number(uint64_t number) { number_ = number; }

    /// Minimum number of bytes of a value: in text a digit and a space.
    std::size_t min_size(PlyType type) const { return format_ == PlyFormat::Ascii ? 2 : size_of(type); }

    /// Throws unless `count` items of at least `least` bytes each may still follow.
    void expect(uint64_t count, std::size_t least, const char* what) const {
        // The last value of a text may have no space after it.
        const uint64_t left = static_cast<uint64_t>(end_ - at_) + (format_ == PlyFormat::Ascii ? 1 : 0);
        if (count > left / least) {
            throw fault(fmt::format("{} {} do not fit into the remaining {} bytes", count, what, end_ - at_));
        }
    }

    double value(PlyType type) {
        switch (format_) {
        case PlyFormat::Ascii:
            return text_value(type);
        case PlyFormat::LittleEndian:
            return binary_value<false>(type);
        case PlyFormat::BigEndian:
            return binary_value<true>(type);
        }
        return 0;
    }

    /// Count of a list, checked against the remaining bytes. If each element is a line, a bad count invalidates its
    /// line and becomes 0.
    uint64_t list_count(const PlyProperty& property) {
        const double count = value(property.count_type);
        const bool is_count = count >= 0 && count < 0x1p32;
        const auto whole = is_count ? static_cast<uint64_t>(count) : 0;
        if (has_lines_ && !(is_count && whole <= static_cast<uint64_t>(end_ - at_))) {
            if (!std::isnan(count)) note_bad_value("a list's count exceeds the file");
            is_line_bad_ = true;
            return 0;
        }
        if (!is_count) throw fault("a list's count is not between 0 and 2^32 - 1");
        expect(whole, min_size(property.type), "entries of a list");
        return whole;
    }
    /// Returns whether the rest of this line is invalid, up to end_element().
    bool is_line_bad() const { return is_line_bad_; }

    void skip(const PlyProperty& property) {
        uint64_t values = property.is_list ? list_count(property) : 1;
        if (format_ != PlyFormat::Ascii) {
            if (!property.is_list) expect(1, size_of(property.type), "values");
            at_ += values * size_of(property.type);
            return;
        }
        for (; values > 0; --values) word();
    }

    /// Skips the rest of an element's line, in a text with one element per line.
    void end_element() {
        if (!has_lines_) return;
        while (at_ != end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
        const bool was_bad = std::exchange(is_line_bad_, false);
        if (at_ == end_ || *at_ == '\n' || *at_ == '\r') return;
        if (!was_bad && long_lines_++ == 0) first_long_line_ = line();
        while (at_ != end_ && *at_ != '\n' && *at_ != '\r') ++at_;
    }
    void warn(Sink& sink) const {
        if (bad_values_ > 0) {
            sink.leave_out(first_bad_value_->and_then(
                bad_values_ == 1 ? "; it is left out"
                                 : fmt::format("; this and {} more are left out", bad_values_ - 1)));
        }
        if (long_lines_ == 0) return;
        sink.leave_out({FileLocation{file_, first_long_line_},
                        fmt::format("{} with more numbers than the header states; the rest is left out",
                                    counted(long_lines_, "line"))});
    }

private:
    /// Finds out whether a text has one element per line: it has as many non-empty lines as elements, or more with
    /// broken lists.
    void find_lines(const PlyHeader& header) {
        if (format_ != PlyFormat::Ascii) return;
        uint64_t elements = 0, lines = 0;
        for (const PlyElement& element : header.elements) {
            if (!element.properties.empty()) elements += element.count;
        }
        bool is_blank = true;
        for (const char* c = at_; c != end_; ++c) {
            const bool is_end = *c == '\n' || *c == '\r';
            if (!is_end && *c != ' ' && *c != '\t' && is_blank) ++lines;
            is_blank = is_end || (is_blank && (*c == ' ' || *c == '\t'));
        }
        has_lines_ = lines >= elements;
    }

    /// Number of the current line, for text only.
    std::size_t line() const {
        std::size_t lines = 1;
        for (const char* c = begin_; c != at_; ++c) {
            lines += *c == '\n' || (*c == '\r' && c + 1 != end_ && c[1] != '\n');
        }
        return lines;
    }

    std::string_view word() {
        const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
        while (at_ != end_ && is_space(*at_)) ++at_;
        const char* begin = at_;
        while (at_ != end_ && !is_space(*at_)) ++at_;
        if (begin == at_) throw fault("the file ends here");
        return {begin, static_cast<std::size_t>(at_ - begin)};
    }

    void note_bad_value(const std::string& what) {
        if (bad_values_++ == 0) first_bad_value_ = fault(what).remark();
    }

    /// Parses a value of a text. A word that is not a number becomes NaN, with a warning; only the element that
    /// contains it is left out.
    double text_value(PlyType type) {
        const std::string_view text = word();
        std::string_view rest = text;
        if (type != PlyType::Float32 && type != PlyType::Float64) {
            int64_t number = 0;
            const auto [after, ec] = std::from_chars(text.data(), text.data() + text.size(), number);
            if (ec == std::errc{} && after == text.data() + text.size()) return static_cast<double>(number);
        }
        const std::optional<double> number = parse_float<double>(rest); // some files have 255.0 for a uchar
        if (number && rest.empty()) return *number;
        note_bad_value(fmt::format("\"{}\" is not a number", text.substr(0, 40)));
        return std::numeric_limits<double>::quiet_NaN();
    }

    template <class T, bool big_endian>
    double load() {
        if (static_cast<std::size_t>(end_ - at_) < sizeof(T)) throw fault("the file ends here");
        std::array<char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), at_, sizeof(T));
        if constexpr (big_endian) std::reverse(bytes.begin(), bytes.end());
        at_ += sizeof(T);
        return static_cast<double>(std::bit_cast<T>(bytes));
    }

    template <bool big_endian>
    double binary_value(PlyType type) {
        static_assert(std::endian::native == std::endian::little);
        switch (type) {
        case PlyType::Int8:
            return load<int8_t, big_endian>();
        case PlyType::UInt8:
            return load<uint8_t, big_endian>();
        case PlyType::Int16:
            return load<int16_t, big_endian>();
        case PlyType::UInt16:
            return load<uint16_t, big_endian>();
        case PlyType::Int32:
            return load<int32_t, big_endian>();
        case PlyType::UInt32:
            return load<uint32_t, big_endian>();
        case PlyType::Float32:
            return load<float, big_endian>();
        case PlyType::Float64:
            return load<double, big_endian>();
        case PlyType::Int64:
            return load<int64_t, big_endian>();
        case PlyType::UInt64:
            return load<uint64_t, big_endian>();
        }
        return 0;
    }

    const char* begin_;
    const char* at_;
    const char* end_;
    PlyFormat format_;
    const std::string& file_;
    std::string element_ = "header";
    uint64_t number_ = 0;
    bool is_line_bad_ = false;
    uint64_t bad_values_ = 0;
    std::optional<Remark> first_bad_value_;
    bool has_lines_ = false;
    uint64_t long_lines_ = 0;
    std::size_t first_long_line_ = 0;
};

} // namespace pertev
