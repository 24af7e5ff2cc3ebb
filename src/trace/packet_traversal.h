#pragma once

// Packet traversal on the host: eight rays share one stack and test the same node at once (AVX2); a node is entered
// if any of them enters it. Triangles are tested ray by ray, only for rays that entered the leaf. Each ray gets the
// hit that it would get alone.
//
// Source: Guenther, Popov, Seidel, Slusallek, "Realtime Ray Tracing on GPU with BVH-based Packet Traversal", IEEE RT
// 2007: if rays enter both children, the majority decides which one is visited first.

#include <immintrin.h>

#include <array>
#include <cstdint>
#include <utility>

#include "base/limits.h"
#include "trace/intersect/test_leaf.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

inline constexpr int kPacketRays = 8;
using RayPacket = std::array<Ray, kPacketRays>; // bit k of a mask stands for ray k

struct PacketBoxes { // RayBoxes of eight rays
    __m256 inv[3], lo[3], hi[3];
    __m256 t_min;
};

/// Makes the boxes of a packet; `make_boxes(ray)` returns a ray's RayBoxes. Rays outside `active` are ignored.
template <class MakeBoxes>
PacketBoxes make_packet_boxes(const RayPacket& rays, unsigned active, const MakeBoxes& make_boxes) {
    alignas(32) float inv[3][kPacketRays] = {}, lo[3][kPacketRays] = {}, hi[3][kPacketRays] = {};
    alignas(32) float t_min[kPacketRays] = {};
    for (unsigned rest = active; rest != 0; rest &= rest - 1) {
        const auto k = static_cast<std::size_t>(__builtin_ctz(rest));
        const RayBoxes boxes = make_boxes(rays[k]);
        for (int axis = 0; axis < 3; ++axis) {
            inv[axis][k] = component(boxes.inv, axis);
            lo[axis][k] = component(boxes.lo, axis);
            hi[axis][k] = component(boxes.hi, axis);
        }
        t_min[k] = rays[k].t_min;
    }
    PacketBoxes packet;
    for (int axis = 0; axis < 3; ++axis) {
        packet.inv[axis] = _mm256_load_ps(inv[axis]);
        packet.lo[axis] = _mm256_load_ps(lo[axis]);
        packet.hi[axis] = _mm256_load_ps(hi[axis]);
    }
    packet.t_min = _mm256_load_ps(t_min);
    return packet;
}

/// Computes enters_child (ray_boxes.h) for eight rays, with the same operations in the same order.
inline unsigned packet_enters_child(const PacketBoxes& r, const BvhNode& node, int k, __m256 t_limit, __m256& entry) {
    const auto plane = [&r](float p, const __m256(&shift)[3], int axis) {
        return _mm256_fmadd_ps(_mm256_set1_ps(p), r.inv[axis], shift[axis]);
    };
    const __m256 x0 = plane(node.x[k], r.lo, 0), x1 = plane(node.x[k + 2], r.hi, 0);
    const __m256 y0 = plane(node.y[k], r.lo, 1), y1 = plane(node.y[k + 2], r.hi, 1);
    const __m256 z0 = plane(node.z[k], r.lo, 2), z1 = plane(node.z[k + 2], r.hi, 2);
    entry = _mm256_max_ps(_mm256_max_ps(_mm256_min_ps(x0, x1), _mm256_min_ps(y0, y1)),
                          _mm256_max_ps(_mm256_min_ps(z0, z1), r.t_min));
    const __m256 exit = _mm256_min_ps(_mm256_min_ps(_mm256_max_ps(x0, x1), _mm256_max_ps(y0, y1)),
                                      _mm256_min_ps(_mm256_max_ps(z0, z1), t_limit));
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(entry, exit, _CMP_LE_OQ)));
}

inline unsigned lanes_not_above(__m256 a, __m256 b) {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
}

