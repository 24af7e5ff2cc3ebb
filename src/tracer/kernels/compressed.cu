#include "trace/wide/compressed_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

/// Rendering uses these for bounce and shadow rays.
template <>
inline constexpr bool kOfPictures<CompressedWalk<WalkOptions{.rta_at_pops = false}>> = true;
template <>
inline constexpr bool kOfPictures<CompressedWalk<for_any_hit(WalkOptions{})>> = true;

void add_compressed_kernels(std::vector<WalkKernel>& rows) {
    add_all_kernels<CompressedWalk, true>(WalkKind::Compressed, rows);
    add_kernels<CompressedWalk, WalkOptions{.rta_at_pops = false}, true>(WalkKind::Compressed, rows);
    add_kernels<CompressedWalk, WalkOptions{.tests = TestKind::Fast, .rta_at_pops = false}, true>(WalkKind::Compressed,
                                                                                                  rows);
}

} // namespace pertev
