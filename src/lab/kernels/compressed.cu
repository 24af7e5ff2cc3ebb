#include "lab/kernels/walk_kernels_body.h"
#include "trace/compressed_walk.h"

namespace pertev {

void add_compressed_kernels(std::vector<WalkKernel>& rows) {
    add_all_kernels<CompressedWalk, true>(WalkKind::Compressed, rows);
}

} // namespace pertev
