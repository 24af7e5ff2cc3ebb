#include "tracer/traversal_kernels.h"

#include <algorithm>

namespace pertev {

// Each is defined in a file in kernels/ or kernels/lab/.
void add_picture_kernels(std::vector<TraversalKernel>& rows);
void add_host_kernels(std::vector<TraversalKernel>& rows);
#if defined(PERTEV_LAB_KERNELS)
void add_lab_kernels(std::vector<TraversalKernel>& rows);
#endif

namespace {

std::vector<TraversalKernel> all_kernels() {
    std::vector<TraversalKernel> rows;
    add_picture_kernels(rows);
    add_host_kernels(rows);
#if defined(PERTEV_LAB_KERNELS)
    add_lab_kernels(rows);
#endif
    return rows;
}

} // namespace

std::optional<std::string> why_no_tracer(const Combination& c, bool on_cuda) {
    if (auto reason = why_not(c, on_cuda)) return reason;
    if (find_kernel(c, false, on_cuda) != nullptr) return std::nullopt;
#if !defined(PERTEV_LAB_KERNELS)
    return "not in this build, which has only the default traversals of pictures; setup.sh builds all with its option "
           "'lab' "
           "(CMake: PERTEV_LAB_KERNELS=ON)";
#endif
    if (!c.options.is_exact()) return "fast and woop tests are compiled only with RTA and nearer children first";
    return c.options.rta_at_pops ? "not compiled" : "RTA at nodes only is compiled only with nearer children first";
}

const TraversalKernel* find_kernel(const Combination& c, bool any_hit, bool on_cuda) {
    static const std::vector<TraversalKernel> rows = all_kernels();
    const auto at = std::ranges::find_if(rows, [&](const TraversalKernel& row) {
        // An any-hit search has no nearest hit to skip beyond: RTA on or off, it is the same traversal.
        const bool rta =
            any_hit || (row.options.rta == c.options.rta && row.options.rta_at_pops == c.options.rta_at_pops);
        return (on_cuda ? row.on_cuda : row.on_cpu) && row.traversal == c.traversal &&
               row.distribution == c.distribution && row.any_hit == any_hit && rta &&
               row.options.near_first == c.options.near_first && row.options.tests == c.options.tests;
    });
    return at == rows.end() ? nullptr : &*at;
}

} // namespace pertev
