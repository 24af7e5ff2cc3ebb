#pragma once

// Traversal of a kd-tree with a stack of pending far halves.
//
// Source: Havran, "Heuristic Ray Shooting Algorithms", 2000, appendix C (the recursive algorithm TA_B, with an
// explicit stack); near half by the sign of the direction. Why no hit is lost: cell_span.h. Unlike the textbook's,
// this traversal does not end at the first cell with a hit: it continues until all pending cells are entered beyond
// the nearest hit, because a hit may lie outside the cell in which it was found, and grown cells overlap.

#include <cstdint>

#include "accel/kd_tree/kd_tree.h"
#include "base/host_device.h"
#include "trace/cells/cell_span.h"
#include "trace/intersect/test_references.h"
#include "trace/traversal/traversal_counter.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

template <TraversalOptions kOptions>
struct KdTreeTraversal {
    using Tree = KdTreeView;
    using Tests = TestsOf<kOptions>;

    struct Entry {
        uint32_t node;
        CellSpan span;
    };

    template <class Visitor, class Counter>
    HD static bool traverse(const KdTreeView& tree, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        if (tree.nodes == nullptr) return false;
        const typename Tests::Boxes boxes = Tests::make_boxes(ray, tree.bounds.max_abs());
        const typename Tests::Triangles prepared = Tests::make_triangles(ray);
        Entry stack[kMaxKdTreeDepth];
        int size = 0;
        Entry at = {0, span_of_bounds(boxes, tree.bounds, ray.t_min, ray.t_max)};
        if (!is_entered(at.span, skip_beyond<kOptions>(visitor, ray))) return false;
        for (;;) {
            counter.add_node(tree.nodes + at.node);
            const KdTreeNode node = tree.nodes[at.node];
            if (!node.is_leaf()) {
                const PlaneCrossing crossing = cross_plane(boxes, node.axis(), node.plane());
                const Entry below = {at.node + 1, span_below(at.span, crossing)};
                const Entry above = {node.above(), span_above(at.span, crossing)};
                const bool below_first = !kOptions.near_first || crossing.forward;
                const Entry first = below_first ? below : above, second = below_first ? above : below;
                const float t_limit = skip_beyond<kOptions>(visitor, ray);
                const bool enters_first = is_entered(first.span, t_limit);
                if (is_entered(second.span, t_limit)) {
                    if (enters_first) stack[size++] = second;
                    at = enters_first ? first : second;
                    continue;
                }
                if (enters_first) {
                    at = first;
                    continue;
                }
            } else if (test_references<Tests>(tree.triangles, tree.references + node.first(), node.count(), ray,
                                              prepared, instance, visitor, counter)) {
                return true;
            }
            do {
                if (size == 0) return false;
                at = stack[--size];
            } while (!(at.span.entry <= skip_beyond<kOptions>(visitor, ray)));
        }
    }
};

} // namespace pertev
