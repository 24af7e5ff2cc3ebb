#include "radiosity/hierarchical.h"

#include <algorithm>
#include <atomic>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "radiosity/link_factors.h"

namespace pertev {
namespace {

constexpr uint32_t kMaxPasses = 24, kSweeps = 3;
constexpr uint64_t kLinksAtOnce = 256; // their rays are traced together
constexpr float kRaysOfLimit = 8;      // rays of a link whose possible error equals the limit

/// The exception for too many links. It does not depend on the number of threads, because the links of a round are
/// counted and their sum does not depend on the order.
struct TooManyLinks {};

class Refiner {
public:
    Refiner(const SolvedScene& scene, LinkNodes& nodes, const RadiositySettings& settings, WorkWatch& watch,
            uint64_t max_links)
        : scene_(scene), nodes_(nodes), watch_(watch), seed_(settings.seed), max_links_(max_links),
          limit_(settings.link_error * nodes.mean_direct()) {}

    /// Refines links until each is accurate enough or waits for a patch to be subdivided. Links are refined by size,
    /// so that many can be processed in parallel from the start. After the time limit links do not change.
    void refine(std::vector<Link>& links) {
        divides_.assign(nodes_.tree().patches.size(), 0);
        for (uint32_t i = 0; i < divides_.size(); ++i) {
            const bool is_seen = !is_black(nodes_.tree().patches[i].reflectance);
            if (is_seen && nodes_.can_divide(kIsPatch | i) && nodes_.direct_changes(i, limit_)) divides_[i] = 1;
        }
        std::vector<Link> open = std::move(links);
        links = {};
        while (!open.empty() && !watch_.is_over()) {
            const uint64_t chunks = (open.size() + kLinksAtOnce - 1) / kLinksAtOnce;
            std::vector<Sorted> sorted(chunks);
            std::atomic<uint64_t> count =
                links.size(); // evaluated while they are generated, because memory does not suffice for all
            parallel_for_ranges(chunks, 1, [&](uint64_t begin, uint64_t end) {
                LinkFactors factors(scene_, nodes_, seed_);
                for (uint64_t chunk = begin; chunk < end; ++chunk) {
                    const uint64_t first = chunk * kLinksAtOnce, last = std::min(first + kLinksAtOnce, open.size());
                    sort_out({open.data() + first, last - first}, factors, sorted[chunk]);
                    const uint64_t made = sorted[chunk].kept.size() + sorted[chunk].open.size();
                    // Once the watch is over no more are made, and what there is has to be kept.
                    if (count.fetch_add(made) + made > max_links_ && !watch_.is_over()) throw TooManyLinks{};
                }
            });
            open = {};
            for (Sorted& some : sorted) {
                links.insert(links.end(), some.kept.begin(), some.kept.end());
                open.insert(open.end(), some.open.begin(), some.open.end());
                some = {};
            }
            watch_.set_share(static_cast<double>(links.size()) / static_cast<double>(links.size() + open.size() + 1));
        }
        links.insert(links.end(), open.begin(), open.end());
    }

    bool needs_division() const {
        return std::ranges::any_of(divides_, [](uint8_t divide) { return divide != 0; });
    }
    std::span<const uint8_t> divides() const { return divides_; }

private:
    struct Sorted {
        std::vector<Link> kept, open;
    };

    void sort_out(std::span<Link> links, LinkFactors& factors, Sorted& sorted) {
        std::vector<Link*> queued;
        factors.clear();
        for (Link& link : links) {
            if (watch_.is_over()) {
                sorted.kept.push_back(link);
                continue;
            }
            if (faces_away(link)) continue;
            const float most = max_light(link);
            const NodeCode divided = divided_of(link);
            if (most * min_share(link) > limit_ && divided != kNoPatch && !is_patch(divided)) {
                split(link, divided, sorted.open);
                continue;
            }
            const uint32_t rays = rays_for(most, divided);
            if (most > 0 && rays > 2 * link.rays) {
                factors.queue(link, rays);
                queued.push_back(&link);
            } else {
                decide(link, most, sorted);
            }
        }
        if (queued.empty()) return;
        factors.trace();
        for (Link* link : queued) {
            factors.answer(*link);
            decide(*link, max_light(*link), sorted);
        }
    }

