// Bottom-up build: each cluster finds the neighbour along a Morton curve with which it would share the smallest box.
// Two clusters that choose each other merge, and rounds repeat until one cluster is left.
//
// Source: Meister, Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction", TVCG
// 2018. Ties are resolved differently, because there they may leave clusters waiting in a chain: see Choice and
// kFewMerges.

#include <algorithm>

#include "accel/builders/binary_tree.h"
#include "accel/builders/build_bvh.h"
#include "accel/builders/builders.h"
#include "base/parallel_for.h"
#include "base/parallel_until.h"
#include "base/sort_until.h"
#include "math/morton_code.h"

namespace pertev {
namespace {

constexpr uint32_t kRadius = 16;          // neighbours searched on either side
constexpr uint32_t kFewMerges = 16;       // a round with fewer merges than clusters / this is a chain, which would take
                                          // one round per merge
constexpr uint32_t kPlocChunk = 1u << 13; // fixed, so that nothing depends on the number of threads

struct CurveKey {
    uint64_t code;
    uint32_t id;
};

/// Sorts triangles along the Morton curve through their centres; equal codes are sorted by id.
std::vector<CurveKey> sort_along_curve(const std::vector<BuildReference>& references, Sink& sink) {
    Bounds3 centres;
    for (const BuildReference& r : references) centres.extend(r.lo + r.hi);
    const Vec3 size = centres.size();
    const auto cell = [](float x, float lo, float extent) {
        const float part = extent > 0 ? (x - lo) / extent : 0.0f; // [0, 1]
        return spread_bits(static_cast<uint64_t>(to_int(part * 0x1p21f, 0, (1 << 21) - 1)));
    };
    std::vector<CurveKey> keys(references.size());
    parallel_for(references.size(), kPlocChunk, [&](uint64_t i) {
        const Vec3 centre = references[i].lo + references[i].hi;
        keys[i] = {cell(centre.x, centres.lo.x, size.x) << 2 | cell(centre.y, centres.lo.y, size.y) << 1 |
                       cell(centre.z, centres.lo.z, size.z),
                   static_cast<uint32_t>(i)};
    });
    sort_until(std::span(keys), sink,
               [](const CurveKey& a, const CurveKey& b) { return a.code != b.code ? a.code < b.code : a.id < b.id; });
    return keys;
}

class Clusters {
public:
    Clusters(const std::vector<BuildReference>& references, Sink& sink) : sink_(sink) {
        const std::vector<CurveKey> keys = sort_along_curve(references, sink);
        const auto count = static_cast<uint32_t>(keys.size());
        tree_.nodes.resize(2 * static_cast<std::size_t>(count) - 1);
        tree_.references.resize(count);
        clusters_.resize(count);
        parallel_for(count, kPlocChunk, [&](uint64_t i) {
            const BuildReference& r = references[keys[i].id];
            tree_.references[i] = r.id;
            tree_.nodes[i] = make_leaf({r.lo, r.hi}, static_cast<uint32_t>(i));
            clusters_[i] = {{r.lo, r.hi}, static_cast<uint32_t>(i)};
        });
        used_ = count;
    }

    BinaryTree build() {
        uint32_t blur = 0;
        while (clusters_.size() > 1) {
            sink_.check();
            choose(blur);
            const std::size_t before = clusters_.size();
            merge();
            const bool few = (before - clusters_.size()) * kFewMerges < before;
            blur = few ? std::min(blur + 4, 31u) : 0;
        }
        tree_.root = clusters_[0].node;
        return std::move(tree_);
    }

private:
    struct Cluster {
        Bounds3 box;
        uint32_t node;
    };

    /// A cluster's preference among its neighbours: by area, then by the bitwise difference of positions. That
    /// difference is the same from both sides and unique among the neighbours, so at least one pair always agrees. If
    /// all boxes are equal, each pair of positions 2 k and 2 k + 1 agrees.
    struct Choice {
        uint32_t area_bits, difference;
        bool operator<(const Choice& b) const {
            return area_bits != b.area_bits ? area_bits < b.area_bits : difference < b.difference;
        }
    };

    /// Fills choice_, ignoring the `blur` lowest bits of areas. In a chain where each gap is wider than the last,
    /// every cluster chooses the one before it and only the first two agree. Fewer bits give more ties and thus more
    /// pairs.
    void choose(uint32_t blur) {
        const auto count = static_cast<uint32_t>(clusters_.size());
        choice_.resize(count);
        parallel_until(count, kPlocChunk, sink_, [&](uint64_t at) {
            const auto i = static_cast<uint32_t>(at);
            const uint32_t first = i < kRadius ? 0 : i - kRadius, last = std::min(i + kRadius, count - 1);
            Choice best = {~0u, ~0u};
            for (uint32_t k = first; k <= last; ++k) {
                if (k == i) continue;
                Bounds3 both = clusters_[i].box;
                both.extend(clusters_[k].box);
                const Choice choice = {bits_of(both.half_area()) >> blur, i ^ k}; // areas are not negative
                if (choice < best) best = choice;
            }
            choice_[i] = i ^ best.difference;
        });
    }

    /// Merges each pair that agrees at the position of the first; the order stays.
    void merge() {
        const std::size_t count = clusters_.size();
        struct PlocPart {
            uint32_t kept = 0, merged = 0;
        };
        std::vector<PlocPart> parts((count - 1) / kPlocChunk + 1);
        const auto range_of = [&](uint64_t chunk) {
            return std::pair(static_cast<uint32_t>(chunk * kPlocChunk),
                             static_cast<uint32_t>(std::min<uint64_t>(count, (chunk + 1) * kPlocChunk)));
        };
        parallel_for(parts.size(), 1, [&](uint64_t chunk) {
            const auto [begin, end] = range_of(chunk);
            for (uint32_t i = begin; i < end; ++i) {
                const bool agrees = choice_[choice_[i]] == i;
                parts[chunk].kept += agrees && choice_[i] < i ? 0 : 1;
                parts[chunk].merged += agrees && choice_[i] > i ? 1 : 0;
            }
        });
        PlocPart sum = {0, used_};
        for (PlocPart& part : parts) {
            const PlocPart own = part;
            part = sum;
            sum = {sum.kept + own.kept, sum.merged + own.merged};
        }
        next_.resize(sum.kept);
        parallel_for(parts.size(), 1, [&](uint64_t chunk) {
            PlocPart at = parts[chunk];
            const auto [begin, end] = range_of(chunk);
            for (uint32_t i = begin; i < end; ++i) {
                const uint32_t other = choice_[i];
                const bool agrees = choice_[other] == i;
                if (agrees && other < i) continue;
                Cluster cluster = clusters_[i];
                if (agrees) {
                    const BinaryNode& node = tree_.nodes[at.merged] =
                        make_inner(tree_, cluster.node, clusters_[other].node);
                    cluster = {node.box, at.merged++};
                }
                next_[at.kept++] = cluster;
            }
        });
        clusters_.swap(next_);
        used_ = sum.merged;
    }

    Sink& sink_;
    BinaryTree tree_;
    std::vector<Cluster> clusters_, next_; // in order along the curve
    std::vector<uint32_t> choice_;         // [cluster] the neighbour that it chose
    uint32_t used_ = 0;                    // nodes
};

} // namespace

Bvh build_ploc_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    check_reference_count(triangles.size());
    if (triangles.empty()) return {};
    return make_bvh(Clusters(references_of(triangles), *settings.sink).build(), triangles, settings);
}

} // namespace pertev
