// Packets of a warp. The CPU has packets of its own (host_walks.cpp).

#include "trace/binary/warp_packet_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

#if defined(__CUDACC__)
void add_warp_packet_kernels(std::vector<WalkKernel>& rows) { add_all_kernels<WarpPacketWalk>(WalkKind::Packet, rows); }
#else
void add_warp_packet_kernels(std::vector<WalkKernel>&) {}
#endif

} // namespace pertev
