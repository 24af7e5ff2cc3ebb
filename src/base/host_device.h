#pragma once

// HD marks a function for the host and CUDA device code: it has no allocation, exceptions, globals, virtual calls or
// recursion. HD_CALL marks one that is rarely needed: it is not inlined in device code, so that its registers do not
// count where it is not called. INLINE_ON_DEVICE, after HD, marks one that is always inlined there, so that its
// reference arguments need not be in memory. PERTEV_HAS_KERNELS is 1 where kernels are compiled, PERTEV_ON_DEVICE in
// the device pass. Both are 1 where a test emulates the device (PERTEV_EMULATED_WARPS,
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
