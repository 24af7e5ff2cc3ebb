#include "formats/gltf/uri.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <span>
#include <system_error>

namespace pertev::gltf {
namespace {

constexpr uint8_t kNotBase64 = 0xff;

constexpr std::array<uint8_t, 256> make_base64_values() {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<uint8_t, 256> values{};
    for (uint8_t& value : values) value = kNotBase64;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        values[static_cast<unsigned char>(digits[i])] = static_cast<uint8_t>(i);
    }
    return values;
}

constexpr std::array<uint8_t, 256> kBase64Values = make_base64_values();

// White space between digits is skipped: encoders of mail (RFC 2045) break lines.
std::optional<std::vector<std::byte>> decode_base64(std::string_view text) {
    std::vector<std::byte> bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    uint32_t bits = 0;
    int held = 0; // bits not yet written
    std::size_t digits = 0, padding = 0;
    for (const char c : text) {
        if (c == ' ' || c == '\t' || c == '\r' || c == '\n') continue;
        if (c == '=') {
            if (++padding > 2) return std::nullopt;
            continue;
        }
        const uint8_t value = kBase64Values[static_cast<unsigned char>(c)];
        if (value == kNotBase64 || padding > 0) return std::nullopt;
        ++digits;
        bits = bits << 6 | value;
        held += 6;
        if (held >= 8) {
            held -= 8;
            bytes.push_back(static_cast<std::byte>(bits >> held & 0xffu));
        }
    }
    if (digits % 4 == 1) return std::nullopt;
    return bytes;
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/// Decodes %XX to bytes. A '%' without two hexadecimal digits after it stands for itself if `is_lenient`; otherwise the
/// result is nothing.
std::optional<std::string> undo_percent_encoding(std::string_view text, bool is_lenient) {
    std::string result;
    result.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        char c = text[i];
        if (c == '%') {
            const bool has_two = text.size() - i >= 3;
            const int high = has_two ? hex_digit(text[i + 1]) : -1, low = has_two ? hex_digit(text[i + 2]) : -1;
            if (high >= 0 && low >= 0) {
                c = static_cast<char>(high * 16 + low);
                i += 2;
            } else if (!is_lenient) {
                return std::nullopt;
            }
        }
        result += c;
    }
    return result;
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool starts_with_in_any_case(std::string_view text, std::string_view lower_case) {
    return text.size() >= lower_case.size() &&
           std::equal(lower_case.begin(), lower_case.end(), text.begin(), [](char a, char b) { return a == lower(b); });
}

// A scheme of one letter is a drive of another system.
bool has_scheme(std::string_view uri) {
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const char c = uri[i];
        if (c == ':') return i > 1;
        const bool letter = std::isalpha(static_cast<unsigned char>(c)) != 0;
        const bool later = std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.';
        if (!letter && !(i > 0 && later)) return false;
    }
    return false;
}

constexpr std::string_view kData = "data:", kFile = "file:", kBase64 = ";base64";

/// Returns the path in `rest`, the part of a file: URI after "file:" (RFC 8089), without a host name, and without the
/// slash before a drive.
std::string_view path_of_file_uri(std::string_view rest) {
    if (rest.starts_with("//")) {
        const std::size_t slash = rest.find('/', 2);
        rest = slash == std::string_view::npos ? std::string_view() : rest.substr(slash);
    }
    const bool has_drive = rest.size() > 2 && rest[0] == '/' && (rest[2] == ':' || rest[2] == '|');
    return has_drive ? rest.substr(1) : rest;
}

} // namespace

bool is_data_uri(std::string_view uri) { return starts_with_in_any_case(uri, kData); }

std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri) {
    const std::size_t comma = uri.find(',');
    if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
    const std::string_view encoded = uri.substr(comma + 1);
    const bool is_base64 =
        comma >= kBase64.size() && starts_with_in_any_case(uri.substr(comma - kBase64.size(), kBase64.size()), kBase64);
    if (is_base64 && encoded.find('%') == std::string_view::npos) return decode_base64(encoded);
    const std::optional<std::string> text = undo_percent_encoding(encoded, false);
    if (!text) return std::nullopt;
    if (is_base64) return decode_base64(*text);
    const auto bytes = std::as_bytes(std::span(*text));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
}

std::optional<std::string> decode_path_uri(std::string_view uri) {
    if (starts_with_in_any_case(uri, kFile)) {
        uri = path_of_file_uri(uri.substr(kFile.size()));
    } else if (has_scheme(uri)) {
        return std::nullopt;
    }
    std::optional<std::string> path = undo_percent_encoding(uri, true);
    if (path->find('\0') != std::string::npos) return std::nullopt;
    return path;
}

std::string plain_file_name(const std::string& name) {
    return starts_with_in_any_case(name, kFile) ? decode_path_uri(name).value_or(name) : name;
}

std::optional<std::string> file_name_of_uri(std::string_view uri, const std::filesystem::path& from) {
    const std::optional<std::string> decoded = decode_path_uri(uri);
    if (!decoded || *decoded == uri || uri.find('%') == std::string_view::npos) return decoded;
    const std::filesystem::path folder = from.parent_path();
    std::error_code ec;
    if (std::filesystem::exists(folder / *decoded, ec) || !std::filesystem::exists(folder / uri, ec)) return decoded;
    return std::string(uri);
}

} // namespace pertev::gltf
