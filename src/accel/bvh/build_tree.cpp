#include "accel/bvh/build_tree.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "accel/bvh/binned_cut.h"
#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr uint32_t kParallelNode = 1u << 16;    // from this many boxes on, several threads process one node
constexpr uint32_t kParallelSubtree = 1u << 12; // from this many boxes on, both halves are built in parallel
constexpr uint32_t kChunk = 1u << 15;           // fixed, so that no sum depends on the number of threads

struct Range {
    uint32_t begin, end;
    Box4 box, centres;
    uint32_t size() const { return end - begin; }
};

class Builder {
public:
    Builder(std::vector<BuildReference>& references, const BvhBuildSettings& settings)
        : references_(references), settings_(settings), sparse_(references.size()) {}

    BuiltTree build() {
        BuiltTree tree;
        Range all = {0, static_cast<uint32_t>(references_.size()), {}, {}};
        if (all.size() == 0) return tree;
        if (levels_needed(all.size()) > settings_.max_depth) {
            throw Error(ErrorCode::OverLimit,
                        fmt::format("{} boxes do not fit into a tree of {} levels with at most {} in a leaf",
                                    all.size(), settings_.max_depth, settings_.max_leaf));
        }
        measure(all);
        uint32_t leaf_count = 0;
        const uint32_t root = build_range(all, 0, leaf_count);
        tree.bounds = to_bounds(all.box);
        flatten(root, leaf_count, tree);
        tree.order.resize(references_.size());
        parallel_for(references_.size(), kChunk, [&](uint64_t i) { tree.order[i] = references_[i].id; });
        return tree;
    }

private:
    /// Number of levels of inner nodes that object medians need to separate n boxes into leaves.
    int levels_needed(uint32_t n) const {
        const uint32_t leaves = (n - 1) / static_cast<uint32_t>(settings_.max_leaf) + 1;
        return std::bit_width(leaves - 1);
    }

    void measure(Range& range) const {
        std::vector<std::pair<Box4, Box4>> parts((range.size() - 1) / kChunk + 1);
        parallel_for(parts.size(), 1, [&](uint64_t chunk) {
            auto& [box, centres] = parts[chunk];
            const uint32_t begin = range.begin + static_cast<uint32_t>(chunk) * kChunk;
            for (uint32_t i = begin; i < std::min(range.end, begin + kChunk); ++i) {
                const Box4 b = simd_box_of(references_[i]);
                box.extend(b);
                centres.extend_point(centre_of(b));
            }
        });
        for (const auto& [box, centres] : parts) {
            range.box.extend(box);
            range.centres.extend(centres);
        }
    }

    /// Builds the subtree over `range` and returns its link. A leaf's number of boxes is written to `leaf_count`. An
    /// inner node's index is the position of its split, which is unique, so threads need no common counter.
    uint32_t build_range(const Range& range, int depth, uint32_t& leaf_count) {
        const int levels_left = settings_.max_depth - depth;
        const bool may_be_leaf = range.size() <= static_cast<uint32_t>(settings_.max_leaf);
        Range left = {range.begin, range.begin, {}, {}}, right = {range.end, range.end, {}, {}};
        if (range.size() == 1 || levels_left == 0) return leaf(range, leaf_count);
        if (levels_needed(range.size()) >= levels_left && !may_be_leaf) {
            cut_by_count(range, left, right);
        } else {
            const BinMap map(range.centres, settings_.bins);
            const BinnedCut cut = find_cheapest_cut(bins_of(range, map));
            const float area = half_area(range.box);
            const float n = static_cast<float>(range.size());
            const bool worth_it = cut.axis >= 0 && settings_.node_cost * area + settings_.leaf_cost * cut.cost <
                                                       settings_.leaf_cost * n * area;
            if (may_be_leaf && !worth_it) return leaf(range, leaf_count);
            if (cut.axis >= 0) {
                cut_by_bin(range, map, cut, left, right);
            } else {
                cut_by_count(range, left, right);
            }
        }

        const uint32_t index = left.end;
        BvhNode& node = sparse_[index];
        uint32_t links[2];
        uint32_t counts[2] = {0, 0};
        const auto build_left = [&] { links[0] = build_range(left, depth + 1, counts[0]); };
        const auto build_right = [&] { links[1] = build_range(right, depth + 1, counts[1]); };
        if (range.size() >= kParallelSubtree) {
            settings_.sink->check();
            parallel_invoke(build_left, build_right);
        } else {
            build_left();
            build_right();
        }
        // Child 0 is the one where a ray finds a hit sooner: more surface per triangle (large walls before small
        // ornaments). The CPU's any-hit search for rays of finite length visits it first, which halves the steps in
        // Sponza.
        const float left_size = static_cast<float>(left.size()), right_size = static_cast<float>(right.size());
        const int first = half_area(left.box) * right_size >= half_area(right.box) * left_size ? 0 : 1;
        set_child(node, first, to_bounds(left.box), links[0]);
        set_child(node, 1 - first, to_bounds(right.box), links[1]);
        leaf_size(node, first) = counts[0], leaf_size(node, 1 - first) = counts[1];
        return index;
    }

