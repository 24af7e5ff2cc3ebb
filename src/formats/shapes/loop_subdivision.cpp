#include "formats/shapes/loop_subdivision.h"

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "formats/mesh/smooth_normals.h"

namespace pertev {
namespace {

/// An edge with the two corners opposite it; at a boundary there is one triangle, at a bad mesh more than two.
struct Edge {
    uint32_t a, b, opposite[2] = {0, 0}, triangles = 0, middle = 0;
    bool is_inner() const { return triangles == 2; }
};

/// The neighbours of a vertex.
struct Ring {
    Vec3 sum; // positions of all neighbours
    uint32_t valence = 0;
    Vec3 boundary_sum; // positions of the neighbours along boundary edges
    uint32_t boundary_edges = 0;
};

class Step {
public:
    explicit Step(const Mesh& mesh) : mesh_(mesh), rings_(mesh.positions.size()) {
        std::unordered_map<uint64_t, uint32_t> numbers;
        for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
            const std::size_t first = i - i % 3;
            const uint32_t from = mesh.indices[i], to = mesh.indices[first + (i + 1) % 3];
            const uint64_t key = uint64_t(std::min(from, to)) << 32 | std::max(from, to);
            const auto [found, is_new] = numbers.try_emplace(key, static_cast<uint32_t>(edges_.size()));
            if (is_new) edges_.push_back({.a = from, .b = to});
            Edge& edge = edges_[found->second];
            if (edge.triangles < 2) edge.opposite[edge.triangles] = mesh.indices[first + (i + 2) % 3];
            ++edge.triangles;
            edges_of_corners_.push_back(found->second);
        }
        for (const Edge& edge : edges_) {
            add_neighbour(edge.a, edge.b, edge.is_inner());
            add_neighbour(edge.b, edge.a, edge.is_inner());
        }
    }

    /// Returns the mesh after one step, with four triangles for each.
    Mesh subdivided() {
        Mesh finer;
        for (std::size_t i = 0; i < rings_.size(); ++i) finer.positions.push_back(moved(i));
        for (Edge& edge : edges_) {
            edge.middle = static_cast<uint32_t>(finer.positions.size());
            const Vec3 ends = mesh_.positions[edge.a] + mesh_.positions[edge.b];
            const Vec3 sides = mesh_.positions[edge.opposite[0]] + mesh_.positions[edge.opposite[1]];
            finer.positions.push_back(edge.is_inner() ? 0.375f * ends + 0.125f * sides : 0.5f * ends);
        }
        for (std::size_t i = 0; i < mesh_.indices.size(); i += 3) {
            const uint32_t* const corner = &mesh_.indices[i];
            const uint32_t ab = edges_[edges_of_corners_[i]].middle, bc = edges_[edges_of_corners_[i + 1]].middle,
                           ca = edges_[edges_of_corners_[i + 2]].middle;
            finer.indices.insert(finer.indices.end(),
                                 {corner[0], ab, ca, ab, corner[1], bc, ca, bc, corner[2], ab, bc, ca});
        }
        return finer;
    }

    /// Returns where vertex `i` lies on the limit surface.
    Vec3 limit(std::size_t i) const {
        const Ring& ring = rings_[i];
        if (ring.valence == 0) return mesh_.positions[i];
        if (ring.boundary_edges > 0) {
            return ring.boundary_edges == 2 ? (4 * mesh_.positions[i] + ring.boundary_sum) / 6.0f : mesh_.positions[i];
        }
        const auto n = static_cast<float>(ring.valence);
        const float weight = 1 / (n + 3 / (8 * beta(ring.valence)));
        return (1 - n * weight) * mesh_.positions[i] + weight * ring.sum;
    }

private:
    static float beta(uint32_t valence) { return valence == 3 ? 0.1875f : 3 / (8 * static_cast<float>(valence)); }

    void add_neighbour(uint32_t vertex, uint32_t neighbour, bool is_inner) {
        Ring& ring = rings_[vertex];
        ring.sum += mesh_.positions[neighbour];
        ++ring.valence;
        if (is_inner) return;
        ring.boundary_sum += mesh_.positions[neighbour];
        ++ring.boundary_edges;
    }

    Vec3 moved(std::size_t i) const {
        const Ring& ring = rings_[i];
        if (ring.valence == 0) return mesh_.positions[i];
        if (ring.boundary_edges > 0) { // a vertex of several boundaries stays
            return ring.boundary_edges == 2 ? 0.75f * mesh_.positions[i] + 0.125f * ring.boundary_sum
                                            : mesh_.positions[i];
        }
        const float weight = beta(ring.valence);
        return (1 - static_cast<float>(ring.valence) * weight) * mesh_.positions[i] + weight * ring.sum;
    }

    const Mesh& mesh_;
    std::vector<Ring> rings_;
    std::vector<Edge> edges_;
    std::vector<uint32_t> edges_of_corners_; // the edge that begins at each corner
};

} // namespace

uint32_t subdivide_loop(uint32_t levels, Mesh& mesh) {
    Mesh now;
    now.positions = mesh.positions;
    now.indices = mesh.indices;
    uint32_t done = 0;
    for (; done < levels && uint64_t(now.triangle_count()) * 4 <= kMostSubdivided; ++done) now = Step(now).subdivided();
    const Step last(now);
    std::vector<Vec3> limits;
    for (std::size_t i = 0; i < now.positions.size(); ++i) limits.push_back(last.limit(i));
    now.positions = std::move(limits);
    now.normals = angle_weighted_normals(now);
    now.name = std::move(mesh.name);
    now.origin = std::move(mesh.origin);
    mesh = std::move(now);
    return done;
}

} // namespace pertev
