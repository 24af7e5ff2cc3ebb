#include "device/backend.h"

#include <cuda_runtime.h>
#include <dlfcn.h>

#include <algorithm>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "device/cuda/check_cuda.h"
#include "device/cuda/pinned_staging.h"
#include "device/cuda/probe_architecture.h"

namespace pertev {
namespace {

class CudaTimeMark final : public TimeMark {
public:
    /// Device `index` must be the current one.
    CudaTimeMark(cudaStream_t stream, int index) : stream_(stream), index_(index) {
        check_cuda(cudaEventCreate(&event_), "cudaEventCreate");
    }
    ~CudaTimeMark() override {
        cudaSetDevice(index_);
        cudaEventDestroy(event_);
    }
    CudaTimeMark(const CudaTimeMark&) = delete;
    CudaTimeMark& operator=(const CudaTimeMark&) = delete;

    void record() override {
        check_cuda(cudaSetDevice(index_), "cudaSetDevice");
        check_cuda(cudaEventRecord(event_, stream_), "cudaEventRecord");
    }
    double seconds_since(const TimeMark& earlier) const override {
        check_cuda(cudaSetDevice(index_), "cudaSetDevice");
        check_cuda(cudaEventSynchronize(event_),
                   "the work before a time mark"); // faults of that work are reported here
        float milliseconds = 0;
        check_cuda(cudaEventElapsedTime(&milliseconds, static_cast<const CudaTimeMark&>(earlier).event_, event_),
                   "cudaEventElapsedTime");
        return static_cast<double>(milliseconds) * 1e-3;
    }

private:
    cudaStream_t stream_;
    int index_;
    cudaEvent_t event_ = nullptr;
};

class CudaBackend;

/// A copy to the host by pinned memory and an event after the work that writes it.
class CudaHostCopy final : public HostCopy {
public:
    /// Device `index` must be the current one. `backend` outlives it.
    CudaHostCopy(const CudaBackend& backend, int index, std::size_t bytes);
    ~CudaHostCopy() override {
        cudaSetDevice(index_);
        cudaEventSynchronize(taken_);
        cudaEventDestroy(taken_);
        cudaFreeHost(memory_);
    }
    CudaHostCopy(const CudaHostCopy&) = delete;
    CudaHostCopy& operator=(const CudaHostCopy&) = delete;

    void take(const void* device) override;
    void* target() override { return memory_; } // pinned memory has the same address on both sides
    void mark() override;
    const void* wait(const char* stage) override {
        check_cuda(cudaSetDevice(index_), "cudaSetDevice");
        check_cuda(cudaEventSynchronize(taken_), stage);
        return memory_;
    }

private:
    const CudaBackend& backend_;
    int index_;
    std::size_t bytes_;
    void* memory_ = nullptr;
    cudaEvent_t taken_ = nullptr;
};

class CudaBackend final : public DeviceBackend {
public:
    explicit CudaBackend(int index) : index_(index) {
        make_current();
        cudaDeviceProp properties{};
        check_cuda(cudaGetDeviceProperties(&properties, index), "cudaGetDeviceProperties");
        name_ = properties.name;
        streams_.push_back(make_stream());
    }
    ~CudaBackend() override {
        cudaSetDevice(index_);
        staging_.reset();
        for (const Stream& stream : streams_) {
            cudaEventDestroy(stream.reached);
            cudaStreamDestroy(stream.stream);
        }
    }
    CudaBackend(const CudaBackend&) = delete;
    CudaBackend& operator=(const CudaBackend&) = delete;

    void make_current() const override { check_cuda(cudaSetDevice(index_), "cudaSetDevice"); }
    std::string name() const override { return name_; }
    bool is_cuda() const override { return true; }
    int index() const override { return index_; }
    void* stream() const override { return current(); }
    void use_stream(int index) override { current_ = static_cast<std::size_t>(index); }
    void make_stream_wait(int waiting, int other) override {
        if (waiting == other) return;
        make_current();
        const auto both = static_cast<std::size_t>(std::max(waiting, other));
        while (streams_.size() <= both) streams_.push_back(make_stream());
        const Stream& first = streams_[static_cast<std::size_t>(other)];
        check_cuda(cudaEventRecord(first.reached, first.stream), "cudaEventRecord");
        check_cuda(cudaStreamWaitEvent(streams_[static_cast<std::size_t>(waiting)].stream, first.reached, 0),
                   "cudaStreamWaitEvent");
    }
    std::size_t free_bytes() const override {
        make_current();
        std::size_t free = 0, total = 0;
        check_cuda(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
        return free;
    }
    void* allocate(std::size_t bytes) override {
        make_current();
        void* memory = nullptr;
        const cudaError_t error = cudaMalloc(&memory, bytes);
        if (error == cudaErrorMemoryAllocation) {
            cudaGetLastError(); // clears it; the context is still valid
            return nullptr;
        }
        check_cuda(error, "cudaMalloc");
        return memory;
    }
    void free(void* memory) noexcept override {
        cudaSetDevice(index_);
        cudaFree(memory);
    }
    void copy_to_device(void* device, const void* host, std::size_t bytes) override {
        make_current();
        if (staging().is_there()) return staging().copy_to_device(device, host, bytes);
        check_cuda(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, current()), "copy to device");
        wait("copy to device"); // the host memory may be freed after the call
    }
    void copy_to_host(void* host, const void* device, std::size_t bytes) override {
        make_current();
        constexpr std::size_t kMany = std::size_t(1) << 20; // smaller copies are faster without staging
        if (bytes >= kMany && staging().is_there()) return staging().copy_to_host(host, device, bytes);
        check_cuda(cudaMemcpyAsync(host, device, bytes, cudaMemcpyDeviceToHost, current()), "copy to host");
        wait("copy to host");
    }
    void copy_on_device(void* to, const void* from, std::size_t bytes) override {
        make_current();
        check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, current()), "copy on device");
    }
    void fill(void* device, unsigned char value, std::size_t bytes) override {
        make_current();
        check_cuda(cudaMemsetAsync(device, value, bytes, current()), "fill");
    }
    void wait(const char* stage) override {
        make_current();
        check_cuda(cudaStreamSynchronize(current()), stage);
    }
    void check_launch(const char* stage) override {
        check_cuda(cudaGetLastError(), stage);
    } // error of the calling thread
    std::unique_ptr<TimeMark> make_time_mark() override {
        make_current();
        return std::make_unique<CudaTimeMark>(current(), index_);
    }
    std::unique_ptr<HostCopy> make_host_copy(std::size_t bytes) override {
        make_current();
        return std::make_unique<CudaHostCopy>(*this, index_, bytes);
    }

private:
    struct Stream {
        cudaStream_t stream = nullptr;
        cudaEvent_t reached = nullptr; // another stream waits for it
    };

