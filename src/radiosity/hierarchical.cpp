#include "radiosity/hierarchical.h"

#include <atomic>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "radiosity/light_rays.h"
#include "radiosity/link_oracle.h"
#include "render/find_hits.h"

namespace pertev {
namespace {

/// A source: a cluster's number with this bit, or a PatchCode.
constexpr uint32_t kIsCluster = 0x40000000u;
constexpr bool is_cluster(uint32_t source) { return source < kIsPatch && (source & kIsCluster) != 0; }
constexpr float kUnknown = -1;
constexpr uint32_t kMostPasses = 24, kSweeps = 3;
constexpr uint32_t kMostRaysOfLink = 8, kLightRays = 64;
constexpr uint64_t kFacesAtOnce = 1024; // between two looks at whether to go on

struct Link {
    PatchCode receiver;
    uint32_t source;
    float factor; // of a patch's radiosity, or of what a cluster sends this way (W); kUnknown: not looked at yet
};

class Hierarchy {
public:
    Hierarchy(const SolvedScene& scene, PatchTree coarse, float patch_size, const RadiositySettings& settings)
        : scene_(scene), view_(scene.view()), settings_(settings), tree_(std::move(coarse)), patch_size_(patch_size) {
        PERTEV_CHECK(tree_.quads.empty());
        add_patches();
        std::vector<uint32_t> faces;
        std::vector<Ball> balls;
        for (uint32_t face = 0; face < tree_.roots.size(); ++face) {
            if (tree_.roots[face] == kNoPatch) continue;
            faces.push_back(face);
            balls.push_back(shape(tree_.roots[face]).ball);
        }
        clusters_ = make_clusters(faces, balls);
        sent_.resize(clusters_.clusters.size());
        links_.resize(clusters_.faces.size());
        for (std::size_t i = 0; i < links_.size(); ++i) {
            links_[i] = {{tree_.roots[clusters_.faces[i]], kIsCluster, kUnknown}};
        }
        set_limit();
    }

    /// Divides links, and says which patches are to be divided. False where none is. `progress` is told the share that
    /// is done; after it was false links stay as they are.
    bool refine(const std::function<bool(double)>& progress) {
        wishes_.assign(tree_.patches.size(), 0);
        bool goes_on = true;
        for (uint64_t first = 0; first < links_.size(); first += kFacesAtOnce) {
            const uint64_t count = std::min(kFacesAtOnce, links_.size() - first);
            parallel_for(count, 16, [&](uint64_t k) { refine_links(links_[first + k], goes_on); });
            goes_on = goes_on && progress(static_cast<double>(first + count) / static_cast<double>(links_.size()));
        }
        became_.clear();
        uint64_t count = 0;
        for (const std::vector<Link>& links : links_) count += links.size();
        if (count > kMostLinks) {
            throw Error(ErrorCode::OverLimit,
                        fmt::format("--solver hierarchical: {} links; at most {} (a larger --link-error makes fewer)",
                                    count, kMostLinks));
        }
        link_count_ = count;
        return std::ranges::any_of(wishes_, [](uint8_t wish) { return wish != 0; });
    }

    /// Gathers over all links, and passes light up and down. Returns the share of the light that has changed.
    double sweep() {
        parallel_for(links_.size(), 16, [&](uint64_t i) {
            const PatchCode root = tree_.roots[clusters_.faces[i]];
            clear(root);
            for (const Link& link : links_[i]) gathered(link.receiver) += light_of(link);
        });
        std::vector<double> changed(links_.size()), all(links_.size());
        parallel_for(links_.size(), 16,
                     [&](uint64_t i) { push(tree_.roots[clusters_.faces[i]], {}, changed[i], all[i]); });
        send();
        double change = 0, sum = 0;
        for (std::size_t i = 0; i < changed.size(); ++i) change += changed[i], sum += all[i];
        return sum > 0 ? change / sum : 0;
    }

