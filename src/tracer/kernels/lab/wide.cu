#include "trace/wide/wide_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_wide_kernels(std::vector<TraversalKernel>& rows) {
    add_all_kernels<Wide4Traversal>(TraversalKind::Wide4, rows);
    add_all_kernels<Wide8Traversal>(TraversalKind::Wide8, rows);
}

} // namespace pertev
