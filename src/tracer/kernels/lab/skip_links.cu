#include "trace/binary/skip_links_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_skip_links_kernels(std::vector<WalkKernel>& rows) {
    add_unordered_kernels<SkipLinksWalk>(WalkKind::SkipLinks, rows);
}

} // namespace pertev
