#include "apps/cli/choose_device.h"

#include <charconv>

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {

std::unique_ptr<Queue> choose_device(const std::string& name, Messages& messages) {
    if (name == "cpu") return std::make_unique<Queue>(Queue::make_cpu());
    if (name == "auto") {
        const std::string reason = why_no_cuda(0);
        if (reason.empty()) return std::make_unique<Queue>(Queue::make_cuda(0));
        messages.note(fmt::format("rendering on the CPU: {}", reason));
        return std::make_unique<Queue>(Queue::make_cpu());
    }
    int index = 0;
    const char* const end = name.data() + name.size();
    const bool numbered = name.starts_with("cuda:");
    const auto parsed = numbered ? std::from_chars(name.data() + 5, end, index) : std::from_chars_result{end, {}};
    if ((name != "cuda" && !numbered) || parsed.ec != std::errc() || parsed.ptr != end) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("--device {}: expected auto, cpu, cuda or cuda:N with N a device's number", name));
    }
    if (const std::string reason = why_no_cuda(index); !reason.empty()) {
        throw Error(ErrorCode::BadInput, fmt::format("--device {}: {}", name, reason));
    }
    return std::make_unique<Queue>(Queue::make_cuda(index));
}

} // namespace pertev