/// Traverses a tree of binary nodes. `limits` are the rays' current limits, [kPacketRays], aligned to 32 bytes.
/// `at_leaf(link, mask)` tests a leaf for the rays in the mask; it may lower limits and remove rays from `alive`.
template <bool kNearFirst, class AtLeaf, class Counter>
void traverse_packet(const BvhNode* nodes, uint32_t root, const PacketBoxes& boxes, const float* limits,
                     const unsigned& alive, const Counter& counter, const AtLeaf& at_leaf) {
    struct Waiting {
        __m256 entry;
        uint32_t link;
        unsigned mask; // rays that entered it
    };
    Waiting stack[kMaxBvhDepth];
    int size = 0;
    uint32_t link = root;
    unsigned mask = alive;
    const auto pop = [&] {
        while (size > 0) {
            const Waiting& top = stack[--size];
            mask = top.mask & alive & lanes_not_above(top.entry, _mm256_load_ps(limits));
            if (mask != 0) return top.link;
        }
        return kNoLink;
    };
    while (link != kNoLink && mask != 0) {
        if (link & kLeafBit) {
            at_leaf(link, mask);
            link = pop();
            continue;
        }
        if constexpr (requires { counter.add_packet_node(mask); }) { // for a counter of each ray's own work
            counter.add_packet_node(mask);
        } else {
            counter.add_node(nodes + link);
        }
        const BvhNode& node = nodes[link];
        __m256 entry[2];
        const __m256 limit = _mm256_load_ps(limits);
        const unsigned enters[2] = {packet_enters_child(boxes, node, 0, limit, entry[0]) & mask,
                                    packet_enters_child(boxes, node, 1, limit, entry[1]) & mask};
        if (enters[0] != 0 && enters[1] != 0) {
            const unsigned both = enters[0] & enters[1];
            const int for_second = __builtin_popcount(both & lanes_not_above(entry[1], entry[0]));
            const int first = kNearFirst && both != 0 && 2 * for_second >= __builtin_popcount(both) ? 1 : 0;
            stack[size++] = {entry[1 - first], node.child[1 - first], enters[1 - first]};
            link = node.child[first], mask = enters[first];
        } else if ((enters[0] | enters[1]) != 0) {
            const int k = enters[0] != 0 ? 0 : 1;
            link = node.child[k], mask = enters[k];
        } else {
            link = pop();
        }
    }
}

/// State of eight rays in one scene: a visitor per ray, and which rays are still searching.
template <TraversalOptions kOptions, class Visitor, class Counter>
class PacketTracer {
    using Tests = TestsOf<kOptions>;

public:
    PacketTracer(const SceneBvhView& scene, const RayPacket& rays, std::array<Visitor, kPacketRays>& visitors,
                 unsigned active, const Counter& counter)
        : scene_(scene), rays_(rays), visitors_(visitors), counter_(counter), alive_(active) {
        for_each(active, [&](std::size_t k) { limits_[k] = visitors_[k].limit(); });
    }

    void run() {
        traverse_mesh(scene_.baked, rays_, kNoHit, alive_);
        if (scene_.tlas_root == kNoLink || alive_ == 0) return;
        const PacketBoxes boxes = make_packet_boxes(rays_, alive_, [&](const Ray& ray) {
            return make_ray_boxes(ray.origin, ray.direction, scene_.tlas_reach, scene_.tlas_growth);
        });
        traverse_packet<true>(
            scene_.tlas_nodes, scene_.tlas_root, boxes, limits_, alive_, counter_, [&](uint32_t link, unsigned mask) {
                const InstanceRecord& record = scene_.instances[link & ~kLeafBit];
                RayPacket local;
                for_each(mask,
                         [&](std::size_t k) { local[k] = ray_in_instance(record, rays_[k], visitors_[k].accept); });
                traverse_mesh(scene_.blases[record.blas], local, record.instance, mask);
            });
    }

private:
    template <class F>
    static void for_each(unsigned mask, const F& f) {
        for (; mask != 0; mask &= mask - 1) f(static_cast<std::size_t>(__builtin_ctz(mask)));
    }