    void divide() {
        became_.assign(wishes_.size(), kNoPatch);
        const auto before = static_cast<uint32_t>(wishes_.size());
        for (uint32_t i = 0; i < before; ++i) {
            if (wishes_[i] == 0 || tree_.patches.size() + 3 > kMostPatches) continue;
            const auto quad = static_cast<uint32_t>(tree_.quads.size());
            quad_shapes_.push_back(patch_shapes_[i]);
            quad_patches_.push_back(tree_.patches[i]);
            quad_sent_.push_back(patch_sent_[i]);
            quad_gathered_.push_back({});
            tree_.split(view_, i);
            became_[i] = quad;
            patch_shapes_[i] = linked_patch(view_, tree_.patches[i]);
            stale_.push_back(i);
        }
        add_patches();
    }

    HierarchicalSolution result() {
        HierarchicalSolution solution;
        solution.links = link_count_;
        solution.bytes = link_count_ * sizeof(Link) + sent_.size() * (sizeof(SentLight) + sizeof(Cluster)) +
                         (tree_.patches.size() + tree_.quads.size()) * (sizeof(LinkedPatch) + sizeof(Patch));
        solution.irradiance = irradiance_;
        solution.tree = std::move(tree_);
        return solution;
    }

private:
    void refine_links(std::vector<Link>& links, bool divides) {
        std::vector<Link> refined;
        for (Link link : links) {
            link.receiver = now(link.receiver);
            if (!is_cluster(link.source)) link.source = now(link.source);
            if (divides) {
                refine(link, refined);
            } else {
                refined.push_back(link);
            }
        }
        links = std::move(refined);
    }
    const LinkedPatch& shape(PatchCode code) const {
        return is_patch(code) ? patch_shapes_[number_of(code)] : quad_shapes_[code];
    }
    const Patch& patch_of(PatchCode code) const {
        return is_patch(code) ? tree_.patches[number_of(code)] : quad_patches_[code];
    }
    Rgb& gathered(PatchCode code) { return is_patch(code) ? gathered_[number_of(code)] : quad_gathered_[code]; }
    Rgb sent_of(PatchCode code) const { return is_patch(code) ? patch_sent_[number_of(code)] : quad_sent_[code]; }
    /// What a patch was divided into since the links were made.
    PatchCode now(PatchCode code) const {
        if (!is_patch(code) || number_of(code) >= became_.size()) return code;
        const PatchCode quad = became_[number_of(code)];
        return quad == kNoPatch ? code : quad;
    }

    /// Those that are new, with the light that reaches them by way of no surface.
    void add_patches() {
        for (auto i = static_cast<uint32_t>(patch_shapes_.size()); i < tree_.patches.size(); ++i) {
            patch_shapes_.push_back(linked_patch(view_, tree_.patches[i]));
            stale_.push_back(i);
        }
        direct_.resize(tree_.patches.size());
        gathered_.resize(tree_.patches.size());
        irradiance_.resize(tree_.patches.size());
        patch_sent_.resize(tree_.patches.size());
        const RowScene rows = {scene_, tree_};
        parallel_for(stale_.size(), 8, [&](uint64_t k) {
            const uint32_t i = stale_[k];
            FormFactorRow row;
            const LightRays rays = {.count = kLightRays, .finds_lamps = true};
            const SampleKey key = {hash_words(i, static_cast<uint32_t>(tree_.quads.size()), 0x64697265u).x, 0,
                                   settings_.seed};
            add_light_rays(rows, tree_.patches[i], key, rays, row);
            row.sort();
            direct_[i] = row.direct;
            for (const FormFactor& lamp : row.factors) {
                direct_[i] += lamp.factor * tree_.patches[lamp.patch].exitance;
            }
            patch_sent_[i] = tree_.patches[i].reflectance * direct_[i];
        });
        stale_.clear();
    }

    /// What a link may be wrong by: a share of what patches that lamps reach receive.
    void set_limit() {
        double light = 0, area = 0;
        for (std::size_t i = 0; i < direct_.size(); ++i) {
            if (is_black(direct_[i])) continue;
            light += static_cast<double>(tree_.patches[i].area * luminance(direct_[i]));
            area += static_cast<double>(tree_.patches[i].area);
        }
        limit_ = area > 0 ? settings_.link_error * static_cast<float>(light / area) : 0.0f;
        std::vector<double> ignored(links_.size()), all(links_.size());
        for (std::size_t i = 0; i < links_.size(); ++i) push(tree_.roots[clusters_.faces[i]], {}, ignored[i], all[i]);
        send();
    }

