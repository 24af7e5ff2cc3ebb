#include "formats/gltf/uri.h"

#include <array>
#include <cctype>
#include <cstdint>

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

std::optional<std::vector<std::byte>> decode_base64(std::string_view text) {
    for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
    if (text.size() % 4 == 1) return std::nullopt;
    std::vector<std::byte> bytes(text.size() / 4 * 3 + (text.size() % 4 == 0 ? 0 : text.size() % 4 - 1));
    uint32_t bits = 0;
    int held = 0; // bits not yet written
    std::size_t written = 0;
    for (const char c : text) {
        const uint8_t value = kBase64Values[static_cast<unsigned char>(c)];
        if (value == kNotBase64) return std::nullopt;
        bits = bits << 6 | value;
        held += 6;
        if (held >= 8) {
            held -= 8;
            bytes[written++] = static_cast<std::byte>(bits >> held & 0xffu);
        }
    }
    return bytes;
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

// "C:" is a scheme too: an absolute path of another system is no more a relative path than http: is.
bool has_scheme(std::string_view uri) {
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const char c = uri[i];
        if (c == ':') return i > 0;
        const bool letter = std::isalpha(static_cast<unsigned char>(c)) != 0;
        const bool later = std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.';
        if (!letter && !(i > 0 && later)) return false;
    }
    return false;
}

} // namespace

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri) {
    const std::size_t comma = uri.find(',');
    if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
    if (!uri.substr(0, comma).ends_with(";base64")) return std::nullopt;
    return decode_base64(uri.substr(comma + 1));
}

std::optional<std::string> decode_path_uri(std::string_view uri) {
    if (has_scheme(uri)) return std::nullopt;
    std::string path;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        char c = uri[i];
        if (c == '%') {
            if (uri.size() - i < 3) return std::nullopt;
            const int high = hex_digit(uri[i + 1]), low = hex_digit(uri[i + 2]);
            if (high < 0 || low < 0) return std::nullopt;
            c = static_cast<char>(high * 16 + low);
            i += 2;
        }
        if (c == '\0') return std::nullopt;
        path += c;
    }
    return path;
}

} // namespace pertev::gltf
