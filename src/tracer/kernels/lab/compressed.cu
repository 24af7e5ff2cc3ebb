#include "trace/wide/compressed_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_compressed_kernels(std::vector<WalkKernel>& rows) {
    add_other_kernels<CompressedWalk, true>(WalkKind::Compressed, rows);
    add_kernels<CompressedWalk, WalkOptions{.tests = TestKind::Fast, .rta_at_pops = false}, true>(WalkKind::Compressed,
                                                                                                  rows);
}

} // namespace pertev
