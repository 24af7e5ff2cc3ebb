#pragma once

// Host traversal of one mesh by several interleaved rays: each makes one step, prefetches the memory of its next
// step, and lets the others step meanwhile. A single ray waits half of its time for nodes and triangles. Rays at
// nodes step together, then those at leaves, so that no branch distinguishes them. Boxes are tested as in
// traverse_wide.h, and leaves of two or four rays at once; hits are the same to the bit, only the order of children
// differs. `F`, Floats8 or Floats16, is as wide as the processor's vectors.
//
// Source of the idea: Kocberber, Falsafi, Grot, "Asynchronous Memory Access Chaining", VLDB 2015.

#include <array>
#include <cstdint>
#include <new>
#include <type_traits>
#include <utility>

#include "trace/intersect/intersect_leaves.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"
#include "trace/wide/flight_stack.h"
#include "trace/wide/traverse_wide.h"

namespace pertev {

/// Number of rays in flight. Eight are 2 to 7 % slower in large scenes while other programs use the shared cache.
inline constexpr int kFlights = 16;

/// Traverses `bvh` with `count` rays, which `rays` defines:
///   Ray ray(uint32_t i)                             the i-th ray
///   Accept accept(uint32_t i)                       its acceptance rule
///   Visitor visitor(const Accept&, const Ray&)      the visitor of its candidates (trace/traverse_scene.h)
///   void end(uint32_t i, const Ray&, Visitor&)      called at the end of its traversal of this mesh
template <TraversalOptions kOptions, class F, class Rays>
class TraversalInFlight {
    static_assert(kOptions.is_exact());
    using Accept = decltype(std::declval<Rays>().accept(0));
    using Visitor = decltype(std::declval<Rays>().visitor(std::declval<const Accept&>(), std::declval<const Ray&>()));
    using Node = WideBvhNode<kWideChildren>;
    static constexpr int kLeaves = kLeavesAtOnce<F>;

public:
    TraversalInFlight(const WideBvhView<kWideChildren>& bvh, uint32_t count, const Rays& rays)
        : bvh_(bvh), count_(count), rays_(rays) {}

    void run() {
        List at_nodes, at_leaves;
        for (Slot& slot : slots_) {
            if (next_ < count_) at_nodes.add(start(slot));
        }
        while (at_nodes.size > 0) {
            step_at_nodes(at_nodes, at_leaves);
            while (at_leaves.size >= kLeaves || (at_leaves.size > 0 && at_nodes.size == 0)) {
                step_at_leaves(at_nodes, at_leaves);
            }
        }
    }

private:
    struct Flight {
        WideRay wide;
        Ray ray;
        ShearRows rows;
        const void* at;     // a node, or a leaf's first triangle
        uint32_t count = 0; // triangles of a leaf; 0 for a leaf: nothing is pending
        uint32_t number;
        Accept accept;
        Visitor visitor;
        FlightStack stack;

        Flight(const WideBvhView<kWideChildren>& bvh, const Rays& rays, uint32_t i, const Ray& r)
            : wide(make_wide_ray<kOptions>(r, bvh.bounds_max_abs)), ray(r), rows(make_shear_rows(ray)), at(bvh.nodes),
              number(i), accept(rays.accept(i)), visitor(rays.visitor(accept, ray)) {}
    };
    union Slot { // empty before there is a ray for it
        Flight flight;
        Slot() {}
        ~Slot() {}
    };
    static_assert(std::is_trivially_destructible_v<Flight>);

    struct List {
        int size = 0;
        Flight* flights[kFlights + 1]; // one more, because add_if writes unconditionally

        void add(Flight* flight) { flights[size++] = flight; }
        void add_if(bool belongs, Flight* flight) {
            flights[size] = flight;
            size += belongs ? 1 : 0;
        }
    };

    Flight* start(Slot& slot) {
        const uint32_t i = next_++;
        return new (&slot.flight) Flight(bvh_, rays_, i, rays_.ray(i));
    }

    /// Pops the next entry and prefetches its memory. Returns true for a leaf.
    [[gnu::always_inline]] bool advance(Flight& flight) const {
        const WideEntry entry = flight.stack.pop();
        const bool is_leaf = (entry.link & kLeafBit) != 0;
        const auto* const node = reinterpret_cast<const char*>(bvh_.nodes + entry.link);
        const auto* const triangles = reinterpret_cast<const char*>(bvh_.triangles + (entry.link & ~kLeafBit));
        const char* const at = is_leaf ? triangles : node;
        for (int line = 0; line < 4; ++line) _mm_prefetch(at + 64 * line, _MM_HINT_T0); // four triangles fit
        flight.at = at;
        flight.count = entry.count;
        return is_leaf;
    }

    [[gnu::always_inline]] void step_at_nodes(List& at_nodes, List& at_leaves) const {
        int left = 0;
        for (int i = 0; i < at_nodes.size; ++i) {
            Flight& flight = *at_nodes.flights[i];
            const Node& node = *static_cast<const Node*>(flight.at);
            const __m256 t_limit = _mm256_set1_ps(skip_beyond<kOptions>(flight.visitor, flight.ray));
            const EnteredChildren entered =
                enters_children(flight.wide, node, _mm256_set1_ps(flight.ray.t_min), t_limit);
            flight.stack.template push<kOptions>(node, entered, flight.visitor.visits_far_first());
            const bool is_leaf = advance(flight);
            at_leaves.add_if(is_leaf, &flight);
            at_nodes.flights[left] = &flight;
            left += is_leaf ? 0 : 1;
        }
        at_nodes.size = left;
    }

