#include "trace/wide/wide_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_wide_kernels(std::vector<WalkKernel>& rows) {
    add_all_kernels<Wide4Walk>(WalkKind::Wide4, rows);
    add_all_kernels<Wide8Walk>(WalkKind::Wide8, rows);
}

} // namespace pertev