    void traverse_mesh(const BvhView& bvh, const RayPacket& rays, uint32_t instance, unsigned mask) {
        if (bvh.root == kNoLink || mask == 0) return;
        const PacketBoxes boxes =
            make_packet_boxes(rays, mask, [&](const Ray& ray) { return Tests::make_boxes(ray, bvh.bounds_max_abs); });
        std::array<typename Tests::Triangles, kPacketRays> prepared;
        for_each(mask, [&](std::size_t k) { prepared[k] = Tests::make_triangles(rays[k]); });
        alignas(32) float t_max[kPacketRays] = {};
        for_each(mask, [&](std::size_t k) { t_max[k] = rays[k].t_max; });
        unsigned here = mask; // rays of the packet that entered this mesh and are not done
        traverse_packet<kOptions.near_first>(bvh.nodes, bvh.root, boxes, kOptions.rta ? limits_ : t_max, here, counter_,
                                             [&](uint32_t link, unsigned in_leaf) {
                                                 for_each(in_leaf, [&](std::size_t k) {
                                                     if (test_leaf<Tests>(bvh.triangles, link, rays[k], prepared[k],
                                                                          instance, visitors_[k], counter_of_ray(k))) {
                                                         alive_ &= ~(1u << k);
                                                         here &= ~(1u << k);
                                                     }
                                                     limits_[k] = visitors_[k].limit();
                                                 });
                                             });
    }

    auto counter_of_ray(std::size_t k) const {
        if constexpr (requires { counter_.of_ray(k); }) {
            return counter_.of_ray(k);
        } else {
            return counter_;
        }
    }

    const SceneBvhView& scene_;
    const RayPacket& rays_;
    std::array<Visitor, kPacketRays>& visitors_;
    const Counter& counter_;
    unsigned alive_;
    alignas(32) float limits_[kPacketRays] = {};
};

/// Acceptance rules of each ray of a packet.
template <class Accept>
using PacketAccepts = std::array<Accept, kPacketRays>;

/// Closest hits of the rays in `active`. Returns the mask of those that hit something; other hits are not written.
template <TraversalOptions kOptions, class Accept, class Counter = NoTraversalCounter>
unsigned trace_packet_closest(const SceneBvhView& scene, const RayPacket& rays, unsigned active,
                              const PacketAccepts<Accept>& accepts, std::array<Hit, kPacketRays>& hits,
                              const Counter& counter = {}) {
    using Visitor = ClosestVisitor<Accept>;
    auto visitors = [&]<std::size_t... k>(std::index_sequence<k...>) {
        return std::array<Visitor, kPacketRays>{Visitor{accepts[k], Hit{.t = rays[k].t_max}}...};
    }(std::make_index_sequence<kPacketRays>());
    PacketTracer<kOptions, Visitor, Counter>(scene, rays, visitors, active, counter).run();
    unsigned found = 0;
    for (std::size_t k = 0; k < kPacketRays; ++k) {
        if (!(active >> k & 1)) continue;
        hits[k] = visitors[k].best;
        if (hits[k].instance != kNoHit) found |= 1u << k;
    }
    return found;
}

/// Occlusion of the rays in `active`. Returns the mask of those that hit something.
template <TraversalOptions kOptions, class Accept, class Counter = NoTraversalCounter>
unsigned trace_packet_any(const SceneBvhView& scene, const RayPacket& rays, unsigned active,
                          const PacketAccepts<Accept>& accepts, const Counter& counter = {}) {
    using Visitor = AnyVisitor<Accept>;
    auto visitors = [&]<std::size_t... k>(std::index_sequence<k...>) {
        return std::array<Visitor, kPacketRays>{Visitor{accepts[k], rays[k].t_max}...};
    }(std::make_index_sequence<kPacketRays>());
    PacketTracer<kOptions, Visitor, Counter>(scene, rays, visitors, active, counter).run();
    unsigned found = 0;
    for (std::size_t k = 0; k < kPacketRays; ++k) {
        if ((active >> k & 1) && visitors[k].found) found |= 1u << k;
    }
    return found;
}

} // namespace pertev
