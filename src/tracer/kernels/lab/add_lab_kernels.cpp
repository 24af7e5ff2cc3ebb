// The laboratory's traversals, a library of their own: a build without it is much sooner done.

#include <vector>

#include "tracer/traversal_kernels.h"

namespace pertev {

void add_if_if_kernels(std::vector<TraversalKernel>& rows);
void add_while_while_kernels(std::vector<TraversalKernel>& rows);
void add_speculative_kernels(std::vector<TraversalKernel>& rows);
void add_octant_kernels(std::vector<TraversalKernel>& rows);
void add_restart_trail_kernels(std::vector<TraversalKernel>& rows);
void add_short_stack_kernels(std::vector<TraversalKernel>& rows);
void add_parent_links_kernels(std::vector<TraversalKernel>& rows);
void add_skip_links_kernels(std::vector<TraversalKernel>& rows);
void add_compressed_kernels(std::vector<TraversalKernel>& rows);
void add_kd_tree_kernels(std::vector<TraversalKernel>& rows);
void add_octree_kernels(std::vector<TraversalKernel>& rows);
void add_brute_force_kernels(std::vector<TraversalKernel>& rows);
void add_wide_kernels(std::vector<TraversalKernel>& rows);
void add_warp_packet_kernels(std::vector<TraversalKernel>& rows);
void add_host_lab_kernels(std::vector<TraversalKernel>& rows);

void add_lab_kernels(std::vector<TraversalKernel>& rows) {
    add_if_if_kernels(rows);
    add_while_while_kernels(rows);
    add_speculative_kernels(rows);
    add_octant_kernels(rows);
    add_restart_trail_kernels(rows);
    add_short_stack_kernels(rows);
    add_parent_links_kernels(rows);
    add_skip_links_kernels(rows);
    add_compressed_kernels(rows);
    add_kd_tree_kernels(rows);
    add_octree_kernels(rows);
    add_brute_force_kernels(rows);
    add_wide_kernels(rows);
    add_warp_packet_kernels(rows);
    add_host_lab_kernels(rows);
}

} // namespace pertev
