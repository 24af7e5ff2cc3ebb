#include "trace/binary/speculative_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_speculative_kernels(std::vector<TraversalKernel>& rows) {
    add_all_kernels<SpeculativeTraversal, true>(TraversalKind::Speculative, rows);
    add_woop_kernels<SpeculativeTraversal>(TraversalKind::Speculative, rows);
}

} // namespace pertev
