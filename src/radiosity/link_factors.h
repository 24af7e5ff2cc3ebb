#pragma once

// Factors of links: geometry in closed form, and rays for visibility. Links are requested in batches, so that their
// rays are traced together.

#include <memory>
#include <vector>

#include "device_scene/find_hits.h"
#include "radiosity/light_rays.h"
#include "radiosity/link_nodes.h"

namespace pertev {

class LinkFactors {
public:
    /// Makes the factors of links; `scene` and `nodes` outlive it.
    LinkFactors(const SolvedScene& scene, const LinkNodes& nodes, uint32_t seed)
        : scene_(scene), nodes_(nodes), seed_(seed) {}

    void clear();
    /// Requests the factor of `link` with `rays` rays, at most kMaxRaysOfLink.
    void queue(const Link& link, uint32_t rays);
    /// Traces the rays of all requests.
    void trace();
    /// Returns the next result, in the order of the requests.
    void answer(Link& link);

private:
    struct VisibilityRay {
        Ray ray;
        TriangleId start, target;
        float weight; // weight if it is visible
    };
    struct QueuedLink {
        uint32_t first = 0, count = 0; // range of visibility tests
        float known = 0;               // sum of the parts that are visible without a ray
        float scale = 1;               // factor of the sum of weights
        uint32_t rays = 0, seen = 0;   // rays traced, and free without a ray
    };
    void queue_patches(const Link& link, uint32_t rays, uint32_t key, QueuedLink& queued);
    void queue_clusters(const Link& link, uint32_t rays, uint32_t key, QueuedLink& queued);
    PatchCode triangle_of(NodeCode code, double u) const;
    bool test_visibility(const Patch& from, const PatchPoint& start, const Patch& to, const PatchPoint& target,
                         float weight);

    const SolvedScene& scene_;
    const LinkNodes& nodes_;
    uint32_t seed_;
    std::vector<VisibilityRay> visibility_rays_;
    std::vector<QueuedLink> queued_;
    std::unique_ptr<bool[]> are_occluded_;
    std::size_t max_rays_ = 0;
    std::size_t next_ = 0;
};

} // namespace pertev
