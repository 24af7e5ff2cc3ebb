#include "trace/binary/if_if_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_if_if_kernels(std::vector<TraversalKernel>& rows) {
    add_all_kernels<IfIfTraversal>(TraversalKind::IfIf, rows);
}

} // namespace pertev