    /// Number of boxes of child k if it is a leaf. The words are reset to 0 when the nodes are reordered.
    static uint32_t& leaf_size(BvhNode& node, int k) { return k == 0 ? node.parent : node.split; }

    static uint32_t leaf(const Range& range, uint32_t& leaf_count) {
        leaf_count = range.size();
        return kLeafBit | range.begin;
    }

    Bins bins_of(const Range& range, const BinMap& map) const {
        Bins bins(settings_.bins);
        if (range.size() < kParallelNode) {
            fill_bins(&references_[range.begin], &references_[range.begin] + range.size(), map, bins);
            return bins;
        }
        const std::size_t chunks = (range.size() - 1) / kChunk + 1;
        std::vector<Bins> parts;
        parts.reserve(chunks);
        for (std::size_t i = 0; i < chunks; ++i) parts.emplace_back(settings_.bins);
        parallel_for(parts.size(), 1, [&](uint64_t chunk) {
            const uint32_t begin = range.begin + static_cast<uint32_t>(chunk) * kChunk;
            const BuildReference* first = references_.data() + begin;
            fill_bins(first, first + std::min(range.end - begin, kChunk), map, parts[chunk]);
        });
        for (const Bins& part : parts) add_bins(part, bins);
        return bins;
    }

    void cut_by_bin(const Range& range, const BinMap& map, const BinnedCut& cut, Range& left, Range& right) {
        left.box = cut.left;
        right.box = cut.right;
        const auto goes_left = [&](const BuildReference& r) { return lane(map(simd_box_of(r)), cut.axis) < cut.bin; };
        if (range.size() >= kParallelNode) return cut_in_parallel(range, goes_left, left, right);
        uint32_t i = range.begin, j = range.end;
        while (i < j) {
            const __m128 centre = centre_of(simd_box_of(references_[i]));
            if (goes_left(references_[i])) {
                left.centres.extend_point(centre);
                ++i;
            } else {
                right.centres.extend_point(centre);
                std::swap(references_[i], references_[--j]);
            }
        }
        left.end = right.begin = i;
    }

    template <class GoesLeft>
    void cut_in_parallel(const Range& range, const GoesLeft& goes_left, Range& left, Range& right) {
        struct Part {
            uint32_t lefts = 0, left_at = 0, right_at = 0;
            Box4 left_centres, right_centres;
        };
        std::vector<Part> parts((range.size() - 1) / kChunk + 1);
        const auto chunk_range = [&](uint64_t chunk) {
            const uint32_t begin = range.begin + static_cast<uint32_t>(chunk) * kChunk;
            return std::pair(begin, std::min(range.end, begin + kChunk));
        };
        parallel_for(parts.size(), 1, [&](uint64_t chunk) {
            Part& part = parts[chunk];
            const auto [begin, end] = chunk_range(chunk);
            for (uint32_t i = begin; i < end; ++i) {
                const bool to_left = goes_left(references_[i]);
                part.lefts += to_left ? 1u : 0u;
                (to_left ? part.left_centres : part.right_centres).extend_point(centre_of(simd_box_of(references_[i])));
            }
        });
        uint32_t at = 0;
        for (Part& part : parts) {
            part.left_at = at;
            at += part.lefts;
            left.centres.extend(part.left_centres);
            right.centres.extend(part.right_centres);
        }
        left.end = right.begin = range.begin + at;
        for (uint64_t chunk = 0; chunk < parts.size(); ++chunk) {
            const auto [begin, end] = chunk_range(chunk);
            parts[chunk].right_at = at;
            at += end - begin - parts[chunk].lefts;
        }
        std::vector<BuildReference> moved(range.size());
        parallel_for(parts.size(), 1, [&](uint64_t chunk) {
            Part part = parts[chunk];
            const auto [begin, end] = chunk_range(chunk);
            for (uint32_t i = begin; i < end; ++i) {
                moved[goes_left(references_[i]) ? part.left_at++ : part.right_at++] = references_[i];
            }
        });
        parallel_for_ranges(range.size(), kChunk, [&](uint64_t begin, uint64_t end) {
            std::copy(moved.begin() + static_cast<std::ptrdiff_t>(begin),
                      moved.begin() + static_cast<std::ptrdiff_t>(end),
                      references_.begin() + static_cast<std::ptrdiff_t>(range.begin + begin));
        });
    }

