// Top-down build with spatial splits: where halves would overlap, triangles are split, and each half gets a reference
// with the box of its part. Object and spatial splits are both tried between bins.
//
// Source: Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG 2009. Differences: every
// subtree has an allowance of added references, which its parent distributes, so that the total is bounded and
// independent of threads. Large sets are processed in chunks by several threads; chunk boundaries do not affect the
// result.

#include "accel/builders/build_spatial_splits.h"

#include <algorithm>
#include <memory>

#include "accel/builders/binary_tree.h"
#include "accel/builders/build_bvh.h"
#include "accel/builders/builders.h"
#include "accel/builders/cut_triangle.h"
#include "accel/builders/find_spatial_cut.h"
#include "accel/builders/halve_references.h"
#include "accel/bvh/binned_cut.h"
#include "base/error.h"
#include "base/huge_pages.h"
#include "base/limits.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr uint32_t kParallelSplit = 1u << 12; // from this many references on, both halves are built in parallel
constexpr std::size_t kSplitChunk = 1u << 12; // references of a large set that one thread processes at a time
constexpr int kBins = 16;

using References = std::vector<BuildReference>;
using Chunks = std::span<const std::span<const BuildReference>>;

Bounds3 box_of(const BuildReference& r) { return {r.lo, r.hi}; }

/// The box of a set, and the box `centres` around the doubled centres of its boxes.
struct Extent {
    Box4 box, centres;
};

/// An object split of a set.
struct ObjectCut {
    float cost = kInfinity, uncut = 0; // sums of half area times count, with and without the split
    Bounds3 left, right;
    int axis = -1, bin = 0; // references in bins below go left; axis -1: no split is possible

    /// Returns whether the cut costs less than none, by more than rounding. If all boxes are equal, costs differ only
    /// by rounding, and following that would give a chain.
    bool gains() const { return cost < uncut * (1 - 0x1p-20f); }
};

/// The two halves of a chunk.
struct Halves {
    References left, right;
};

/// Calls body(i) for each chunk, in parallel if there are several.
template <class Body>
void for_each_chunk(std::size_t chunks, const Body& body) {
    if (chunks == 1) return body(0);
    parallel_for(chunks, 1, body);
}

std::size_t size_of(Chunks chunks) {
    std::size_t size = 0;
    for (const auto& chunk : chunks) size += chunk.size();
    return size;
}

/// Splits sets in two; large ones on all threads.
class Cutter {
public:
    Cutter(const std::vector<BvhTriangle>& triangles, uint32_t max_leaf, float min_overlap, float min_own_overlap)
        : triangles_(triangles), max_leaf_(max_leaf), min_overlap_(min_overlap), min_own_overlap_(min_own_overlap) {}

    /// Splits chunk i into halves[i], which are empty before. Both sides are non-empty, and at most `allowance`
    /// references are added.
    void cut(Chunks chunks, uint64_t allowance, int levels_left, std::span<Halves> halves) const {
        const std::size_t count = size_of(chunks);
        if (levels_needed(count) >= levels_left) return halve(chunks, halves);
        const Extent extent = extent_of(chunks);
        const BinMap map(extent.centres, kBins);
        ObjectCut cut;
        bin(chunks, map, cut);
        cut.uncut = half_area(extent.box) * static_cast<float>(count);
        const float enough = max(min_overlap_, min_own_overlap_ * half_area(extent.box));
        if (allowance > 0 && count > max_leaf_ &&
            (cut.axis < 0 || intersection(cut.left, cut.right).half_area() > enough)) {
            const SpatialCut spatial = find_spatial_cut(chunks, triangles_, to_bounds(extent.box), allowance);
            if (spatial.cost < min(cut.cost, cut.uncut)) {
                for_each_chunk(chunks.size(), [&](uint64_t i) { cut_triangles(chunks[i], spatial, halves[i]); });
                uint64_t left = 0, right = 0;
                for (const Halves& h : halves) left += h.left.size(), right += h.right.size();
                // The split may differ from the bins' prediction by rounding.
                if (left > 0 && right > 0 && left + right - count <= allowance) return;
                for (Halves& h : halves) h.left.clear(), h.right.clear();
            }
        }
        if (!cut.gains()) return halve(chunks, halves);
        for_each_chunk(chunks.size(), [&](uint64_t chunk) {
            for (const BuildReference& r : chunks[chunk]) {
                const bool left = lane(map(simd_box_of(r)), cut.axis) < cut.bin;
                (left ? halves[chunk].left : halves[chunk].right).push_back(r);
            }
        });
    }

private:
    static Extent extent_of(Chunks chunks) {
        std::vector<Extent> parts(chunks.size());
        for_each_chunk(chunks.size(), [&](uint64_t i) {
            for (const BuildReference& r : chunks[i]) {
                const Box4 box = simd_box_of(r);
                parts[i].box.extend(box);
                parts[i].centres.extend_point(centre_of(box));
            }
        });
        for (const Extent& part : parts) {
            parts[0].box.extend(part.box);
            parts[0].centres.extend(part.centres);
        }
        return parts[0];
    }

