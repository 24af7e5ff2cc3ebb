#include "lab/make_bunny_box.h"

#include <unordered_map>

#include "math/random.h"

namespace pertev {
namespace {

constexpr uint32_t kWallQuads = 32; // along each side of a wall
constexpr float kRoughness = 0.05f; // relative to the edge's length

/// Returns unit normals of vertices, weighted by area and summed in the triangles' order; zero for a vertex without
/// one.
std::vector<Vec3> vertex_normals(const Mesh& mesh) {
    std::vector<Vec3> normals(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const uint32_t* v = &mesh.indices[i];
        const Vec3 a = mesh.positions[v[0]];
        const Vec3 n = cross(mesh.positions[v[1]] - a, mesh.positions[v[2]] - a);
        for (int k = 0; k < 3; ++k) normals[v[k]] += n;
    }
    for (Vec3& n : normals) n = length_squared(n) > 0 ? normalize(n) : Vec3{};
    return normals;
}

/// Adds the vertex at the middle of the edge from `from` to `to`; from < to.
Vec3 split_edge(const Mesh& mesh, const std::vector<Vec3>& normals, uint32_t from, uint32_t to) {
    const Vec3 a = mesh.positions[from], b = mesh.positions[to];
    const Vec3 na = normals[from], nb = normals[to];
    Vec3 normal = na + nb;
    normal = length_squared(normal) > 0 ? normalize(normal) : Vec3{};
    // Where the normals of an arc turn by nb - na from end to end, its midpoint lies an eighth of that above the
    // chord.
    const float bulge = 0.125f * dot(nb - na, b - a);
    const Hash3 hash = hash_words(from, to, 1);
    const float rough = (2.0f * static_cast<float>(hash.x >> 8) * 0x1p-24f - 1.0f) * kRoughness * length(b - a);
    return 0.5f * (a + b) + (bulge + rough) * normal;
}

Mesh subdivide(const Mesh& mesh) {
    const std::vector<Vec3> normals = vertex_normals(mesh);
    Mesh finer;
    finer.positions = mesh.positions;
    std::unordered_map<uint64_t, uint32_t> middles; // looked up by key and never iterated, so its order does not
                                                    // matter
    middles.reserve(mesh.indices.size());
    const auto middle_of = [&](uint32_t p, uint32_t q) {
        const uint32_t from = min(p, q), to = max(p, q);
        const auto [at, is_new] =
            middles.try_emplace(uint64_t(from) << 32 | to, static_cast<uint32_t>(finer.positions.size()));
        if (is_new) finer.positions.push_back(split_edge(mesh, normals, from, to));
        return at->second;
    };
    finer.indices.reserve(4 * mesh.indices.size());
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
        const uint32_t ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
        finer.indices.insert(finer.indices.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    return finer;
}

/// Scales the mesh to height 2 and centres its box over the origin.
void stand_on_floor(Mesh& mesh) {
    const Bounds3 box = bounds_of(mesh);
    const float scale = 2.0f / box.size().y;
    const Vec3 foot = {box.centre().x, box.lo.y, box.centre().z};
    for (Vec3& p : mesh.positions) p = scale * (p - foot);
}

/// Adds a parallelogram of 32 x 32 quads with two triangles each.
void add_wall(Mesh& mesh, Vec3 corner, Vec3 across, Vec3 up) {
    const uint32_t first = static_cast<uint32_t>(mesh.positions.size()), row = kWallQuads + 1;
    for (uint32_t j = 0; j < row; ++j) {
        for (uint32_t i = 0; i < row; ++i) {
            const float s = static_cast<float>(i) / kWallQuads, t = static_cast<float>(j) / kWallQuads;
            mesh.positions.push_back(corner + s * across + t * up);
        }
    }
    for (uint32_t j = 0; j < kWallQuads; ++j) {
        for (uint32_t i = 0; i < kWallQuads; ++i) {
            const uint32_t a = first + j * row + i, b = a + 1, c = a + row + 1, d = a + row;
            mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
        }
    }
}

} // namespace

Mesh make_bunny_box(const Mesh& bunny) {
    Mesh mesh = subdivide(subdivide(bunny));
    stand_on_floor(mesh);
    add_wall(mesh, {-3, 0, 3}, {6, 0, 0}, {0, 0, -6}); // floor
    add_wall(mesh, {-3, 0, -3}, {6, 0, 0}, {0, 4, 0}); // back
    add_wall(mesh, {-3, 0, 3}, {0, 0, -6}, {0, 4, 0}); // left
    add_wall(mesh, {3, 0, -3}, {0, 0, 6}, {0, 4, 0});  // right
    mesh.name = "bunny";
    return mesh;
}

} // namespace pertev