    /// Number of rays for a link with at most `most` light, of which `divided` can be divided.
    uint32_t rays_for(float most, NodeCode divided) const {
        const bool is_last = divided == kNoPatch || is_patch(divided);
        const float largest = is_last ? kMaxRaysOfLink / kRaysOfLimit : 1.0f;
        const float share = limit_ > 0 ? min(most / limit_, largest) : largest;
        return max(1u, static_cast<uint32_t>(share * kRaysOfLimit));
    }

    /// Returns whether light cannot go this way.
    bool faces_away(const Link& link) const {
        if (!is_cluster(link.receiver)) {
            const LinkedPatch& receiver = nodes_.shape(link.receiver);
            if (!is_cluster(link.source) && !is_before(receiver, nodes_.shape(link.source))) return true;
            if (is_cluster(link.source) && !is_before(receiver, nodes_.ball(link.source))) return true;
        }
        if (is_cluster(link.source)) return false;
        const LinkedPatch& source = nodes_.shape(link.source);
        return is_cluster(link.receiver) ? !is_before(source, nodes_.ball(link.receiver))
                                         : !is_before(source, nodes_.shape(link.receiver));
    }

    /// Irradiance that a link could transport if all of its source were visible, W/m2.
    float max_light(const Link& link) const {
        const float sent = nodes_.max_sent(link.source);
        if (!(sent > 0)) return 0;
        const Ball &here = nodes_.ball(link.receiver), &there = nodes_.ball(link.source);
        float most = max_form_factor(here, there, nodes_.area(link.source)) * sent;
        if (!is_cluster(link.receiver)) { // no more arrives than leaves, all over the receiver
            most = min(most, luminance(nodes_.power(link.source)) / nodes_.area(link.receiver));
        }
        const Vec3 offset = here.centre - there.centre;
        const float distance = length(offset), nearest = distance - here.radius;
        if (!is_cluster(link.source) || !(nearest > 2 * there.radius)) return most;
        // A series of three terms may take a quarter of the power for none.
        const float towards = luminance(nodes_.power_towards(link.source, (1.0f / distance) * offset));
        const float power = max(towards, 0.25f * luminance(nodes_.power(link.source)));
        return min(most, power * kInvPi / square(nearest));
    }

    /// The larger node of a link that can be divided; kNoPatch if neither can.
    NodeCode divided_of(const Link& link) const {
        const bool receiver = nodes_.can_divide(link.receiver), source = nodes_.can_divide(link.source);
        if (!receiver && !source) return kNoPatch;
        const bool is_larger = nodes_.ball(link.receiver).radius > nodes_.ball(link.source).radius;
        return receiver && (is_larger || !source) ? link.receiver : link.source;
    }

    /// Share of the maximum light that is probably visible; in the middle of a cluster there is always something
    /// near.
    float share(const Link& link) const { return is_even(link) || link.rays == 0 ? 1.0f : link.visible(); }
    /// Lower bound of share().
    float min_share(const Link& link) const { return is_even(link) ? 1.0f : 1.0f / (kRaysOfLimit + 2); }
    bool is_even(const Link& link) const {
        const bool any_cluster = is_cluster(link.receiver) || is_cluster(link.source);
        return any_cluster && balls_meet(nodes_.ball(link.receiver), nodes_.ball(link.source));
    }

    void decide(const Link& link, float most, Sorted& sorted) {
        const NodeCode divided = divided_of(link);
        if (!(most * share(link) > limit_) || divided == kNoPatch) {
            sorted.kept.push_back(link);
        } else if (is_patch(divided)) {
            std::atomic_ref(divides_[number_of(divided)]).store(1, std::memory_order_relaxed);
            sorted.kept.push_back(link);
        } else {
            split(link, divided, sorted.open);
        }
    }