    bool can_divide(PatchCode code) const { return !is_patch(code) || shape(code).longest > patch_size_; }
    void wish(PatchCode code) { std::atomic_ref(wishes_[number_of(code)]).store(1, std::memory_order_relaxed); }

    void refine(const Link& link, std::vector<Link>& refined) {
        const LinkedPatch& receiver = shape(link.receiver);
        const bool of_cluster = is_cluster(link.source);
        if (of_cluster) {
            const Cluster& cluster = clusters_.clusters[link.source & ~kIsCluster];
            if (!is_before(receiver, cluster.ball)) return;
            if (cluster.count == 1) {
                return refine({link.receiver, tree_.roots[clusters_.faces[cluster.first]], kUnknown}, refined);
            }
        } else if (!is_before(receiver, shape(link.source)) || !is_before(shape(link.source), receiver)) {
            return;
        }
        const Ball& ball = of_cluster ? clusters_.clusters[link.source & ~kIsCluster].ball : shape(link.source).ball;
        const float error = error_of(link, receiver, ball);
        if (!(error > limit_)) return keep(link, error, refined);
        const bool can_divide_source = of_cluster || can_divide(link.source);
        const bool divides_receiver = can_divide(link.receiver) && error < kInfinity &&
                                      (receiver.ball.radius > ball.radius || !can_divide_source);
        if (divides_receiver) {
            if (is_patch(link.receiver)) {
                wish(link.receiver);
                return keep(link, error, refined);
            }
            for (const PatchCode child : tree_.quads[link.receiver].child) {
                refine({child, link.source, kUnknown}, refined);
            }
        } else if (of_cluster) {
            const Cluster& cluster = clusters_.clusters[link.source & ~kIsCluster];
            refine({link.receiver, kIsCluster | cluster.left, kUnknown}, refined);
            refine({link.receiver, kIsCluster | cluster.right, kUnknown}, refined);
        } else if (can_divide_source) {
            if (is_patch(link.source)) {
                wish(link.source);
                return keep(link, error, refined);
            }
            for (const PatchCode child : tree_.quads[link.source].child) {
                refine({link.receiver, child, kUnknown}, refined);
            }
        } else {
            keep(link, error, refined);
        }
    }

    /// Form factor, at most, times radiosity: irradiance that a link could be wrong by.
    float error_of(const Link& link, const LinkedPatch& receiver, const Ball& ball) const {
        if (link.factor == 0) return 0; // nothing of it is seen
        if (!is_cluster(link.source)) {
            const LinkedPatch& source = shape(link.source);
            return most_form_factor(receiver, ball, source.area) * luminance(sent_of(link.source));
        }
        const SentLight& sent = sent_[link.source & ~kIsCluster];
        const float most = most_form_factor(receiver, ball, kInfinity);
        if (most == 1 && !is_black(sent.all)) return kInfinity; // in the middle of it: it has no direction
        const float spread = kPi * square(ball.radius);         // of what it sends, at least
        return most * luminance(sent.all) / max(spread, 1e-30f);
    }

    void keep(Link link, float error, std::vector<Link>& refined) {
        if (link.factor == kUnknown && error > 0) {
            // What hardly counts may be off by more.
            const float share = limit_ > 0 ? min(error / limit_, 1.0f) : 1.0f;
            const uint32_t rays = max(1u, static_cast<uint32_t>(share * kMostRaysOfLink));
            link.factor = is_cluster(link.source) ? cluster_factor(link, rays) : patch_factor(link, rays);
        }
        refined.push_back(link);
    }

    Rgb light_of(const Link& link) const {
        if (!(link.factor > 0)) return {};
        if (!is_cluster(link.source)) return link.factor * sent_of(link.source);
        const uint32_t cluster = link.source & ~kIsCluster;
        const Vec3 way = shape(link.receiver).ball.centre - clusters_.clusters[cluster].ball.centre;
        return link.factor * sent_[cluster].towards(normalize(way));
    }

