#include "trace/binary/parent_links_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_parent_links_kernels(std::vector<WalkKernel>& rows) {
    add_all_kernels<ParentLinksWalk>(WalkKind::ParentLinks, rows);
}

} // namespace pertev
