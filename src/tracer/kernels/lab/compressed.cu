#include "trace/wide/compressed_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_compressed_kernels(std::vector<TraversalKernel>& rows) {
    add_other_kernels<CompressedTraversal, true>(TraversalKind::Compressed, rows);
    add_kernels<CompressedTraversal, TraversalOptions{.tests = TestKind::Fast, .rta_at_pops = false}, true>(
        TraversalKind::Compressed, rows);
}

} // namespace pertev
