#include "session/machine.h"

#include <charconv>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

[[noreturn]] void refuse_device(const std::string& name, const std::string& reason) {
    throw Error(ErrorCode::BadInput, "device", name, reason);
}

/// Parses the index of cuda:N. Throws Error(BadInput).
int cuda_index(const std::string& name) {
    if (name == "cuda") return 0;
    int index = 0;
    const char* const end = name.data() + name.size();
    const bool numbered = name.starts_with("cuda:");
    const auto parsed = numbered ? std::from_chars(name.data() + 5, end, index) : std::from_chars_result{end, {}};
    if (!numbered || parsed.ec != std::errc() || parsed.ptr != end) {
        refuse_device(name, "expected auto, cpu, cuda or cuda:N with N a device's number");
    }
    return index;
}

} // namespace

std::unique_ptr<Queue> open_queue(const MachineOptions& options, Sink& sink) {
    return StartingMachine(options, sink).take();
}

StartingMachine::StartingMachine(const MachineOptions& options, Sink& sink)
    : name_(options.device), sink_(sink),
      threads_(options.threads > 0 ? Threads(static_cast<int>(options.threads)) : Threads()) {
    if (name_ == "cpu") {
        queue_ = std::make_unique<Queue>(Queue::make_cpu(threads_));
        is_cuda_ = false;
        return;
    }
    const bool is_auto = name_ == "auto";
    const int index = is_auto ? 0 : cuda_index(name_);
    if (!is_auto && !may_have_cuda()) refuse_device(name_, why_no_cuda(index));
    std::promise<std::string> why_no_gpu;
    why_no_gpu_ = why_no_gpu.get_future();
    coming_ = std::async(std::launch::async, [index, own = threads_, why_no_gpu = std::move(why_no_gpu)]() mutable {
        std::string reason;
        try {
            reason = why_no_cuda(index);
        } catch (...) {
            why_no_gpu.set_exception(std::current_exception());
            throw;
        }
        why_no_gpu.set_value(reason);
        return std::make_unique<Queue>(reason.empty() ? Queue::make_cuda(index, own) : Queue::make_cpu(own));
    });
}

bool StartingMachine::is_cuda() {
    if (!is_cuda_) {
        const std::string reason = why_no_gpu_.get();
        is_cuda_ = reason.empty();
        if (!reason.empty() && name_ != "auto") refuse_device(name_, reason);
        if (!reason.empty()) sink_.note(fmt::format("using the CPU: {}", reason));
    }
    return *is_cuda_;
}

bool StartingMachine::may_be_cuda() {
    const bool is_known =
        is_cuda_.has_value() || why_no_gpu_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    return is_known || !may_have_cuda() ? is_cuda() : true;
}

std::unique_ptr<Queue> StartingMachine::take() {
    is_cuda(); // for its notice
    return queue_ ? std::move(queue_) : coming_.get();
}

} // namespace pertev
