#pragma once

// Sets of points that are difficult for searches: ties, duplicates, planes, lattices, all points at one position, and
// no points. It also has a brute-force search.

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "accel/nearest_points.h"
#include "tests/support/random.h"

namespace pertev::test {

struct StressPoints {
    const char* name;
    std::vector<Vec3> points;
    float extent = 1; // query points are within 2 extents of 0
};

inline std::vector<StressPoints> stress_points(uint32_t count) {
    std::vector<StressPoints> sets = {{"none", {}},
                                      {"one", {{0.25f, 0.5f, -1}}},
                                      {"two alike", {{0, 1, 0}, {0, 1, 0}}},
                                      {"all equal", {}},
                                      {"anywhere", {}},
                                      {"lattice", {}},
                                      {"in a plane", {}},
                                      {"in a line", {}},
                                      {"huge", {}, 0x1p40f},
                                      {"tiny", {}, 0x1p-130f},
                                      {"clusters", {}}};
    Random random(3);
    std::vector<Vec3> centres;
    for (int i = 0; i < 12; ++i) centres.push_back(random.point(-1, 1));
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 p = random.point(-1, 1);
        const auto snap = [](float x) { return floor(4 * x + 0.5f) * 0.25f; };
        sets[3].points.push_back({0.25f, -0.5f, 0.75f});
        sets[4].points.push_back(p);
        sets[5].points.push_back({snap(p.x), snap(p.y), snap(p.z)}); // each point occurs many times
        sets[6].points.push_back({p.x, i % 2 ? 0.0f : -0.0f, p.z});
        sets[7].points.push_back({0.5f, p.y, 0.5f});
        sets[8].points.push_back(0x1p40f * p);
        sets[9].points.push_back(0x1p-130f * p);
        sets[10].points.push_back(centres[i % 12] + (i % 12 < 6 ? 1e-6f : 1e-2f) * p);
    }
    return sets;
}

/// Returns positions near and far, at points, and on lattice planes.
inline std::vector<Vec3> query_points(const StressPoints& set, uint32_t count) {
    std::vector<Vec3> places;
    Random random(8);
    for (uint32_t i = 0; i < count; ++i) {
        Vec3 p = set.extent * random.point(-2, 2);
        if (i % 3 == 1 && !set.points.empty()) p = set.points[random.below(static_cast<uint32_t>(set.points.size()))];
        if (i % 3 == 2) {
            const auto snap = [](float x) { return floor(4 * x + 0.5f) * 0.25f; };
            const Vec3 q = random.point(-1, 1);
            p = set.extent * Vec3{snap(q.x), snap(q.y), snap(q.z)};
        }
        places.push_back(p);
    }
    return places;
}

/// Returns all points within the radius, sorted by distance and then by index.
inline std::vector<NearPoint> within_by_brute_force(const std::vector<Vec3>& points, Vec3 at, float radius) {
    std::vector<NearPoint> found;
    for (uint32_t i = 0; i < points.size(); ++i) {
        const Vec3 d = points[i] - at;
        const float distance_squared = d.x * d.x + d.y * d.y + d.z * d.z;
        if (radius >= 0 && distance_squared <= radius * radius) found.push_back({distance_squared, i});
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const NearPoint& a, const NearPoint& b) { return a.distance_squared < b.distance_squared; });
    return found;
}

inline const float kRadii[] = {0, 1e-6f, 0.1f, 0.25f, 0.5f, 1, 4, -1, kInfinity}; // in multiples of the extent

/// Compares both searches of a tree over `set` with brute force.
template <class View>
std::string find_wrong_search(const View& view, const StressPoints& set, uint32_t places) {
    const auto n = static_cast<uint32_t>(set.points.size());
    for (const Vec3 at : query_points(set, places)) {
        for (const float radius : kRadii) {
            const std::vector<NearPoint> want = within_by_brute_force(set.points, at, radius * set.extent);
            std::vector<NearPoint> seen;
            visit_within(view, at, radius * set.extent, [&](const NearPoint& p) { seen.push_back(p); });
            std::sort(seen.begin(), seen.end(), [](const NearPoint& a, const NearPoint& b) { return is_nearer(a, b); });
            if (seen != want) return "all within " + std::to_string(radius);
            for (const uint32_t k : {0u, 1u, 2u, 7u, 50u, n, n + 3}) {
                std::vector<NearPoint> found(k + 1, NearPoint{-2, 77});
                const uint32_t count = find_nearest(view, at, radius * set.extent, k, found.data());
                const std::size_t expected = std::min<std::size_t>(k, want.size());
                if (count != expected || !(found[k] == NearPoint{-2, 77})) return "count of " + std::to_string(k);
                if (!std::equal(want.begin(), want.begin() + static_cast<std::ptrdiff_t>(expected), found.begin())) {
                    return std::to_string(k) + " nearest within " + std::to_string(radius);
                }
            }
        }
    }
    return "";
}

} // namespace pertev::test
