#pragma once

// Collects the k nearest points that a search visits, in an array of the caller's: a heap with the farthest point on
// top during the search, sorted by distance at its end. Ties are broken by index, so the result depends on the points
// and not on the order of visits.

#include <cstdint>

#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

struct NearPoint {
    float distance_squared; // square metres, as squared_distance rounds it
    uint32_t index;         // in the builder's input
    bool operator==(const NearPoint&) const = default;
};

HD inline bool is_nearer(const NearPoint& a, const NearPoint& b) {
    return a.distance_squared < b.distance_squared || (a.distance_squared == b.distance_squared && a.index < b.index);
}

/// Squared distance, by the only formula that searches use. It is monotonic in each component of |a - b|, rounding
/// included. Thus the distance to a plane or a box is never more than the distance to a point behind or in it.
HD inline float squared_distance(Vec3 a, Vec3 b) {
    const Vec3 d = a - b;
    return d.x * d.x + d.y * d.y + d.z * d.z;
}

/// Square of a radius; below any squared distance if the radius is negative or NaN.
HD inline float square_of_radius(float radius) { return radius >= 0 ? radius * radius : -1.0f; }

class NearestPoints {
public:
    /// Collects in `points`, which has room for `capacity` elements. Points farther than the radius are ignored.
    HD NearestPoints(NearPoint* points, uint32_t capacity, float radius_squared)
        : points_(points), capacity_(capacity), limit_(capacity > 0 ? radius_squared : -1.0f) {}

    /// Square of the distance beyond which points are ignored.
    HD float limit() const { return limit_; }

    HD void offer(const NearPoint& p) {
        if (!(p.distance_squared <= limit_)) return;
        if (size_ < capacity_) {
            sift_up(size_++, p);
        } else if (is_nearer(p, points_[0])) {
            sift_down(0, p);
        }
        if (size_ == capacity_) limit_ = points_[0].distance_squared;
    }

    /// Sorts the points by distance and returns their number.
    HD uint32_t sort() {
        const uint32_t count = size_;
        while (size_ > 1) {
            const NearPoint farthest = points_[0], last = points_[--size_];
            sift_down(0, last);
            points_[size_] = farthest;
        }
        return count;
    }

private:
    HD void sift_up(uint32_t at, const NearPoint& p) {
        while (at > 0 && is_nearer(points_[(at - 1) / 2], p)) {
            points_[at] = points_[(at - 1) / 2];
            at = (at - 1) / 2;
        }
        points_[at] = p;
    }
    HD void sift_down(uint32_t at, const NearPoint& p) {
        for (uint64_t child = 2 * uint64_t(at) + 1; child < size_; child = 2 * uint64_t(at) + 1) {
            if (child + 1 < size_ && is_nearer(points_[child], points_[child + 1])) ++child;
            if (!is_nearer(p, points_[child])) break;
            points_[at] = points_[child];
            at = static_cast<uint32_t>(child);
        }
        points_[at] = p;
    }

    NearPoint* points_;
    uint32_t capacity_, size_ = 0;
    float limit_;
};

/// Calls `visit` for each point within a radius, in the order of the search.
template <class Visit>
struct PointsWithin {
    float radius_squared;
    Visit& visit;
    HD float limit() const { return radius_squared; }
    HD void offer(const NearPoint& p) const {
        if (p.distance_squared <= radius_squared) visit(p);
    }
};

// These functions work for each structure with a function search_points(tree, at, found), which offers `found` every
// point that may be within its limit, in an order that depends only on the points and `at`.

/// Finds the k points nearest to `at` within `radius` (inclusive; may be infinite), sorted by distance and then by
/// index. `found` has room for k. Returns their number.
template <class Tree>
HD inline uint32_t find_nearest(const Tree& tree, Vec3 at, float radius, uint32_t k, NearPoint* found) {
    NearestPoints nearest(found, k, square_of_radius(radius));
    search_points(tree, at, nearest);
    return nearest.sort();
}

/// Calls visit(NearPoint) for each point within `radius` of `at`. `share` is for structures whose searches can be
/// split into shares.
template <class Tree, class Visit, class... Share>
HD inline void visit_within(const Tree& tree, Vec3 at, float radius, Visit&& visit, Share... share) {
    PointsWithin<Visit> within = {square_of_radius(radius), visit};
    search_points(tree, at, within, share...);
}

} // namespace pertev