    static void bin(Chunks chunks, const BinMap& map, ObjectCut& cut) {
        Bins bins(kBins);
        if (chunks.size() == 1) {
            fill_bins(chunks[0].data(), chunks[0].data() + chunks[0].size(), map, bins);
        } else {
            std::vector<Bins> parts;
            parts.reserve(chunks.size());
            for (std::size_t i = 0; i < chunks.size(); ++i) parts.emplace_back(kBins);
            for_each_chunk(chunks.size(), [&](uint64_t i) {
                fill_bins(chunks[i].data(), chunks[i].data() + chunks[i].size(), map, parts[i]);
            });
            for (const Bins& part : parts) add_bins(part, bins);
        }
        const BinnedCut best = find_cheapest_cut(bins);
        cut.axis = best.axis, cut.bin = best.bin, cut.cost = best.cost;
        cut.left = to_bounds(best.left), cut.right = to_bounds(best.right);
    }

    static void halve(Chunks chunks, std::span<Halves> halves) {
        References all;
        for (const auto& chunk : chunks) all.insert(all.end(), chunk.begin(), chunk.end());
        const auto middle = all.begin() + static_cast<std::ptrdiff_t>(halve_references(all, centres_of(all)));
        halves[0].left.assign(all.begin(), middle);
        halves[0].right.assign(middle, all.end());
    }

    /// Distributes triangles to both sides. One that the plane cuts goes to both, or to one if that costs less
    /// ("reference unsplitting").
    void cut_triangles(std::span<const BuildReference> references, const SpatialCut& cut, Halves& halves) const {
        const float left = cut.left.half_area(), right = cut.right.half_area();
        const auto nl = static_cast<float>(cut.left_size), nr = static_cast<float>(cut.right_size);
        const float to_both = left * nl + right * nr;
        const auto area_with = [](Bounds3 side, const Bounds3& box) {
            side.extend(box);
            return side.half_area();
        };
        for (const BuildReference& r : references) {
            const Bounds3 box = box_of(r);
            if (!(component(box.hi, cut.axis) > cut.plane)) {
                halves.left.push_back(r);
                continue;
            }
            if (!(component(box.lo, cut.axis) < cut.plane)) {
                halves.right.push_back(r);
                continue;
            }
            const float to_left = area_with(cut.left, box) * nl + right * (nr - 1);
            const float to_right = left * (nl - 1) + area_with(cut.right, box) * nr;
            if (min(to_left, to_right) < to_both) {
                (to_left <= to_right ? halves.left : halves.right).push_back(r);
                continue;
            }
            const ClippedBoxes parts = cut_triangle(triangles_[r.id], box, cut.axis, cut.plane);
            if (!parts.left.is_empty()) halves.left.push_back({parts.left.lo, r.id, parts.left.hi});
            if (!parts.right.is_empty()) halves.right.push_back({parts.right.lo, r.id, parts.right.hi});
            if (parts.left.is_empty() && parts.right.is_empty())
                halves.left.push_back(r); // unreachable: the triangle has a point there
        }
    }

    const std::vector<BvhTriangle>& triangles_;
    std::size_t max_leaf_;
    float min_overlap_, min_own_overlap_; // half areas: absolute, and as a fraction of the set's own
};

/// Distributes a parent's remaining allowance between its halves. By count, small triangles would get the allowance
/// that large ones can use, which makes the tree of Sponza 3 % costlier.
uint64_t left_allowance(uint64_t left_over, double left_need, double right_need) {
    const double both = left_need + right_need;
    return static_cast<uint64_t>((both > 0 ? left_need / both : 0.5) * static_cast<double>(left_over));
}