    [[gnu::always_inline]] void step_at_leaves(List& at_nodes, List& at_leaves) {
        int left = 0;
        for (int first = 0; first < at_leaves.size; first += kLeaves) {
            std::array<LeafOfRay, kLeaves> leaves;
            for (int i = 0; i < kLeaves; ++i) {
                const Flight& flight = *at_leaves.flights[min(first + i, at_leaves.size - 1)];
                leaves[i] = {&flight.rows, static_cast<const BvhTriangle*>(flight.at),
                             first + i < at_leaves.size ? min(flight.count, 4u) : 0, flight.visitor.limit()};
            }
            LeafHits<F> hits;
            intersect_leaves<F>(leaves, hits);
            for (int i = 0; i < kLeaves && first + i < at_leaves.size; ++i) {
                Flight& flight = *at_leaves.flights[first + i];
                const float before = skip_beyond<kOptions>(flight.visitor, flight.ray);
                if (flight.count == 0 || visit_hits(flight, hits, i)) {
                    rays_.end(flight.number, flight.ray, flight.visitor);
                    if (next_ < count_) at_nodes.add(start(reinterpret_cast<Slot&>(flight)));
                    continue;
                }
                if (flight.count > 4) {
                    flight.at = static_cast<const BvhTriangle*>(flight.at) + 4;
                    flight.count -= 4;
                    at_leaves.flights[left++] = &flight;
                    continue;
                }
                const float limit = skip_beyond<kOptions>(flight.visitor, flight.ray);
                if (kOptions.rta && limit < before) flight.stack.shorten(limit);
                const bool is_leaf = advance(flight);
                at_nodes.add_if(!is_leaf, &flight);
                at_leaves.flights[left] = &flight;
                left += is_leaf ? 1 : 0;
            }
        }
        at_leaves.size = left;
    }

    /// Visits the hits of leaf `i`, which is the flight's. Returns true if the visitor ended the traversal.
    [[gnu::always_inline]] bool visit_hits(Flight& flight, const LeafHits<F>& hits, int i) const {
        const auto* const triangles = static_cast<const BvhTriangle*>(flight.at);
        for (unsigned rest = (hits.hit | hits.slow) >> 4 * i & 15; rest != 0; rest &= rest - 1) {
            const int k = __builtin_ctz(rest), lane = 4 * i + k;
            const BvhTriangle& triangle = triangles[k];
            TriangleHit hit = {hits.t[lane], hits.u[lane], hits.v[lane]};
            const bool is_slow = (hits.slow >> lane & 1) != 0;
            if (is_slow && !intersect_alone(flight.ray, flight.visitor.limit(), triangle, hit)) continue;
            if (flight.visitor.visit(triangle.instance, triangle.primitive, hit)) return true;
        }
        return false;
    }

    const WideBvhView<kWideChildren> bvh_;
    const uint32_t count_;
    const Rays& rays_;
    uint32_t next_ = 0;
    std::array<Slot, kFlights> slots_;
};

/// Rays that continue in the instances after the baked tree.
template <TraversalOptions kOptions, class RayOf, class AcceptOf, class MakeVisitor, class End>
struct RaysOfScene {
    const HostTrees& instances; // the scene without its baked tree
    const RayOf& ray;
    const AcceptOf& accept;
    const MakeVisitor& visitor;
    const End& end_of;

    template <class Visitor>
    void end(uint32_t i, const Ray& r, Visitor& seen) const {
        if (instances.tlas_root != kNoLink && !seen.is_done()) {
            traverse_scene<Wide8SimdTraversal<kOptions>>(instances, r, seen, NoTraversalCounter{});
        }
        end_of(i, seen);
    }
};

/// Traverses the scene with many rays: the baked tree in flight, and instances ray by ray. Calls `end(i, visitor)`
/// for each at its end.
template <TraversalOptions kOptions, class F, class RayOf, class AcceptOf, class MakeVisitor, class End>
void traverse_scene_in_flight(const HostTrees& scene, uint32_t count, const RayOf& ray_of, const AcceptOf& accept_of,
                              const MakeVisitor& make_visitor, const End& end_of) {
    HostTrees instances = scene;
    instances.baked = {};
    using Rays = RaysOfScene<kOptions, RayOf, AcceptOf, MakeVisitor, End>;
    const Rays rays{instances, ray_of, accept_of, make_visitor, end_of};
    if (scene.baked.nodes != nullptr) {
        TraversalInFlight<kOptions, F, Rays>(scene.baked, count, rays).run();
        return;
    }
    for (uint32_t i = 0; i < count; ++i) {
        const Ray ray = ray_of(i);
        const auto accept = accept_of(i);
        auto visitor = make_visitor(accept, ray);
        rays.end(i, ray, visitor);
    }
}

} // namespace pertev
