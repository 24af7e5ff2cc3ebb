#include "scene/tangents/tangent_groups.h"

#include <algorithm>
#include <bit>
#include <compare>
#include <deque>

#include "base/key_numbers.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr uint32_t kNoCorner = 0xffffffffu;

/// Returns the bits of a float; both zeros have the same.
uint32_t bits_of_number(float x) { return std::bit_cast<uint32_t>(x + 0.0f); }

std::vector<uint32_t> weld(const TangentMesh& mesh) {
    KeyNumbers<std::array<uint32_t, 8>> known(mesh.positions.size());
    std::vector<uint32_t> of_vertex(mesh.positions.size());
    for (std::size_t i = 0; i < of_vertex.size(); ++i) {
        const Vec3 p = mesh.positions[i], n = mesh.normals[i];
        const Vec2 uv = mesh.uv[i];
        of_vertex[i] =
            known.number_of({bits_of_number(p.x), bits_of_number(p.y), bits_of_number(p.z), bits_of_number(n.x),
                             bits_of_number(n.y), bits_of_number(n.z), bits_of_number(uv.x), bits_of_number(uv.y)});
    }
    std::vector<uint32_t> welded(mesh.corner_count());
    for (std::size_t i = 0; i < welded.size(); ++i) welded[i] = of_vertex[mesh.indices[i]];
    return welded;
}

enum class TriangleKind : uint8_t {
    TwoEqual, // two of its positions are equal, so it has no area
    Unknown,  // its texture coordinates have no direction
    Known,
};

struct Triangles {
    std::vector<TriangleKind> kind;            // [triangles]
    std::vector<uint8_t> is_counter_clockwise; // [triangles]
};

Triangles sort_out(const TangentMesh& mesh) {
    Triangles triangles;
    const std::size_t count = mesh.corner_count() / 3;
    triangles.kind.resize(count);
    triangles.is_counter_clockwise.resize(count);
    parallel_for(count, 1 << 12, [&](uint64_t i) {
        const Vec3 a = mesh.position(3 * i), b = mesh.position(3 * i + 1), c = mesh.position(3 * i + 2);
        const UvDirections directions = uv_directions(mesh, i);
        triangles.is_counter_clockwise[i] = directions.is_counter_clockwise;
        triangles.kind[i] = a == b || b == c || c == a ? TriangleKind::TwoEqual
                            : directions.is_known      ? TriangleKind::Known
                                                       : TriangleKind::Unknown;
    });
    return triangles;
}

/// An edge in the list of its vertex with the lower number. `corner` is the corner of the triangle at which the edge
/// begins.
struct Edge {
    uint32_t higher, corner;
    auto operator<=>(const Edge&) const = default;
};

/// All edges of triangles, sorted by their lower vertex: those of vertex i are [first[i], first[i + 1]).
struct EdgeLists {
    std::vector<std::size_t> first;
    std::vector<Edge> edges;
};

EdgeLists list_edges(const std::vector<uint32_t>& welded, const Triangles& triangles) {
    EdgeLists lists;
    const uint32_t vertices = welded.empty() ? 0 : *std::ranges::max_element(welded) + 1;
    lists.first.resize(vertices + std::size_t(1));
    const auto for_each_edge = [&](const auto& body) {
        for (std::size_t corner = 0; corner < welded.size(); ++corner) {
            if (triangles.kind[corner / 3] == TriangleKind::TwoEqual) continue;
            const uint32_t a = welded[corner], b = welded[next_corner(corner)];
            body(std::min(a, b), Edge{std::max(a, b), static_cast<uint32_t>(corner)});
        }
    };
    for_each_edge([&](uint32_t lower, const Edge&) { ++lists.first[lower + std::size_t(1)]; });
    for (std::size_t i = 0; i < vertices; ++i) lists.first[i + 1] += lists.first[i];
    lists.edges.resize(lists.first[vertices]);
    std::vector<std::size_t> next = lists.first;
    for_each_edge([&](uint32_t lower, const Edge& edge) { lists.edges[next[lower]++] = edge; });
    return lists;
}

/// Returns for each corner the neighbour across the edge that begins there: the corner at which the neighbour begins
/// that edge, which is at its other end; or kNoCorner. Where more than two triangles share an edge, each takes the
/// first by number that runs along it in the other direction and has no neighbour yet.
std::vector<uint32_t> find_neighbours(const std::vector<uint32_t>& welded, const Triangles& triangles) {
    EdgeLists lists = list_edges(welded, triangles);
    std::vector<uint32_t> neighbour(welded.size(), kNoCorner);
    std::deque<uint32_t> waiting; // corners of one edge, all in the same direction
    for (std::size_t lower = 0; lower + 1 < lists.first.size(); ++lower) {
        const std::span<Edge> edges =
            std::span(lists.edges).subspan(lists.first[lower], lists.first[lower + 1] - lists.first[lower]);
        std::ranges::sort(edges);
        for (std::size_t i = 0; i < edges.size(); ++i) {
            if (i > 0 && edges[i].higher != edges[i - 1].higher) waiting.clear();
            const uint32_t corner = edges[i].corner;
            if (waiting.empty() || welded[waiting.front()] == welded[corner]) {
                waiting.push_back(corner);
                continue;
            }
            neighbour[corner] = waiting.front();
            neighbour[waiting.front()] = corner;
            waiting.pop_front();
        }
        waiting.clear();
    }
    return neighbour;
}