    void split(const Link& link, NodeCode divided, std::vector<Link>& open) const {
        const auto add = [&](NodeCode part) {
            open.push_back(divided == link.receiver ? Link{part, link.source} : Link{link.receiver, part});
        };
        if (is_cluster(divided)) {
            const Cluster& cluster = nodes_.cluster(divided);
            add(nodes_.code_of_cluster(cluster.left));
            add(nodes_.code_of_cluster(cluster.right));
        } else {
            for (const PatchCode child : nodes_.quad(divided).child) add(child);
        }
    }

    const SolvedScene& scene_;
    LinkNodes& nodes_;
    WorkWatch& watch_;
    uint32_t seed_;
    uint64_t max_links_;
    float limit_;                  // maximum light that a link may represent, W/m2
    std::vector<uint8_t> divides_; // [patches] whether to divide
};

HierarchicalSolution solve_by_links(const SolvedScene& scene, PatchTree coarse, float patch_size,
                                    const RadiositySettings& settings, WorkWatch& watch, uint64_t max_links) {
    LinkNodes nodes(scene, std::move(coarse), patch_size, settings, watch);
    Refiner refiner(scene, nodes, settings, watch, max_links);
    HierarchicalSolution solution;
    solution.link_error = settings.link_error;
    solution.without_direct = nodes.without_direct();
    std::vector<Link> links = {{nodes.root(), nodes.root()}};
    bool is_done = false;
    while (!is_done && !watch.is_over() && solution.passes < kMaxPasses) {
        if (solution.passes > 0 && refiner.needs_division()) {
            nodes.divide(refiner.divides());
            for (Link& link : links) link = nodes.after_division(link);
        }
        watch.begin(fmt::format("links, pass {}", solution.passes + 1), 0);
        refiner.refine(links);
        if (watch.is_over() && solution.passes == 0) break; // links that do not exist yet would transport nothing
        nodes.sort(links);
        for (uint32_t k = 0; k < kSweeps; ++k) solution.left = nodes.sweep(links);
        ++solution.passes;
        is_done = !refiner.needs_division() && !(solution.left > static_cast<double>(settings.tolerance));
    }
    solution.links = links.size();
    solution.bytes = links.size() * sizeof(Link) + nodes.bytes();
    solution.reached_limit = !is_done && !watch.is_over();
    solution.irradiance = solution.passes > 0 ? nodes.irradiance() : nodes.direct();
    solution.tree = nodes.take_tree();
    return solution;
}
} // namespace

std::size_t max_hierarchical_bytes(uint64_t patches, uint64_t triangles) {
    const uint64_t nodes = 3 * patches; // clusters, patches and their subdivisions
    const uint64_t most = nodes < 100000 ? nodes * nodes : kMaxLinks;
    const std::size_t links = 3 * std::min(most, kMaxLinks) * sizeof(Link);
    return std::max(links, LinkNodes::max_first_bytes(std::min(patches, 2 * triangles))) +
           LinkNodes::max_bytes(patches, patches);
}

HierarchicalSolution solve_hierarchically(const SolvedScene& scene, PatchTree coarse, float patch_size,
                                          const RadiositySettings& settings, WorkWatch& watch, uint64_t max_links) {
    RadiositySettings tried = settings;
    for (;; tried.link_error *= 2) {
        try {
            return solve_by_links(scene, coarse, patch_size, tried, watch, max_links);
        } catch (const TooManyLinks&) {
            if (tried.link_error > kLargestLinkError / 2) break;
            watch.set_note(fmt::format(", again with `link_error={}`", 2 * tried.link_error));
        }
    }
    throw Error(ErrorCode::OverLimit, "solver", "hierarchical",
                fmt::format("more than {} links with any `link_error` (use a larger `patch_size` or another `solver`)",
                            max_links));
}

} // namespace pertev
