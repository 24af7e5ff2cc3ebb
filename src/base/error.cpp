#include "base/error.h"

#include <fmt/format.h>

namespace pertev {

void check_failed(const char* condition, const char* file, int line) {
    throw std::logic_error(fmt::format("{}:{}: check failed: {}", file, line, condition));
}

} // namespace pertev
