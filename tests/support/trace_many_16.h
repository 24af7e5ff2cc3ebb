#pragma once

// Many rays in packets of sixteen lanes, in a file that is compiled for processors with AVX-512.

#include <span>

#include "tests/support/accept_some.h"
#include "trace/wide/trace_many.h"

namespace pertev::test {

#if defined(PERTEV_HAS_16_LANES)
/// trace_closest_many and trace_any_many with Floats16, only for processors that have_sixteen_lanes.
void trace_many_by_16(const HostTrees& scene, RayOrder order, std::span<const Ray> rays, AcceptAll accept, Hit* hits,
                      bool* occluded);
void trace_many_by_16(const HostTrees& scene, RayOrder order, std::span<const Ray> rays, AcceptSome accept, Hit* hits,
                      bool* occluded);
#endif

} // namespace pertev::test
