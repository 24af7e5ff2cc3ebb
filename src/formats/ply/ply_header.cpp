#include "formats/ply/ply_header.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"

namespace pertev {
namespace {

struct TypeName {
    std::string_view name;
    PlyType type;
};
constexpr TypeName kTypeNames[] = {
    {"char", PlyType::Int8},       {"int8", PlyType::Int8},       {"uchar", PlyType::UInt8},
    {"uint8", PlyType::UInt8},     {"short", PlyType::Int16},     {"int16", PlyType::Int16},
    {"ushort", PlyType::UInt16},   {"uint16", PlyType::UInt16},   {"int", PlyType::Int32},
    {"int32", PlyType::Int32},     {"uint", PlyType::UInt32},     {"uint32", PlyType::UInt32},
    {"float", PlyType::Float32},   {"float32", PlyType::Float32}, {"double", PlyType::Float64},
    {"float64", PlyType::Float64}, {"int64", PlyType::Int64},     {"uint64", PlyType::UInt64},
};

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::size_t at = line.find_first_not_of(" \t"); at < line.size(); at = line.find_first_not_of(" \t", at)) {
        const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
    return words;
}

/// Returns whether a word is `TextureFile`, in either case, with or without a colon.
bool is_texture_file(std::string_view word) {
    if (word.ends_with(':')) word.remove_suffix(1);
    constexpr std::string_view key = "texturefile";
    return std::ranges::equal(word, key,
                              [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

class HeaderParser {
public:
    HeaderParser(std::string_view text, const std::string& file) : text_(text), file_(file) {}

    PlyHeader run() {
        if (text_.starts_with("\xef\xbb\xbf")) at_ = 3; // byte order mark
        if (words_of(next_line()) != std::vector<std::string_view>{"ply"}) {
            throw fault("expected the line 'ply', the start of a PLY file");
        }
        auto format = next_words();
        for (; format[0] != "format"; format = next_words()) {
            if (is_one_of_elements(format[0])) {
                throw fault("expected the line 'format ascii|binary_little_endian|binary_big_endian 1.0' after 'ply'");
            }
            take_as_comment();
        }
        if (format.size() < 2) throw fault("unknown format; expected ascii, binary_little_endian or binary_big_endian");
        header_.format = format_of(format[1]);
        if (format.size() != 3 || format[2] != "1.0") {
            repaired(fmt::format("version {}; it is read as 1.0", format.size() > 2 ? format[2] : "is missing"));
        }
        for (;;) {
            const auto words = next_words();
            if (words[0] == "end_header") break;
            if (words[0] == "element") {
                element(words);
            } else if (words[0] == "property") {
                property(words);
            } else {
                take_as_comment();
            }
        }
        header_.size = at_;
        return std::move(header_);
    }

private:
    Error fault(const std::string& what) const {
        return Error(ErrorCode::BadInput, FileLocation{file_, line_number_}, what);
    }

    static bool is_one_of_elements(std::string_view word) {
        return word == "element" || word == "property" || word == "end_header";
    }

    void repaired(std::string what) {
        header_.repairs.emplace_back(FileLocation{file_, line_number_}, std::move(what));
    }

    /// Treats a line as a comment: Blender 2.4 wrote "Created by Blender3D ...", and old Assimp its own name, without
    /// the word comment.
    void take_as_comment() {
        if (!header_.elements.empty() && header_.format != PlyFormat::Ascii) { // it may stand for bytes of the body
            throw fault("unknown header line; expected element, property, comment, obj_info or end_header");
        }
        if (!std::exchange(has_unknown_line_, true)) {
            repaired("an unknown header line is read as a comment");
        }
    }

    std::string_view next_line() {
        ++line_number_;
        const std::size_t end = text_.find_first_of("\r\n", at_);
        if (end == text_.npos) throw fault("the file ends within its header");
        const std::string_view line = text_.substr(at_, end - at_);
        const bool is_pair = text_[end] == '\r' && end + 1 < text_.size() && text_[end + 1] == '\n';
        at_ = end + (is_pair ? 2 : 1);
        return line;
    }

    /// Returns the words of the next line that is not a comment.
    std::vector<std::string_view> next_words() {
        for (;;) {
            const std::string_view line = next_line();
            const auto words = words_of(line);
            if (!words.empty() && words[0] != "comment" && words[0] != "obj_info") return words;
            if (words.size() >= 3 && words[0] == "comment" && is_texture_file(words[1])) {
                const auto begin = static_cast<std::size_t>(words[2].data() - line.data()); // a name may contain spaces
                const auto end = static_cast<std::size_t>(words.back().data() + words.back().size() - line.data());
                std::string_view name = line.substr(begin, end - begin);
                if (name.size() > 2 && name.front() == '"' && name.back() == '"')
                    name = name.substr(1, name.size() - 2);
                header_.textures.push_back({std::string(name), line_number_});
            }
        }
    }

    PlyFormat format_of(std::string_view name) const {
        if (name == "ascii") return PlyFormat::Ascii;
        if (name == "binary_little_endian") return PlyFormat::LittleEndian;
        if (name == "binary_big_endian") return PlyFormat::BigEndian;
        throw fault("unknown format; expected ascii, binary_little_endian or binary_big_endian");
    }

    PlyType type_of(std::string_view name) {
        for (const TypeName& known : kTypeNames) {
            if (known.name == name) return known.type;
        }
        if (header_.format == PlyFormat::Ascii) { // here a value is a word, whatever its size in bytes
            repaired(fmt::format("\"{}\" is not a type; its values are read as numbers", shortened(name)));
            return PlyType::Float64;
        }
        throw fault(
            fmt::format("\"{}\" is not a type; expected char, uchar, short, ushort, int, uint, float or double", name));
    }

    void element(const std::vector<std::string_view>& words) {
        PlyElement element;
        if (words.size() != 3) throw fault("expected 'element NAME COUNT'");
        const char* end = words[2].data() + words[2].size();
        const auto [after, ec] = std::from_chars(words[2].data(), end, element.count);
        if (ec != std::errc{} || after != end) {
            throw fault(fmt::format("\"{}\" is not a count of elements", words[2]));
        }
        element.name = words[1];
        for (const PlyElement& other : header_.elements) {
            if (other.name == element.name) throw fault(fmt::format("there is a second element \"{}\"", element.name));
        }
        header_.elements.push_back(std::move(element));
    }

    void property(const std::vector<std::string_view>& words) {
        if (header_.elements.empty()) throw fault("there is a property before the first element");
        PlyProperty property;
        if (words.size() == 5 && words[1] == "list") {
            property.is_list = true;
            property.count_type = type_of(words[2]);
            property.type = type_of(words[3]);
            if (property.count_type == PlyType::Float32 || property.count_type == PlyType::Float64) {
                throw fault("the count of a list must have an integer type, such as uchar");
            }
        } else if (words.size() == 3) {
            property.type = type_of(words[1]);
        } else {
            throw fault("expected 'property TYPE NAME' or 'property list COUNT_TYPE TYPE NAME'");
        }
        property.name = words.back();
        header_.elements.back().properties.push_back(std::move(property));
    }

    std::string_view text_;
    const std::string& file_;
    PlyHeader header_;
    std::size_t at_ = 0;
    std::size_t line_number_ = 0;
    bool has_unknown_line_ = false;
};

} // namespace

std::size_t size_of(PlyType type) {
    constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8, 8, 8}; // in the order of the types
    static_assert(std::size(kSizes) == static_cast<std::size_t>(PlyType::UInt64) + 1);
    return kSizes[static_cast<std::size_t>(type)];
}

PlyHeader parse_ply_header(std::span<const std::byte> bytes, const std::string& file) {
    return HeaderParser({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file).run();
}

} // namespace pertev
