#include "device/peer_copy.h"

#include <mutex>
#include <set>
#include <utility>

#include <cuda_runtime.h>

#include "device/cuda/check_cuda.h"

namespace pertev {

CopyPath cuda_copy_path(int from, int to) {
    if (from == to) return CopyPath::Memory;
    int can = 0, has_atomics = 0;
    if (cudaDeviceCanAccessPeer(&can, to, from) != cudaSuccess || can == 0) {
        cudaGetLastError(); // clears it
        return CopyPath::Host;
    }
    // Atomics on another GPU's memory are what NVLink has and PCIe lacks.
    const cudaError_t error = cudaDeviceGetP2PAttribute(&has_atomics, cudaDevP2PAttrNativeAtomicSupported, from, to);
    if (error != cudaSuccess) cudaGetLastError();
    return has_atomics != 0 ? CopyPath::NvLink : CopyPath::Pcie;
}

void allow_copies_between_gpus(Queue& to, int from) {
    // Access belongs to the process, and to allow it twice is an error of the driver.
    static std::mutex mutex;
    static std::set<std::pair<int, int>> allowed;
    const std::scoped_lock lock(mutex);
    if (!allowed.emplace(to.device_index(), from).second) return;
    const Queue::Scope scope(to, "copy between devices");
    if (cudaDeviceEnablePeerAccess(from, 0) != cudaSuccess) {
        cudaGetLastError(); // the driver takes the path through the host
    }
}

void copy_between_gpus(Queue& to, void* into, int from, const void* source, std::size_t bytes) {
    const Queue::Scope scope(to, "copy between devices");
    const auto stream = static_cast<cudaStream_t>(to.stream());
    if (from == to.device_index()) {
        return check_cuda(cudaMemcpyAsync(into, source, bytes, cudaMemcpyDeviceToDevice, stream), "copy on device");
    }
    check_cuda(cudaMemcpyPeerAsync(into, to.device_index(), source, from, bytes, stream), "copy between devices");
}

} // namespace pertev