double need_of(std::span<const BuildReference> references) {
    double sum = 0;
    for (const BuildReference& r : references) sum += static_cast<double>(half_area(simd_box_of(r)));
    return sum;
}

/// Builds a small subtree in one thread.
class SubtreeBuilder {
public:
    SubtreeBuilder(const Cutter& cutter, References references) : cutter_(cutter), pending_(std::move(references)) {}

    /// Builds in depth-first order; node 0 is the root.
    BinaryTree build(uint64_t allowance, int depth) {
        tree_.nodes.reserve(3 * pending_.size());
        tree_.references.reserve(3 * pending_.size() / 2);
        tree_.root = build_node(0, allowance, depth);
        return std::move(tree_);
    }

private:
    /// Builds a node from the pending references from `begin` on and removes them.
    uint32_t build_node(std::size_t begin, uint64_t allowance, int depth) {
        const auto index = static_cast<uint32_t>(tree_.nodes.size());
        tree_.nodes.emplace_back();
        const std::span<const BuildReference> references = std::span(pending_).subspan(begin);
        if (references.size() == 1) {
            tree_.nodes[index] = make_leaf(box_of(references[0]), static_cast<uint32_t>(tree_.references.size()));
            tree_.references.push_back(references[0].id);
            pending_.pop_back();
            return index;
        }
        std::size_t right_size = 1;
        uint64_t of_left = 0, of_right = 0;
        if (references.size() > 2) { // two references are one per half
            halves_.left.clear(), halves_.right.clear();
            cutter_.cut({&references, 1}, allowance, kMaxBvhDepth - depth, {&halves_, 1});
            right_size = halves_.right.size();
            const uint64_t left_over = allowance - (halves_.left.size() + right_size - references.size());
            if (left_over > 0) {
                of_left = left_allowance(left_over, need_of(halves_.left), need_of(halves_.right));
                of_right = left_over - of_left;
            }
            pending_.resize(begin);
            pending_.insert(pending_.end(), halves_.right.begin(), halves_.right.end());
            pending_.insert(pending_.end(), halves_.left.begin(), halves_.left.end());
        }
        const uint32_t left = build_node(begin + right_size, of_left, depth + 1);
        const uint32_t right = build_node(begin, of_right, depth + 1);
        tree_.nodes[index] = make_inner(tree_, left, right);
        return index;
    }

    const Cutter& cutter_;
    References pending_; // references still to be built; the next subtree's are at the end
    Halves halves_;
    BinaryTree tree_;
};

/// A subtree as it was built: in one piece or as two parts.
struct SplitPart {
    BinaryTree whole;
    std::unique_ptr<SplitPart> left, right;
    std::size_t nodes = 0, references = 0;
};

class SpatialSplitBuilder {
public:
    SpatialSplitBuilder(const Cutter& cutter, Sink& sink) : cutter_(cutter), sink_(sink) {}

    BinaryTree build(const References& all, uint64_t allowance) {
        std::vector<References> chunks((all.size() - 1) / kSplitChunk + 1);
        parallel_for(chunks.size(), 1, [&](uint64_t i) {
            const auto first = all.begin() + static_cast<std::ptrdiff_t>(i * kSplitChunk);
            chunks[i].assign(first,
                             first + static_cast<std::ptrdiff_t>(std::min(kSplitChunk, all.size() - i * kSplitChunk)));
        });
        const std::unique_ptr<SplitPart> part = build_part(std::move(chunks), allowance, 0);
        tree_.nodes = array_on_huge_pages<BinaryNode>(part->nodes);
        tree_.references = array_on_huge_pages<uint32_t>(part->references);
        tree_.root = 0;
        place(*part, 0, 0);
        return std::move(tree_);
    }

private:
    std::unique_ptr<SplitPart> build_part(std::vector<References> chunks, uint64_t allowance, int depth) const {
        sink_.check();
        auto part = std::make_unique<SplitPart>();
        std::vector<std::span<const BuildReference>> views(chunks.begin(), chunks.end());
        const std::size_t size = size_of(views);
        if (size < kParallelSplit) {
            References all = std::move(chunks[0]);
            for (const auto& chunk : std::span(chunks).subspan(1)) all.insert(all.end(), chunk.begin(), chunk.end());
            part->whole = SubtreeBuilder(cutter_, std::move(all)).build(allowance, depth);
            part->nodes = part->whole.nodes.size(), part->references = part->whole.references.size();
            return part;
        }
        std::vector<Halves> halves(chunks.size());
        cutter_.cut(views, allowance, kMaxBvhDepth - depth, halves);
        std::vector<References>().swap(chunks); // frees it, because copies at all levels would add up
        std::vector<References> left = gather(halves, &Halves::left), right = gather(halves, &Halves::right);
        std::vector<Halves>().swap(halves);
        std::size_t both = 0;
        double need[2] = {0, 0};
        for (const References& chunk : left) both += chunk.size(), need[0] += need_of(chunk);
        for (const References& chunk : right) both += chunk.size(), need[1] += need_of(chunk);
        const uint64_t left_over = allowance - (both - size);
        const uint64_t of_left = left_allowance(left_over, need[0], need[1]);
        parallel_invoke([&] { part->left = build_part(std::move(left), of_left, depth + 1); },
                        [&] { part->right = build_part(std::move(right), left_over - of_left, depth + 1); });
        part->nodes = 1 + part->left->nodes + part->right->nodes;
        part->references = part->left->references + part->right->references;
        return part;
    }

