#pragma once

// HD marks a function that runs on the host and in CUDA device code alike: no allocation, exceptions, globals,
// virtual calls or recursion in it. PERTEV_ON_DEVICE is 1 in the device pass.

#if defined(__CUDACC__)
#define HD __host__ __device__
#else
#define HD
#endif

#if defined(__CUDA_ARCH__)
#define PERTEV_ON_DEVICE 1
#else
#define PERTEV_ON_DEVICE 0
#endif
