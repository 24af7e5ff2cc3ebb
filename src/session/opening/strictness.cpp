#include "session/opening/strictness.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"

namespace pertev {

void refuse_what_is_left_out(const Messages& messages, const char* outcome) {
    const std::vector<std::string> left_out = messages.left_out();
    if (left_out.empty()) return;
    const std::size_t others = left_out.size() - 1;
    throw Error(ErrorCode::BadInput, "strict", "",
                fmt::format("{}{}; {}", left_out.front(),
                            others > 0 ? fmt::format(" (and {} like it)", counted(others, "warning")) : "", outcome));
}

void refuse_invalid_samples(uint64_t count) {
    if (count == 0) return;
    throw Error(ErrorCode::BadInput, "strict", "",
                fmt::format("{} not finite; the picture is written", counted(count, "sample")));
}

} // namespace pertev
