#include "trace/binary/speculative_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_speculative_kernels(std::vector<WalkKernel>& rows) {
    add_all_kernels<SpeculativeWalk, true>(WalkKind::Speculative, rows);
    add_woop_kernels<SpeculativeWalk>(WalkKind::Speculative, rows);
}

} // namespace pertev
