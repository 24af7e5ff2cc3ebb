#include "trace/binary/short_stack_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_short_stack_kernels(std::vector<TraversalKernel>& rows) {
    add_all_kernels<ShortStackTraversal>(TraversalKind::ShortStack, rows);
}

} // namespace pertev
