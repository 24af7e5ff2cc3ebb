#pragma once

// Converts the results of CUDA calls to errors.

#include <cuda_runtime.h>

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {

/// Throws Error(DeviceFault) that names `stage` and the fault.
inline void check_cuda(cudaError_t error, const char* stage) {
    if (error == cudaSuccess) return;
    throw Error(ErrorCode::DeviceFault,
                fmt::format("CUDA failed in {}: {} ({})", stage, cudaGetErrorString(error), cudaGetErrorName(error)));
}

} // namespace pertev