    void cut_by_count(const Range& range, Range& left, Range& right) {
        const Vec3 extent = to_bounds(range.centres).size();
        const int axis = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
        const auto first = references_.begin() + range.begin, last = references_.begin() + range.end;
        const auto middle = first + range.size() / 2;
        std::nth_element(first, middle, last, [axis](const BuildReference& a, const BuildReference& b) {
            const float ca = component(a.lo, axis) + component(a.hi, axis);
            const float cb = component(b.lo, axis) + component(b.hi, axis);
            return ca != cb ? ca < cb : a.id < b.id;
        });
        left.end = right.begin = range.begin + range.size() / 2;
        for (Range* half : {&left, &right}) {
            for (uint32_t i = half->begin; i < half->end; ++i) {
                const Box4 b = simd_box_of(references_[i]);
                half->box.extend(b);
                half->centres.extend_point(centre_of(b));
            }
        }
    }

    /// Copies the nodes to depth-first order, each before its first child.
    void flatten(uint32_t root, uint32_t root_leaf_count, BuiltTree& tree) const {
        tree.is_last.assign(references_.size(), false);
        const double area = static_cast<double>(max(tree.bounds.half_area(), 0x1p-126f));
        double cost = 0;
        const auto end_leaf = [&](uint32_t link, uint32_t count, double probability) {
            tree.is_last[(link & ~kLeafBit) + count - 1] = true;
            cost += static_cast<double>(settings_.leaf_cost) * count * probability;
        };
        tree.root = root;
        if (root & kLeafBit) {
            end_leaf(root, root_leaf_count, 1.0);
            tree.sah_cost = static_cast<float>(cost);
            return;
        }
        struct Pending {
            uint32_t sparse, parent;
            int k, depth;
            double probability;
        };
        std::vector<Pending> pending = {{root, kNoLink, 0, 1, 1.0}};
        while (!pending.empty()) {
            const Pending at = pending.back();
            pending.pop_back();
            const auto index = static_cast<uint32_t>(tree.nodes.size());
            settings_.sink->check_at(index);
            if (at.parent != kNoLink) tree.nodes[at.parent].child[at.k] = index;
            BvhNode node = sparse_[at.sparse];
            tree.depth = std::max(tree.depth, at.depth);
            cost += static_cast<double>(settings_.node_cost) * at.probability;
            for (int k = 1; k >= 0; --k) {
                const double probability = static_cast<double>(child_bounds(node, k).half_area()) / area;
                if (node.child[k] & kLeafBit) {
                    end_leaf(node.child[k], leaf_size(node, k), probability);
                } else {
                    pending.push_back({node.child[k], index, k, at.depth + 1, probability});
                }
                leaf_size(node, k) = 0;
            }
            tree.nodes.push_back(node);
        }
        tree.root = 0;
        tree.sah_cost = static_cast<float>(cost);
    }

    std::vector<BuildReference>& references_;
    const BvhBuildSettings& settings_;
    std::vector<BvhNode> sparse_; // [position of the node's split among the references]
};

} // namespace

BuiltTree build_tree(std::vector<BuildReference> references, const BvhBuildSettings& settings) {
    PERTEV_CHECK(settings.bins >= 2 && settings.bins <= kMaxBins && settings.max_leaf >= 1);
    PERTEV_CHECK(settings.max_depth >= 1 && settings.max_depth <= kMaxBvhDepth);
    if (references.size() > kMaxBvhTriangles) {
        throw Error(ErrorCode::OverLimit, fmt::format("{} triangles or instances in one tree; the limit is {}",
                                                      references.size(), kMaxBvhTriangles));
    }
    return Builder(references, settings).build();
}

} // namespace pertev
