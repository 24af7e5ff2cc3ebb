#include "apps/cli/choose_device.h"

#include <charconv>

#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {

std::unique_ptr<Queue> choose_device(const std::string& name, Messages& messages) {
    if (name == "cpu") return std::make_unique<Queue>(Queue::make_cpu());
    if (name == "auto") {
        const std::string reason = why_no_cuda(0);
        if (reason.empty()) return std::make_unique<Queue>(Queue::make_cuda(0));
        messages.note(fmt::format("using the CPU: {}", reason));
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

void add_machine_flags(CLI::App& verb, MachineFlags& flags, const char* group) {
    verb.add_option("--device", flags.device, "auto, cpu, cuda or cuda:N")
        ->type_name("NAME")
        ->capture_default_str()
        ->group(group);
    verb.add_option("--threads", flags.threads, "of the CPU (all)")
        ->type_name("N")
        ->check(whole_between(1, 4096))
        ->group(group);
}

std::unique_ptr<Queue> take_machine(const MachineFlags& flags, Messages& messages) {
    if (flags.threads > 0) set_thread_count(flags.threads);
    return choose_device(flags.device, messages);
}

} // namespace pertev
