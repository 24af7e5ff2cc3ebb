#include "apps/viewer/access_token.h"

#include <sys/random.h>

#include <vector>

#include "base/error.h"

namespace pertev {

std::string make_token(int bytes) {
    std::vector<unsigned char> random(static_cast<std::size_t>(bytes));
    if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
        throw Error(ErrorCode::DeviceFault, "the system provides no random numbers, so no safe address can be made");
    }
    std::string token;
    for (const unsigned char byte : random) {
        token += "0123456789abcdef"[byte >> 4];
        token += "0123456789abcdef"[byte & 15];
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
