#include "device/wait_for_device.h"

#include <cuda_runtime.h>

#include "device/cuda/check_cuda.h"

namespace pertev {

void wait_for_device(const Queue& queue) {
    if (!queue.is_cuda() || queue.is_dry_run()) return;
    check_cuda(cudaSetDevice(queue.device_index()), "cudaSetDevice");
    check_cuda(cudaDeviceSynchronize(), "cudaDeviceSynchronize"); // all streams of the context that it shares
}

} // namespace pertev
