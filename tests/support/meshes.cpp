#include "tests/support/meshes.h"

#include <cmath>
#include <cstdlib>
#include <map>

#include "base/read_file.h"

namespace pertev::test {

TriangleMesh make_sphere(int subdivisions, Vec3 centre_m, float radius_m) {
    const float p = 0.5f * (1.0f + std::sqrt(5.0f));
    TriangleMesh mesh;
    mesh.positions = {{-1, p, 0},  {1, p, 0},  {-1, -p, 0}, {1, -p, 0}, {0, -1, p},  {0, 1, p},
                      {0, -1, -p}, {0, 1, -p}, {p, 0, -1},  {p, 0, 1},  {-p, 0, -1}, {-p, 0, 1}};
    mesh.indices = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
                    3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1};
    for (Vec3& v : mesh.positions) v = normalize(v);
    for (int round = 0; round < subdivisions; ++round) {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
        const auto middle = [&](uint32_t a, uint32_t b) {
            const auto [at, is_new] =
                middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<uint32_t>(mesh.positions.size()));
            if (is_new) mesh.positions.push_back(normalize(mesh.positions[a] + mesh.positions[b]));
            return at->second;
        };
        std::vector<uint32_t> finer;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
            const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
        }
        mesh.indices = std::move(finer);
    }
    for (Vec3& v : mesh.positions) v = centre_m + radius_m * v;
    return mesh;
}

TriangleMesh make_torus(int segments, int sides) {
    TriangleMesh mesh;
    for (int i = 0; i < segments; ++i) {
        // The mesh is uneven: large and small triangles are adjacent.
        const float s = kTwoPi * square(static_cast<float>(i) / static_cast<float>(segments));
        for (int j = 0; j < sides; ++j) {
            const float r = kTwoPi * static_cast<float>(j) / static_cast<float>(sides);
            const float tube = 0.4f + 0.1f * std::sin(7 * s) * std::cos(3 * r);
            const float ring = 1.0f + tube * std::cos(r);
            mesh.positions.push_back({ring * std::cos(s), tube * std::sin(r), ring * std::sin(s)});
        }
    }
    const auto at = [&](int i, int j) { return static_cast<uint32_t>((i % segments) * sides + j % sides); };
    for (int i = 0; i < segments; ++i) {
        for (int j = 0; j < sides; ++j) {
            mesh.indices.insert(mesh.indices.end(),
                                {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j)});
        }
    }
    return mesh;
}

TriangleMesh read_obj_geometry(const std::filesystem::path& path) {
    std::vector<std::byte> bytes = read_file(path);
    bytes.push_back(std::byte{0});
    TriangleMesh mesh;
    const char* p = reinterpret_cast<const char*>(bytes.data());
    while (*p != '\0') {
        const bool is_vertex = p[0] == 'v' && p[1] == ' ', is_face = p[0] == 'f' && p[1] == ' ';
        char* end = const_cast<char*>(p) + 1;
        if (is_vertex) {
            Vec3 v;
            for (float* x : {&v.x, &v.y, &v.z}) *x = std::strtof(end, &end);
            mesh.positions.push_back(v);
        } else if (is_face) {
            std::vector<uint32_t> corners;
            for (;;) {
                while (*end == ' ') ++end;
                if (*end == '\n' || *end == '\r' || *end == '\0') break;
                const long k = std::strtol(end, &end, 10);
                corners.push_back(static_cast<uint32_t>(k > 0 ? k - 1 : static_cast<long>(mesh.positions.size()) + k));
                while (*end != ' ' && *end != '\n' && *end != '\r' && *end != '\0') ++end; // texture and normal indices
            }
            for (std::size_t i = 2; i < corners.size(); ++i) {
                mesh.indices.insert(mesh.indices.end(), {corners[0], corners[i - 1], corners[i]});
            }
        }
        p = end;
        while (*p != '\n' && *p != '\0') ++p;
        if (*p == '\n') ++p;
    }
    return mesh;
}

std::vector<BvhTriangle> triangles_of(const TriangleMesh& mesh, uint32_t instance) {
    std::vector<BvhTriangle> triangles;
    for (uint32_t i = 0; i < mesh.triangle_count(); ++i) {
        triangles.push_back({mesh.corner(i, 0), i, mesh.corner(i, 1), instance, mesh.corner(i, 2), 0});
    }
    return triangles;
}

} // namespace pertev::test
