#include "device/cuda/probe_architecture.h"

namespace pertev {
namespace {

__global__ void probe() {}

} // namespace

bool has_code_for_current_device() {
    cudaFuncAttributes attributes{};
    const cudaError_t error = cudaFuncGetAttributes(&attributes, probe);
    cudaGetLastError(); // clears it, because another device may work
    return error == cudaSuccess;
}

} // namespace pertev