    static Stream make_stream() {
        Stream made;
        check_cuda(cudaStreamCreateWithFlags(&made.stream, cudaStreamNonBlocking), "cudaStreamCreate");
        check_cuda(cudaEventCreateWithFlags(&made.reached, cudaEventDisableTiming), "cudaEventCreate");
        return made;
    }
    cudaStream_t current() const { return streams_[current_].stream; }
    PinnedStaging& staging() { // for stream 0, which makes all large copies
        if (!staging_) staging_.emplace(streams_[0].stream);
        return *staging_;
    }

    int index_;
    std::optional<PinnedStaging> staging_; // made by the first copy that needs it
    std::string name_;
    std::vector<Stream> streams_;
    std::size_t current_ = 0;
};

CudaHostCopy::CudaHostCopy(const CudaBackend& backend, int index, std::size_t bytes)
    : backend_(backend), index_(index), bytes_(bytes) {
    check_cuda(cudaMallocHost(&memory_, bytes), "cudaMallocHost");
    check_cuda(cudaEventCreateWithFlags(&taken_, cudaEventDisableTiming), "cudaEventCreate");
}

void CudaHostCopy::take(const void* device) {
    backend_.make_current();
    const auto stream = static_cast<cudaStream_t>(backend_.stream());
    check_cuda(cudaMemcpyAsync(memory_, device, bytes_, cudaMemcpyDeviceToHost, stream), "copy to host");
    mark();
}

void CudaHostCopy::mark() {
    backend_.make_current();
    check_cuda(cudaEventRecord(taken_, static_cast<cudaStream_t>(backend_.stream())), "cudaEventRecord");
}

} // namespace

int cuda_device_count() {
    int count = 0;
    const cudaError_t error = cudaGetDeviceCount(&count); // without a driver it does not write its argument
    return error == cudaSuccess ? count : 0;
}

std::vector<CudaDevice> cuda_devices() {
    std::vector<CudaDevice> devices;
    for (int index = 0; index < cuda_device_count(); ++index) {
        cudaDeviceProp properties{};
        if (cudaGetDeviceProperties(&properties, index) != cudaSuccess) properties.name[0] = '\0';
        devices.push_back({properties.name, properties.major, properties.minor, properties.totalGlobalMem});
    }
    return devices;
}

bool may_have_cuda() {
    // The library that CUDA's runtime would load; it stays loaded.
    return ::dlopen("libcuda.so.1", RTLD_LAZY | RTLD_LOCAL | RTLD_NODELETE) != nullptr;
}

std::string why_no_cuda(int index) {
    int driver = 0;
    cudaDriverGetVersion(&driver);
    if (driver == 0) return "no NVIDIA driver was found";
    int count = 0;
    const cudaError_t error = cudaGetDeviceCount(&count);
    if (error == cudaErrorInsufficientDriver) {
        return fmt::format("the NVIDIA driver supports CUDA {}.{}, the binary was built with {}.{}", driver / 1000,
                           driver % 1000 / 10, CUDART_VERSION / 1000, CUDART_VERSION % 1000 / 10);
    }
    if (error != cudaSuccess) return fmt::format("there is no CUDA device: {}", cudaGetErrorString(error));
    if (index < 0 || index >= count) {
        return fmt::format("there is no CUDA device {}; this machine has {}", index, count);
    }
    cudaDeviceProp properties{};
    if (cudaGetDeviceProperties(&properties, index) != cudaSuccess) return "the device does not respond";
    // The current device belongs to a thread. Another thread queries it, so that the caller's does not change, and no
    // context is created on the device to which it would be restored.
    bool has_code = false;
    std::thread([&] { has_code = cudaSetDevice(index) == cudaSuccess && has_code_for_current_device(); }).join();
    if (!has_code) {
        return fmt::format("{} has compute capability {}.{}, for which this binary contains no code; configure with "
                           "CMAKE_CUDA_ARCHITECTURES={}{}",
                           properties.name, properties.major, properties.minor, properties.major, properties.minor);
    }
    return {};
}

std::unique_ptr<DeviceBackend> make_cuda_backend(int index) {
    if (const std::string reason = why_no_cuda(index); !reason.empty())
        throw Error(ErrorCode::BadInput, "device", fmt::format("cuda:{}", index), reason);
    return std::make_unique<CudaBackend>(index);
}

} // namespace pertev
