#pragma once

// HD marks a function that runs on the host and in CUDA device code alike: no allocation, exceptions, globals,
// virtual calls or recursion in it. HD_CALL marks one that is rarely needed: kept out of line in device code, so that
// its registers do not count where it is not called. INLINE_ON_DEVICE, after HD, marks one that is inlined there
// whatever its size: what it is given by reference need not lie in memory then. PERTEV_HAS_KERNELS is 1 where kernels
// are compiled, PERTEV_ON_DEVICE in the device pass. Both are where a test emulates the device (PERTEV_EMULATED_WARPS,
// tests/support/emulated_device.h).

#if defined(__CUDACC__)
#define HD __host__ __device__
#define HD_CALL __host__ __device__ __noinline__
#define INLINE_ON_DEVICE __forceinline__
#else
#define HD
#define HD_CALL
#define INLINE_ON_DEVICE inline
#endif

#if defined(__CUDACC__) || defined(PERTEV_EMULATED_WARPS)
#define PERTEV_HAS_KERNELS 1
#else
#define PERTEV_HAS_KERNELS 0
#endif

#if defined(__CUDA_ARCH__) || defined(PERTEV_EMULATED_WARPS)
#define PERTEV_ON_DEVICE 1
#else
#define PERTEV_ON_DEVICE 0
#endif
