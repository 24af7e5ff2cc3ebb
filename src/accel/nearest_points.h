#pragma once

// The k nearest of the points that a search comes across, in an array of the caller's: a heap with the farthest on top
// while the search runs, nearest first at its end. Equal distances are told apart by index, so the result is a function
// of the points and not of the order in which they are met.

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

/// The one formula for all searches. It grows with each of |a - b|'s components, rounding included: so the distance to
/// a plane or a box, by the same formula, is never more than that to a point behind or in it.
HD inline float squared_distance(Vec3 a, Vec3 b) {
    const Vec3 d = a - b;
    return d.x * d.x + d.y * d.y + d.z * d.z;
}

/// The radius's square; below any squared distance where it is negative or NaN.
HD inline float square_of_radius(float radius) { return radius >= 0 ? radius * radius : -1.0f; }

class NearestPoints {
public:
    /// `points` has room for `capacity`. Points with a squared distance greater than that of the radius do not count.
    HD NearestPoints(NearPoint* points, uint32_t capacity, float radius_squared)
        : points_(points), capacity_(capacity), limit_(capacity > 0 ? radius_squared : -1.0f) {}

    /// What is farther than this, squared, is of no interest.
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

    /// Nearest first from here on; returns how many there are.
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

/// Shows `visit` each point within a radius, in whatever order a search offers them.
template <class Visit>
struct PointsWithin {
    float radius_squared;
    Visit& visit;
    HD float limit() const { return radius_squared; }
    HD void offer(const NearPoint& p) const {
        if (p.distance_squared <= radius_squared) visit(p);
    }
};

// These are for each structure that has a search_points(tree, at, found). It offers `found` all points that may be
// within its limit, in an order that only the points and `at` decide.

/// The k points nearest to `at`, at most `radius` away (inclusive; may be infinite), nearest first, of equally far ones
/// those of lower index. `found` has room for k. Returns how many there are.
template <class Tree>
HD inline uint32_t find_nearest(const Tree& tree, Vec3 at, float radius, uint32_t k, NearPoint* found) {
    NearestPoints nearest(found, k, square_of_radius(radius));
    search_points(tree, at, nearest);
    return nearest.sort();
}

/// Calls visit(NearPoint) for each point at most `radius` away. A `share` is of a structure whose searches have shares.
template <class Tree, class Visit, class... Share>
HD inline void visit_within(const Tree& tree, Vec3 at, float radius, Visit&& visit, Share... share) {
    PointsWithin<Visit> within = {square_of_radius(radius), visit};
    search_points(tree, at, within, share...);
}

} // namespace pertev
