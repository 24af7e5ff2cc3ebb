#include "trace/binary/parent_links_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_parent_links_kernels(std::vector<TraversalKernel>& rows) {
    add_all_kernels<ParentLinksTraversal>(TraversalKind::ParentLinks, rows);
}

} // namespace pertev