    void clear(PatchCode code) {
        gathered(code) = {};
        if (is_patch(code)) return;
        for (const PatchCode child : tree_.quads[code].child) clear(child);
    }

    /// Down: what a quad gathers, all its parts receive. Up: it sends the mean of what they do.
    Rgb push(PatchCode code, Rgb above, double& changed, double& all) {
        const Rgb received = above + gathered(code);
        if (is_patch(code)) {
            const uint32_t i = number_of(code);
            const Patch& patch = tree_.patches[i];
            irradiance_[i] = direct_[i] + received;
            const Rgb sent = patch.reflectance * irradiance_[i];
            changed += static_cast<double>(patch.area * abs(luminance(sent) - luminance(patch_sent_[i])));
            all += static_cast<double>(patch.area * luminance(sent));
            return patch_sent_[i] = sent;
        }
        Rgb sum;
        for (const PatchCode child : tree_.quads[code].child) sum += push(child, received, changed, all);
        return quad_sent_[code] = 0.25f * sum;
    }

    /// What clusters send, from what their faces do.
    void send() {
        for (std::size_t i = clusters_.clusters.size(); i-- > 0;) {
            const Cluster& cluster = clusters_.clusters[i];
            sent_[i] = {};
            if (cluster.count == 1) {
                const PatchCode root = tree_.roots[clusters_.faces[cluster.first]];
                sent_[i].add(shape(root).normal, shape(root).area * sent_of(root));
            } else {
                sent_[i].add(sent_[cluster.left]);
                sent_[i].add(sent_[cluster.right]);
            }
        }
    }

    struct Sight {
        Ray ray;
        TriangleId start, target;
        float factor;
    };
    /// Between places on two patches, of one of `parts` of the source; false where they turn away from each other.
    bool see(const Patch& receiver, const Patch& source, uint32_t parts, SampleKey key, Sight& sight) const {
        const PatchPlace from = place_on_patch(view_, receiver, sample_2d(SamplerKind::Sobol, key, 0));
        const PatchPlace to = place_on_patch(view_, source, sample_2d(SamplerKind::Sobol, key, 0, Pair::Last));
        const Vec3 way = to.position - from.position;
        const float squared = length_squared(way);
        if (!(squared > 0)) return false;
        const Vec3 direction = (1.0f / sqrt(squared)) * way;
        const float cosines = dot(direction, from.normal) * -dot(direction, to.normal);
        if (!(dot(direction, from.normal) > 0) || !(dot(direction, to.normal) < 0)) return false;
        // A disk's form factor (Wallace et al. 1989), which stays below 1 where they are near.
        const float area = source.area / static_cast<float>(parts);
        sight.factor = cosines * area / (kPi * squared + area);
        sight.ray.origin = offset_ray_origin(from.position, from.error, from.normal, direction);
        sight.ray.direction = offset_ray_origin(to.position, to.error, to.normal, -direction) - sight.ray.origin;
        sight.ray.t_min = 0;
        sight.ray.t_max = 1;
        sight.start = {receiver.instance, receiver.primitive};
        sight.target = {source.instance, source.primitive};
        return true;
    }
    void trace(const Sight* sights, uint32_t count, uint32_t coin, bool* met) const {
        find_occlusions(
            scene_.trees(), count, RayOrder::Scattered, [&](uint32_t i) { return sights[i].ray; },
            [&](uint32_t i) {
                return AcceptHit{view_, sights[i].start, sights[i].target, hash_word(coin + i)};
            },
            met);
    }
    uint32_t key_of(const Link& link) const {
        const Patch& receiver = patch_of(link.receiver);
        return hash_words(
                   receiver.face,
                   hash_words(bits_of(receiver.corners.middle().x), bits_of(receiver.corners.middle().y), link.source)
                       .x,
                   0x6c696e6bu)
            .x;
    }

    float patch_factor(const Link& link, uint32_t rays) const {
        Sight sights[kMostRaysOfLink];
        bool met[kMostRaysOfLink];
        const uint32_t key = key_of(link);
        uint32_t count = 0;
        for (uint32_t k = 0; k < rays; ++k) {
            if (see(patch_of(link.receiver), patch_of(link.source), rays, {key, k, settings_.seed}, sights[count]))
                ++count;
        }
        trace(sights, count, key, met);
        float sum = 0;
        for (uint32_t i = 0; i < count; ++i) sum += met[i] ? 0.0f : sights[i].factor;
        return sum;
    }

