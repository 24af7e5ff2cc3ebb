#include "lab/measure_rays.h"

#include <algorithm>

namespace pertev {

WorkSummary summarize_work(const std::vector<RayWork>& work) {
    WorkSummary summary;
    uint64_t nodes = 0, triangles = 0;
    for (const RayWork& ray : work) {
        nodes += ray.nodes;
        triangles += ray.triangles;
        summary.max_nodes = max(summary.max_nodes, ray.nodes);
        summary.max_triangles = max(summary.max_triangles, ray.triangles);
    }
    const double rays = static_cast<double>(std::max<std::size_t>(work.size(), 1));
    summary.nodes = static_cast<double>(nodes) / rays;
    summary.triangles = static_cast<double>(triangles) / rays;
    return summary;
}

double hit_share(const std::vector<RayHit>& hits) {
    const auto count = std::ranges::count_if(hits, &RayHit::is_hit);
    return hits.empty() ? 0.0 : static_cast<double>(count) / static_cast<double>(hits.size());
}

} // namespace pertev
