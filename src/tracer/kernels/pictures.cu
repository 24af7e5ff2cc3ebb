// The traversals that pictures take by default (tracer/tracer_choice.h), and the one of single rays that are measured.

#include "trace/binary/octant_walk.h"
#include "trace/binary/while_while_walk.h"
#include "trace/wide/compressed_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

/// Rendering uses it for camera rays.
template <>
inline constexpr bool kOfPictures<OctantWalk<WalkOptions{}>> = true;
/// Rendering uses these for bounce and shadow rays.
template <>
inline constexpr bool kOfPictures<CompressedWalk<WalkOptions{.rta_at_pops = false}>> = true;
template <>
inline constexpr bool kOfPictures<CompressedWalk<for_any_hit(WalkOptions{})>> = true;

void add_picture_kernels(std::vector<WalkKernel>& rows) {
    add_kernels<OctantWalk, WalkOptions{}, false>(WalkKind::Octants, rows);
    add_kernels<CompressedWalk, WalkOptions{}, true>(WalkKind::Compressed, rows);
    add_kernels<CompressedWalk, WalkOptions{.rta_at_pops = false}, true>(WalkKind::Compressed, rows);
    add_kernels<WhileWhileWalk, WalkOptions{}, true>(WalkKind::WhileWhile, rows);
}

} // namespace pertev
