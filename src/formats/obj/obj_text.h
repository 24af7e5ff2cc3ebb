#pragma once

// The common syntax of .obj and .mtl files: statements over one or more lines, words, comments, names.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace pertev {

// A backslash joins a line with the next, so line ends inside a statement are space.
inline bool is_obj_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\\' || c == '\0'; }

inline void skip_space(std::string_view& text) {
    std::size_t n = 0;
    while (n < text.size() && is_obj_space(text[n])) ++n;
    text.remove_prefix(n);
}

/// Removes and returns the first word of `text`; empty if there is none.
inline std::string_view take_word(std::string_view& text) {
    skip_space(text);
    std::size_t n = 0;
    while (n < text.size() && !is_obj_space(text[n])) ++n;
    const std::string_view word = text.substr(0, n);
    text.remove_prefix(n);
    return word;
}

/// A name, which may contain spaces: the rest of a statement without surrounding space and without a comment. The #
/// of a comment is a separate word: "Material #25" is a name.
inline std::string_view rest_as_name(std::string_view text) {
    for (std::size_t at = text.find('#'); at != text.npos; at = text.find('#', at + 1)) {
        const bool begins = at == 0 || is_obj_space(text[at - 1]);
        const bool stands_alone = at + 1 == text.size() || is_obj_space(text[at + 1]) || text[at + 1] == '#';
        if (begins && stands_alone) {
            text = text.substr(0, at);
            break;
        }
    }
    while (!text.empty() && is_obj_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_obj_space(text.back())) text.remove_suffix(1);
    return text;
}

/// Text without a byte order mark.
inline std::string_view text_of(std::span<const std::byte> bytes) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    return text;
}

/// Statements with their line numbers.
class ObjLines {
public:
    explicit ObjLines(std::string_view text) : ObjLines(text, end_of_line_of(text), 1) {}
    /// Reads a piece of a text that begins at a statement, in line `number`.
    ObjLines(std::string_view piece, char end_of_line, uint32_t number)
        : text_(piece), end_of_line_(end_of_line), number_(number) {}

    /// End-of-line character: CR for old Macintosh files without LF.
    static char end_of_line_of(std::string_view text) { return text.find('\n') == text.npos ? '\r' : '\n'; }

    bool next(std::string_view& line) {
        if (at_ >= text_.size()) return false;
        number_ += joined_;
        joined_ = 0;
        const std::size_t begin = at_, first = text_.find_first_not_of(" \t", at_);
        const bool is_comment = first != text_.npos && text_[first] == '#'; // a path such as C:\scenes\ may end a
                                                                            // comment
        std::size_t end;
        do {
            const void* found = std::memchr(text_.data() + at_, end_of_line_, text_.size() - at_);
            end = found ? static_cast<std::size_t>(static_cast<const char*>(found) - text_.data()) : text_.size();
            at_ = end + 1;
            ++joined_;
        } while (at_ < text_.size() && !is_comment && is_joined(text_, begin, end));
        line = text_.substr(begin, end - begin);
        return true;
    }
    /// Number of the statement's first line; the file's first is 1.
    uint32_t number() const { return number_; }
    /// Number of the line after the statement.
    uint32_t number_behind() const { return number_ + joined_; }

    /// Returns whether the line [begin, end) of `text` continues in the next, unless it is a comment.
    static bool is_joined(std::string_view text, std::size_t begin, std::size_t end) {
        if (end > begin && text[end - 1] == '\r') --end;
        return end > begin && text[end - 1] == '\\';
    }

private:
    std::string_view text_;
    char end_of_line_;
    std::size_t at_ = 0;
    uint32_t number_, joined_ = 0;
};

/// A message about many lines, which is reported once, with the first line.
struct CountedLines {
    std::size_t times = 0;
    uint32_t first_line = 0;

    void add(uint32_t line) {
        if (times++ == 0) first_line = line;
    }
    void add(const CountedLines& others) {
        if (others.times == 0) return;
        first_line = times == 0 ? others.first_line : std::min(first_line, others.first_line);
        times += others.times;
    }
};

} // namespace pertev
