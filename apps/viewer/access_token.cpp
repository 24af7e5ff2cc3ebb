#include "apps/viewer/access_token.h"

#include <sys/random.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "base/error.h"
#include "base/read_file.h"

namespace pertev {

std::string make_token(int bytes) {
    std::vector<unsigned char> random(static_cast<std::size_t>(bytes));
    if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
        throw Error(ErrorCode::DeviceFault, "the system provides no random numbers for a safe address");
    }
    std::string token;
    for (const unsigned char byte : random) {
        token += "0123456789abcdef"[byte >> 4];
        token += "0123456789abcdef"[byte & 15];
    }
    return token;
}

std::string given_token(const std::string& file) {
    std::string token;
    if (const char* const given = std::getenv("PERTEV_TOKEN"); file.empty() && given != nullptr) token = given;
    if (file.empty() && token.empty()) return token;
    if (!file.empty()) {
        for (const std::byte byte : read_file(file)) token += static_cast<char>(byte);
    }
    token.erase(token.find_last_not_of(" \t\r\n") + 1);
    constexpr std::size_t kFewest = 16, kMost = 128; // characters
    const auto is_plain = [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' || c == '_';
    };
    if (token.size() < kFewest || token.size() > kMost || !std::ranges::all_of(token, is_plain)) {
        const std::string where = file.empty() ? "the environment's PERTEV_TOKEN: " : "";
        throw Error(ErrorCode::BadInput, "token_file", file, where + "expected 16 to 128 letters, digits, - and _");
    }
    return token;
}

bool equal_in_constant_time(std::string_view given, std::string_view secret) {
    if (secret.empty()) return false; // no secret opens nothing
    unsigned char different = given.size() == secret.size() ? 0 : 1;
    for (std::size_t i = 0; i < given.size(); ++i) {
        const char right = secret[i % secret.size()];
        different = static_cast<unsigned char>(different | (given[i] ^ right));
    }
    // Read through a volatile, so that no compiler makes an early exit of the loop.
    volatile unsigned char result = different;
    return result == 0;
}

} // namespace pertev
