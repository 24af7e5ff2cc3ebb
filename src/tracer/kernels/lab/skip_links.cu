#include "trace/binary/skip_links_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_skip_links_kernels(std::vector<TraversalKernel>& rows) {
    add_unordered_kernels<SkipLinksTraversal>(TraversalKind::SkipLinks, rows);
}

} // namespace pertev
