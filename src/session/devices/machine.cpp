#include "session/devices/machine.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "device/device_identity.h"
#include "session/devices/device_names.h"
#include "settings/setting.h"

namespace pertev {
namespace {

using Queues = std::vector<std::unique_ptr<Queue>>;

[[noreturn]] void refuse_device(const std::string& name, const std::string& reason) {
    throw Error(ErrorCode::BadInput, "device", name, reason);
}

/// Returns a queue for each time that the CPU is named. They share out its threads.
Queues queues_of_cpu(std::size_t count, const Threads& threads) {
    Queues queues;
    if (count == 1) queues.push_back(std::make_unique<Queue>(Queue::make_cpu(threads)));
    const UseThreads use(threads);
    const int each = std::max(thread_count() / static_cast<int>(std::max<std::size_t>(count, 1)), 1);
    while (queues.size() < count) queues.push_back(std::make_unique<Queue>(Queue::make_cpu(Threads(each))));
    return queues;
}

/// Takes the devices, GPUs at once because each takes a while to start, and orders them by memory.
Queues queues_of(const std::vector<NamedDevice>& devices, const Threads& threads) {
    const std::vector<CudaDevice> known = cuda_devices();
    std::vector<std::pair<std::size_t, std::future<std::unique_ptr<Queue>>>> coming;
    for (const NamedDevice& device : devices) {
        if (!device.is_cuda) continue;
        const int index = device.index;
        coming.emplace_back(known.at(static_cast<std::size_t>(index)).bytes, std::async(std::launch::async, [=] {
                                return std::make_unique<Queue>(Queue::make_cuda(index, threads));
                            }));
    }
    std::ranges::stable_sort(coming, std::greater(), [](const auto& device) { return device.first; });
    Queues queues;
    for (auto& device : coming) queues.push_back(device.second.get());
    for (auto& queue : queues_of_cpu(devices.size() - coming.size(), threads)) queues.push_back(std::move(queue));
    return queues;
}

} // namespace

std::unique_ptr<Queue> open_queue(const MachineOptions& options, Sink& sink) {
    return StartingMachine(options, sink).take();
}

std::vector<std::unique_ptr<Queue>> open_queues(const MachineOptions& options, Sink& sink) {
    return StartingMachine(options, sink, StartingMachine::Takes::AllNamed).take_all();
}

StartingMachine::StartingMachine(const MachineOptions& options, Sink& sink, Takes takes)
    : name_(options.device), sink_(sink),
      threads_(options.threads > 0 ? Threads(static_cast<int>(options.threads)) : Threads()) {
    if (takes == Takes::OneDevice) refuse_several_devices(name_, "this");
    if (name_ != "auto" && needs_list_of_devices(name_)) {
        start_list();
        return;
    }
    const bool is_auto = name_ == "auto";
    std::vector<NamedDevice> devices = {{true, 0}};
    if (!is_auto) devices = parse_devices(name_, {});
    if (std::ranges::none_of(devices, &NamedDevice::is_cuda)) {
        queues_ = queues_of_cpu(devices.size(), threads_);
        is_cuda_ = false;
        return;
    }
    if (devices.size() > 1) {
        start_list();
        return;
    }
    const int index = devices.front().index;
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
        Queues queues;
        queues.push_back(std::make_unique<Queue>(reason.empty() ? Queue::make_cuda(index, own) : Queue::make_cpu(own)));
        return queues;
    });
}

/// Starts to take devices that only the driver's list tells apart, or several.
void StartingMachine::start_list() {
    if (!may_have_cuda()) refuse_device(name_, why_no_cuda(0));
    std::promise<std::string> why_no_gpu;
    why_no_gpu_ = why_no_gpu.get_future();
    coming_ = std::async(std::launch::async, [name = name_, own = threads_, why = std::move(why_no_gpu)]() mutable {
        std::vector<NamedDevice> devices;
        try {
            std::vector<std::string> uuids;
            for (DeviceIdentity& known : device_identities()) uuids.push_back(std::move(known.uuid));
            if (uuids.empty()) refuse_device(name, why_no_cuda(0));
            devices = parse_devices(name, uuids);
            for (const NamedDevice& device : devices) {
                const std::string reason = device.is_cuda ? why_no_cuda(device.index) : "";
                if (!reason.empty()) refuse_device(fmt::format("cuda:{}", device.index), reason);
            }
        } catch (...) {
            why.set_exception(std::current_exception());
            return Queues();
        }
        why.set_value("");
        return queues_of(devices, own);
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

std::vector<std::unique_ptr<Queue>> StartingMachine::take_all() {
    is_cuda(); // for its notice
    return queues_.empty() ? coming_.get() : std::move(queues_);
}

} // namespace pertev
