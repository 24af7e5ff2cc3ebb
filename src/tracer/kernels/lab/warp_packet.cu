// Packet traversal by warps. The CPU's packets are in host_traversals.cpp.

#include "trace/binary/warp_packet_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

#if defined(__CUDACC__)
void add_warp_packet_kernels(std::vector<TraversalKernel>& rows) {
    add_all_kernels<WarpPacketTraversal>(TraversalKind::Packet, rows);
}
#else
void add_warp_packet_kernels(std::vector<TraversalKernel>&) {}
#endif

} // namespace pertev
