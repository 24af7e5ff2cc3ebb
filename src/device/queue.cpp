#include "device/queue.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>

#include "base/error.h"
#include "device/wait_for_device.h"

namespace pertev {
namespace {

constexpr std::size_t kAlignment = 256; // alignment of cudaMalloc, on which parts of a buffer rely

/// The CPU's work is done when its call returns, so the wall clock measures it.
class CpuTimeMark final : public TimeMark {
public:
    void record() override { time_ = std::chrono::steady_clock::now(); }
    double seconds_since(const TimeMark& earlier) const override {
        return std::chrono::duration<double>(time_ - static_cast<const CpuTimeMark&>(earlier).time_).count();
    }

private:
    std::chrono::steady_clock::time_point time_;
};

class CpuHostCopy final : public HostCopy {
public:
    explicit CpuHostCopy(std::size_t bytes) : bytes_(bytes) {}
    void take(const void* device) override { std::memcpy(bytes_.data(), device, bytes_.size()); }
    void* target() override { return bytes_.data(); }
    void mark() override {}
    const void* wait(const char*) override { return bytes_.data(); }

private:
    std::vector<std::byte> bytes_;
};

class CpuBackend final : public DeviceBackend {
public:
    void make_current() const override {}
    std::string name() const override { return "CPU"; }
    bool is_cuda() const override { return false; }
    void* stream() const override { return nullptr; }
    void use_stream(int) override {}
    void make_stream_wait(int, int) override {}
    std::size_t free_bytes() const override {
        return static_cast<std::size_t>(::sysconf(_SC_AVPHYS_PAGES)) *
               static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    }
    void* allocate(std::size_t bytes) override {
        return std::aligned_alloc(kAlignment, (bytes + kAlignment - 1) / kAlignment * kAlignment);
    }
    void free(void* memory) noexcept override { std::free(memory); }
    void copy_to_device(void* device, const void* host, std::size_t bytes) override {
        std::memcpy(device, host, bytes);
    }
    void copy_to_host(void* host, const void* device, std::size_t bytes) override { std::memcpy(host, device, bytes); }
    void copy_on_device(void* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
    void fill(void* device, unsigned char value, std::size_t bytes) override { std::memset(device, value, bytes); }
    void wait(const char*) override {}
    void check_launch(const char*) override {}
    std::unique_ptr<TimeMark> make_time_mark() override { return std::make_unique<CpuTimeMark>(); }
    std::unique_ptr<HostCopy> make_host_copy(std::size_t bytes) override {
        return std::make_unique<CpuHostCopy>(bytes);
    }
};

class DryRunBackend final : public DeviceBackend {
public:
    explicit DryRunBackend(bool is_cuda) : is_cuda_(is_cuda) {}
    void make_current() const override { PERTEV_CHECK(false); } // a dry run can run no work
    std::string name() const override { return "dry run"; }
    bool is_cuda() const override { return is_cuda_; }
    bool is_dry_run() const override { return true; }
    void* stream() const override { return nullptr; }
    void use_stream(int) override {}
    void make_stream_wait(int, int) override {}
    std::size_t free_bytes() const override { return SIZE_MAX; }
    void* allocate(std::size_t bytes) override {
        const std::uintptr_t at = next_; // aligned and unique, like a memory address
        next_ += (bytes + kAlignment - 1) / kAlignment * kAlignment;
        return reinterpret_cast<void*>(at);
    }
    void free(void*) noexcept override {}
    void copy_to_device(void*, const void*, std::size_t) override {}
    void copy_to_host(void* host, const void*, std::size_t bytes) override { std::memset(host, 0, bytes); }
    void copy_on_device(void*, const void*, std::size_t) override {}
    void fill(void*, unsigned char, std::size_t) override {}
    void wait(const char*) override {}
    void check_launch(const char*) override {}
    std::unique_ptr<TimeMark> make_time_mark() override { return std::make_unique<CpuTimeMark>(); }
    std::unique_ptr<HostCopy> make_host_copy(std::size_t) override { return std::make_unique<CpuHostCopy>(0); }

private:
    bool is_cuda_;
    std::uintptr_t next_ = kAlignment;
};

double mebibytes(std::size_t bytes) { return static_cast<double>(bytes) / (1024.0 * 1024.0); }

} // namespace

Queue Queue::make_cpu(const Threads& threads) { return Queue(std::make_unique<CpuBackend>(), threads); }

Queue Queue::make_dry_run(bool is_cuda) { return Queue(std::make_unique<DryRunBackend>(is_cuda)); }

Queue Queue::make_cuda(int index, const Threads& threads) { return Queue(make_cuda_backend(index), threads); }

Queue::Queue(Queue&& other) : threads_(other.threads_) {
    PERTEV_CHECK(other.allocations_.empty()); // before the other loses its backend
    backend_ = std::move(other.backend_);
}

void* Queue::allocate(std::size_t bytes, const std::string& name) {
    if (bytes == 0) return nullptr;
    void* memory = backend_->allocate(bytes);
    if (memory == nullptr) {
        std::vector<Allocation> largest = allocations_;
        std::ranges::sort(largest, [](const Allocation& a, const Allocation& b) { return a.bytes > b.bytes; });
        std::string list;
        for (std::size_t i = 0; i < std::min<std::size_t>(largest.size(), 5); ++i) {
            list += fmt::format("\n  {:10.1f} MiB  {}", mebibytes(largest[i].bytes), largest[i].name);
        }
        throw Error(ErrorCode::OutOfMemory,
                    fmt::format("{}: out of memory: {} needs {:.1f} MiB, {:.1f} MiB are free; the largest buffers:{}",
                                device_name(), name, mebibytes(bytes), mebibytes(free_bytes()),
                                list.empty() ? "\n  (none)" : list));
    }
    allocations_.push_back({memory, bytes, name});
    allocated_ += bytes;
    ++allocation_count_;
    peak_ = std::max(peak_, allocated_);
    return memory;
}

void Queue::free(void* memory) noexcept {
    if (memory == nullptr) return;
    const auto found = std::ranges::find(allocations_, memory, &Allocation::memory);
    if (found == allocations_.end()) return;
    allocated_ -= found->bytes;
    *found = std::move(allocations_.back());
    allocations_.pop_back();
    backend_->free(memory);
}

#if !defined(PERTEV_HAS_CUDA)

std::string why_no_cuda(int) { return "this binary was built without CUDA (./setup.sh can build with it)"; }
bool may_have_cuda() { return false; }
int cuda_device_count() { return 0; }
std::vector<CudaDevice> cuda_devices() { return {}; }
std::unique_ptr<DeviceBackend> make_cuda_backend(int index) {
    throw Error(ErrorCode::BadInput, "device", fmt::format("cuda:{}", index), why_no_cuda(index));
}

void wait_for_device(const Queue&) {}

#endif

} // namespace pertev
