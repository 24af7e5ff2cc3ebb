// Compiled for AVX-512 (tests/CMakeLists.txt), and empty where the program has no functions of sixteen lanes.

#if defined(PERTEV_HAS_16_LANES)

#include "tests/support/trace_many_16.h"
#include "math/lanes16.h"

namespace pertev::test {
namespace {

template <class Accept>
void trace_many(const HostTrees& scene, RayOrder order, std::span<const Ray> rays, const Accept& accept, Hit* hits,
                bool* occluded) {
    const auto count = static_cast<uint32_t>(rays.size());
    const auto ray_of = [&](uint32_t i) { return rays[i]; };
    const auto accept_of = [&](uint32_t) { return accept; };
    trace_closest_many<TraversalOptions{}, Floats16>(scene, count, order, ray_of, accept_of, hits);
    trace_any_many<TraversalOptions{.near_first = false}, Floats16>(scene, count, order, ray_of, accept_of, occluded);
}

} // namespace

void trace_many_by_16(const HostTrees& scene, RayOrder order, std::span<const Ray> rays, AcceptAll accept, Hit* hits,
                      bool* occluded) {
    trace_many(scene, order, rays, accept, hits, occluded);
}

void trace_many_by_16(const HostTrees& scene, RayOrder order, std::span<const Ray> rays, AcceptSome accept, Hit* hits,
                      bool* occluded) {
    trace_many(scene, order, rays, accept, hits, occluded);
}

} // namespace pertev::test

#endif