/// Extends each group over connected corners.
class Grouping {
public:
    Grouping(const std::vector<uint32_t>& neighbour, Triangles& triangles, TangentGroups& groups)
        : neighbour_(neighbour), triangles_(triangles), groups_(groups) {}

    void run() {
        groups_.group.assign(neighbour_.size(), kNoTangentGroup);
        for (uint32_t corner = 0; corner < neighbour_.size(); ++corner) {
            if (triangles_.kind[corner / 3] != TriangleKind::Known || has_group(corner)) continue;
            const uint8_t winding = triangles_.is_counter_clockwise[corner / 3];
            groups_.is_counter_clockwise.push_back(winding);
            take(corner);
            while (!open_.empty()) {
                const uint32_t reached = open_.back();
                open_.pop_back();
                if (!has_group(reached) && fits(reached, winding)) take(reached);
            }
        }
    }

private:
    bool has_group(std::size_t corner) const { return groups_.group[corner] != kNoTangentGroup; }

    bool fits(uint32_t corner, uint8_t winding) {
        const std::size_t triangle = corner / 3;
        const bool is_free = !has_group(3 * triangle) && !has_group(3 * triangle + 1) && !has_group(3 * triangle + 2);
        if (triangles_.kind[triangle] == TriangleKind::Unknown && is_free) {
            triangles_.is_counter_clockwise[triangle] = winding;
        }
        return triangles_.is_counter_clockwise[triangle] == winding;
    }

    /// Adds a corner to the group. The neighbour across the edge that begins here is pushed last, so that it is visited
    /// first.
    void take(uint32_t corner) {
        groups_.group[corner] = static_cast<uint32_t>(groups_.count() - 1);
        const uint32_t before = neighbour_[previous_corner(corner)], after = neighbour_[corner];
        if (before != kNoCorner) open_.push_back(before); // its edge begins at this vertex
        if (after != kNoCorner) open_.push_back(static_cast<uint32_t>(next_corner(after)));
    }

    const std::vector<uint32_t>& neighbour_;
    Triangles& triangles_;
    TangentGroups& groups_;
    std::vector<uint32_t> open_; // corners that the group has reached
};

void list_corners(TangentGroups& groups) {
    groups.first.assign(groups.count() + 1, 0);
    for (const uint32_t group : groups.group) {
        if (group != kNoTangentGroup) ++groups.first[group + std::size_t(1)];
    }
    for (std::size_t i = 0; i < groups.count(); ++i) groups.first[i + 1] += groups.first[i];
    groups.corners.resize(groups.first.back());
    std::vector<uint32_t> next = groups.first;
    for (uint32_t corner = 0; corner < groups.group.size(); ++corner) {
        const uint32_t group = groups.group[corner];
        if (group != kNoTangentGroup) groups.corners[next[group]++] = corner;
    }
}

std::vector<BorrowedTangent> find_tangent_sources(const std::vector<uint32_t>& welded, const Triangles& triangles) {
    std::vector<BorrowedTangent> borrowed;
    const auto is_two_equal = [&](std::size_t corner) { return triangles.kind[corner / 3] == TriangleKind::TwoEqual; };
    std::vector<uint32_t> first; // [vertex] a corner of a triangle with three positions
    for (uint32_t corner = 0; corner < welded.size(); ++corner) {
        if (!is_two_equal(corner)) continue;
        if (first.empty()) {
            first.assign(*std::ranges::max_element(welded) + std::size_t(1), kNoCorner);
            for (std::size_t i = welded.size(); i-- > 0;) {
                if (!is_two_equal(i)) first[welded[i]] = static_cast<uint32_t>(i);
            }
        }
        if (first[welded[corner]] != kNoCorner) borrowed.push_back({corner, first[welded[corner]]});
    }
    return borrowed;
}

} // namespace

TangentGroups make_tangent_groups(const TangentMesh& mesh) {
    TangentGroups groups;
    const std::vector<uint32_t> welded = weld(mesh);
    Triangles triangles = sort_out(mesh);
    const std::vector<uint32_t> neighbour = find_neighbours(welded, triangles);
    Grouping(neighbour, triangles, groups).run();
    list_corners(groups);
    groups.borrowed = find_tangent_sources(welded, triangles);
    return groups;
}

} // namespace pertev
