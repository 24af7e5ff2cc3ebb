#include "device/backend.h"

#include <cuda_runtime.h>

#include <optional>
#include <thread>

#include <fmt/format.h>

#include "base/error.h"
#include "device/cuda/check_cuda.h"
#include "device/cuda/pinned_staging.h"
#include "device/cuda/probe_architecture.h"

namespace pertev {
namespace {

class CudaTimeMark final : public TimeMark {
public:
    /// Device `index` is the current one.
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
        check_cuda(cudaEventSynchronize(event_), "the work before a time mark"); // where a fault of that work shows
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

class CudaBackend final : public DeviceBackend {
public:
    explicit CudaBackend(int index) : index_(index) {
        make_current();
        cudaDeviceProp properties{};
        check_cuda(cudaGetDeviceProperties(&properties, index), "cudaGetDeviceProperties");
        name_ = properties.name;
        check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "cudaStreamCreate");
    }
    ~CudaBackend() override {
        cudaSetDevice(index_);
        staging_.reset();
        cudaStreamDestroy(stream_);
    }
    CudaBackend(const CudaBackend&) = delete;
    CudaBackend& operator=(const CudaBackend&) = delete;

    void make_current() const override { check_cuda(cudaSetDevice(index_), "cudaSetDevice"); }
    std::string name() const override { return name_; }
    bool is_cuda() const override { return true; }
    void* stream() const override { return stream_; }
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
            cudaGetLastError(); // clears it: the context is still good
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
        check_cuda(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream_), "copy to device");
        wait("copy to device"); // the host memory may go away after the call
    }
    void copy_to_host(void* host, const void* device, std::size_t bytes) override {
        make_current();
        constexpr std::size_t kMany = std::size_t(1) << 20; // fewer are there sooner without a stop on the way
        if (bytes >= kMany && staging().is_there()) return staging().copy_to_host(host, device, bytes);
        check_cuda(cudaMemcpyAsync(host, device, bytes, cudaMemcpyDeviceToHost, stream_), "copy to host");
        wait("copy to host");
    }
    void fill(void* device, unsigned char value, std::size_t bytes) override {
        make_current();
        check_cuda(cudaMemsetAsync(device, value, bytes, stream_), "fill");
    }
    void wait(const char* stage) override {
        make_current();
        check_cuda(cudaStreamSynchronize(stream_), stage);
    }
    void check_launch(const char* stage) override { check_cuda(cudaGetLastError(), stage); } // of the calling thread
    std::unique_ptr<TimeMark> make_time_mark() override {
        make_current();
        return std::make_unique<CudaTimeMark>(stream_, index_);
    }

private:
    PinnedStaging& staging() {
        if (!staging_) staging_.emplace(stream_);
        return *staging_;
    }

    int index_;
    std::optional<PinnedStaging> staging_; // from the first copy that needs it
    std::string name_;
    cudaStream_t stream_ = nullptr;
};

} // namespace

int cuda_device_count() {
    int count = 0;
    const cudaError_t error = cudaGetDeviceCount(&count); // without a driver it does not write its argument
    return error == cudaSuccess ? count : 0;
}

std::string why_no_cuda(int index) {
    int count = 0;
    const cudaError_t error = cudaGetDeviceCount(&count);
    if (error == cudaErrorInsufficientDriver) {
        int driver = 0;
        cudaDriverGetVersion(&driver);
        if (driver == 0) return "no NVIDIA driver was found";
        return fmt::format("the NVIDIA driver supports CUDA {}.{}, the binary was built with {}.{}", driver / 1000,
                           driver % 1000 / 10, CUDART_VERSION / 1000, CUDART_VERSION % 1000 / 10);
    }
    if (error != cudaSuccess) return fmt::format("no CUDA device: {}", cudaGetErrorString(error));
    if (index < 0 || index >= count) {
        return fmt::format("there is no CUDA device {}; this machine has {}", index, count);
    }
    cudaDeviceProp properties{};
    if (cudaGetDeviceProperties(&properties, index) != cudaSuccess) return "the device does not answer";
    // The current device belongs to a thread. Asked on another one, the caller's stays as it was, and no context is
    // made on the device that this would go back to.
    bool has_code = false;
    std::thread([&] { has_code = cudaSetDevice(index) == cudaSuccess && has_code_for_current_device(); }).join();
    if (!has_code) {
        return fmt::format("{} is of architecture {}.{}, which this binary holds no code for; configure with "
                           "CMAKE_CUDA_ARCHITECTURES={}{}",
                           properties.name, properties.major, properties.minor, properties.major, properties.minor);
    }
    return {};
}

std::unique_ptr<DeviceBackend> make_cuda_backend(int index) {
    if (const std::string reason = why_no_cuda(index); !reason.empty()) throw Error(ErrorCode::BadInput, reason);
    return std::make_unique<CudaBackend>(index);
}

} // namespace pertev
