#include "trace/binary/octant_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

/// Rendering uses it for camera rays.
template <>
inline constexpr bool kOfPictures<OctantWalk<WalkOptions{}>> = true;

void add_octant_kernels(std::vector<WalkKernel>& rows) { add_all_kernels<OctantWalk>(WalkKind::Octants, rows); }

} // namespace pertev
