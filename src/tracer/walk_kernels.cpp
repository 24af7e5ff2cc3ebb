#include "tracer/walk_kernels.h"

#include <algorithm>

namespace pertev {

// Each is defined in a file in kernels/.
void add_if_if_kernels(std::vector<WalkKernel>& rows);
void add_while_while_kernels(std::vector<WalkKernel>& rows);
void add_speculative_kernels(std::vector<WalkKernel>& rows);
void add_octant_kernels(std::vector<WalkKernel>& rows);
void add_restart_trail_kernels(std::vector<WalkKernel>& rows);
void add_short_stack_kernels(std::vector<WalkKernel>& rows);
void add_parent_links_kernels(std::vector<WalkKernel>& rows);
void add_skip_links_kernels(std::vector<WalkKernel>& rows);
void add_compressed_kernels(std::vector<WalkKernel>& rows);
void add_kd_tree_kernels(std::vector<WalkKernel>& rows);
void add_octree_kernels(std::vector<WalkKernel>& rows);
void add_brute_force_kernels(std::vector<WalkKernel>& rows);
void add_wide_kernels(std::vector<WalkKernel>& rows);
void add_warp_packet_kernels(std::vector<WalkKernel>& rows);
void add_host_kernels(std::vector<WalkKernel>& rows);

namespace {

std::vector<WalkKernel> all_kernels() {
    std::vector<WalkKernel> rows;
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
    add_host_kernels(rows);
    return rows;
}

} // namespace

std::optional<std::string> why_no_tracer(const Combination& c, bool on_cuda) {
    if (auto reason = why_not(c, on_cuda)) return reason;
    if (find_kernel(c, false, on_cuda) != nullptr) return std::nullopt;
    if (!c.options.is_exact()) return "fast and woop tests are compiled with rta and near alone";
    return c.options.rta_at_pops ? "not compiled" : "RTA at nodes alone is compiled with near alone";
}

const WalkKernel* find_kernel(const Combination& c, bool any_hit, bool on_cuda) {
    static const std::vector<WalkKernel> rows = all_kernels();
    const auto at = std::ranges::find_if(rows, [&](const WalkKernel& row) {
        // An any-hit search has no nearest hit that RTA could compare with, so both switches give the same traversal.
        const bool rta =
            any_hit || (row.options.rta == c.options.rta && row.options.rta_at_pops == c.options.rta_at_pops);
        return (on_cuda ? row.on_cuda : row.on_cpu) && row.walk == c.walk && row.distribution == c.distribution &&
               row.any_hit == any_hit && rta && row.options.near_first == c.options.near_first &&
               row.options.tests == c.options.tests;
    });
    return at == rows.end() ? nullptr : &*at;
}

} // namespace pertev