    /// Cosine at the receiver over pi distance^2, times how much of the cluster is seen.
    float cluster_factor(const Link& link, uint32_t rays) const {
        const Cluster& cluster = clusters_.clusters[link.source & ~kIsCluster];
        const LinkedPatch& receiver = shape(link.receiver);
        const Vec3 way = cluster.ball.centre - receiver.ball.centre;
        const float squared = length_squared(way);
        const float cosine = squared > 0 ? dot(way, receiver.normal) / sqrt(squared) : 0.0f;
        if (!(cosine > 0)) return 0;
        Sight sights[kMostRaysOfLink];
        bool met[kMostRaysOfLink];
        const uint32_t key = key_of(link);
        uint32_t count = 0;
        for (uint32_t k = 0; k < rays; ++k) {
            const uint64_t place = (uint64_t(k) << 32 | hash_words(key, k, settings_.seed).x) / rays;
            const auto face = cluster.first + static_cast<uint32_t>((place * cluster.count) >> 32);
            const PatchCode root = tree_.roots[clusters_.faces[face]];
            if (see(patch_of(link.receiver), patch_of(root), 1, {key, k, settings_.seed}, sights[count])) ++count;
        }
        if (count == 0) return 0;
        trace(sights, count, key, met);
        uint32_t seen = 0;
        for (uint32_t i = 0; i < count; ++i) seen += met[i] ? 0 : 1;
        return cosine * kInvPi / squared * (static_cast<float>(seen) / static_cast<float>(count));
    }

    const SolvedScene& scene_;
    const SceneView& view_;
    RadiositySettings settings_;
    PatchTree tree_;
    float patch_size_, limit_ = 0;
    ClusterTree clusters_;
    std::vector<SentLight> sent_;          // [clusters]
    std::vector<std::vector<Link>> links_; // [faces of clusters_]
    uint64_t link_count_ = 0;
    std::vector<LinkedPatch> patch_shapes_, quad_shapes_;
    std::vector<Patch> quad_patches_;                                                          // what quads were
    std::vector<Rgb> direct_, gathered_, irradiance_, patch_sent_, quad_gathered_, quad_sent_; // W/m2
    std::vector<uint8_t> wishes_;   // [patches] to be divided
    std::vector<PatchCode> became_; // [patches] quads since the last refine()
    std::vector<uint32_t> stale_;   // patches whose direct light is to be found
};

} // namespace

std::size_t most_hierarchical_bytes(uint64_t patches) {
    const uint64_t quads = patches / 3 + 1, clusters = 2 * patches;
    return std::min(patches * patches, kMostLinks) * sizeof(Link) + clusters * (sizeof(SentLight) + sizeof(Cluster)) +
           (patches + quads) * (sizeof(LinkedPatch) + sizeof(Patch) + 4 * sizeof(Rgb));
}

HierarchicalSolution solve_hierarchically(const SolvedScene& scene, PatchTree coarse, float patch_size,
                                          const RadiositySettings& settings, WorkWatch& watch) {
    Hierarchy hierarchy(scene, std::move(coarse), patch_size, settings);
    uint64_t passes = 0;
    double left = 1;
    bool is_done = false;
    const auto keep_going = [&](double share) {
        watch.set_share(share);
        return !watch.is_over();
    };
    while (true) {
        watch.begin(fmt::format("links, pass {}", passes + 1), 0);
        const bool divides = hierarchy.refine(keep_going);
        for (uint32_t k = 0; k < kSweeps; ++k) left = hierarchy.sweep();
        ++passes;
        is_done = !divides && !(left > static_cast<double>(settings.tolerance));
        if (is_done || watch.is_over() || passes == kMostPasses) break;
        if (divides) hierarchy.divide();
    }
    HierarchicalSolution solution = hierarchy.result();
    solution.passes = passes;
    solution.left = left;
    solution.reached_limit = !is_done && !watch.is_over();
    return solution;
}

} // namespace pertev