    /// Gathers one side of all halves; small neighbours are joined into chunks.
    static std::vector<References> gather(std::span<const Halves> halves, References Halves::*side) {
        std::vector<std::pair<std::size_t, std::size_t>> runs; // ranges of halves: first, and one past the last
        for (std::size_t i = 0, size = kSplitChunk; i < halves.size(); ++i) {
            if (size >= kSplitChunk) runs.emplace_back(i, i), size = 0;
            runs.back().second = i + 1;
            size += (halves[i].*side).size();
        }
        std::vector<References> chunks(runs.size());
        parallel_for(runs.size(), 1, [&](uint64_t run) {
            std::size_t size = 0;
            for (std::size_t i = runs[run].first; i < runs[run].second; ++i) size += (halves[i].*side).size();
            chunks[run].reserve(size);
            for (std::size_t i = runs[run].first; i < runs[run].second; ++i) {
                const References& more = halves[i].*side;
                chunks[run].insert(chunks[run].end(), more.begin(), more.end());
            }
        });
        return chunks;
    }

    /// Copies a part's nodes and references to their final positions, depth first.
    void place(const SplitPart& part, uint32_t node, uint32_t reference) {
        if (part.left == nullptr) {
            for (std::size_t i = 0; i < part.nodes; ++i) {
                BinaryNode copy = part.whole.nodes[i];
                copy.child[0] += copy.is_leaf() ? reference : node;
                if (!copy.is_leaf()) copy.child[1] += node;
                tree_.nodes[node + i] = copy;
            }
            std::ranges::copy(part.whole.references, tree_.references.begin() + reference);
            return;
        }
        const uint32_t left = node + 1, right = left + static_cast<uint32_t>(part.left->nodes);
        parallel_invoke([&] { place(*part.left, left, reference); },
                        [&] { place(*part.right, right, reference + static_cast<uint32_t>(part.left->references)); });
        tree_.nodes[node] = make_inner(tree_, left, right);
    }

    const Cutter& cutter_;
    Sink& sink_;
    BinaryTree tree_;
};

} // namespace

BinaryTree build_spatial_split_tree(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings,
                                    const SpatialSplitSettings& splits) {
    PERTEV_CHECK(splits.min_overlap >= 0 && splits.max_growth >= 0 && splits.max_growth <= 1000);
    const References all = references_of(triangles);
    check_reference_count(all.size());
    const auto wanted = static_cast<uint64_t>(static_cast<double>(splits.max_growth) * static_cast<double>(all.size()));
    const uint64_t allowance = std::min(wanted, kMaxBvhTriangles - all.size());
    Bounds3 box;
    for (const BuildReference& r : all) box.extend(box_of(r));
    const Cutter cutter(triangles, static_cast<uint32_t>(settings.max_leaf), splits.min_overlap * box.half_area(),
                        splits.min_own_overlap);
    return SpatialSplitBuilder(cutter, *settings.sink).build(all, allowance);
}

Bvh build_spatial_split_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings,
                            const SpatialSplitSettings& splits) {
    if (triangles.empty()) return {};
    return make_bvh(build_spatial_split_tree(triangles, settings, splits), triangles, settings);
}

} // namespace pertev
