#include "tests/support/stress_meshes.h"

#include <cstdio>
#include <utility>

namespace pertev::test {
namespace {

std::vector<BvhTriangle> grid_with_doubles() {
    // An axis-aligned lattice of quads in which each triangle occurs twice: every hit is a tie, and every box is flat.
    std::vector<BvhTriangle> triangles;
    for (int axis = 0; axis < 3; ++axis) {
        for (int k = -3; k <= 3; ++k) {
            for (int i = -3; i < 3; ++i) {
                for (int j = -3; j < 3; ++j) {
                    const auto at = [&](int a, int b) {
                        const float p[3] = {static_cast<float>(k), static_cast<float>(a), static_cast<float>(b)};
                        return Vec3{p[(3 - axis) % 3], p[(4 - axis) % 3], p[(5 - axis) % 3]};
                    };
                    for (int twice = 0; twice < 2; ++twice) {
                        const auto id = static_cast<uint32_t>(triangles.size());
                        triangles.push_back({at(i, j), id, at(i + 1, j), id % 2, at(i + 1, j + 1), 0});
                        triangles.push_back({at(i, j), id + 1, at(i + 1, j + 1), id % 2, at(i, j + 1), 0});
                    }
                }
            }
        }
    }
    // Scene order and memory order differ.
    Random random(3);
    for (std::size_t i = triangles.size(); i > 1; --i) {
        std::swap(triangles[i - 1], triangles[random.below(static_cast<uint32_t>(i))]);
    }
    return triangles;
}

/// Three triangles repeated: no plane separates the copies.
std::vector<BvhTriangle> coincident(uint32_t count) {
    const Vec3 corners[3][3] = {{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}},
                                {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}},
                                {{-1, -1, -1}, {1, 1, 1}, {1, -1, 0}}};
    std::vector<BvhTriangle> triangles;
    for (uint32_t i = 0; i < count; ++i) {
        const auto& c = corners[i % 3];
        triangles.push_back({.a = c[0], .primitive = count - i, .b = c[1], .instance = 1, .c = c[2]});
    }
    return triangles;
}

/// Slivers a thousand times longer than wide, in every direction.
std::vector<BvhTriangle> slivers(uint32_t count) {
    std::vector<BvhTriangle> triangles;
    Random random(7);
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 at = random.point(-1, 1), along = 2 * random.direction();
        triangles.push_back({.a = at - along,
                             .primitive = i,
                             .b = at + along,
                             .instance = 0,
                             .c = at + along + 4e-3f * random.direction()});
    }
    return triangles;
}

/// Triangles in a line, so that a split at the spatial median separates few.
std::vector<BvhTriangle> in_a_line(uint32_t count) {
    std::vector<BvhTriangle> triangles;
    for (uint32_t i = 0; i < count; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(count), x = 4 * t * t * t * t - 1;
        triangles.push_back(
            {.a = {x, -0.5f, -0.5f}, .primitive = i, .b = {x, 0.5f, -0.5f}, .instance = 3, .c = {x, 0, 0.5f}});
    }
    return triangles;
}

std::vector<BvhTriangle> scaled(std::vector<BvhTriangle> triangles, float factor) {
    for (BvhTriangle& t : triangles) t.a = factor * t.a, t.b = factor * t.b, t.c = factor * t.c;
    return triangles;
}

} // namespace

std::vector<BvhTriangle> make_soup(uint32_t count, float away) {
    std::vector<BvhTriangle> triangles;
    Random random(11);
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 at = random.point(-1, 1) + Vec3{away, 0, -away};
        const float size = i % 7 == 0 ? 1.0f : 0.05f;
        BvhTriangle t;
        t.a = at + random.point(-size, size);
        t.b = at + random.point(-size, size);
        t.c = i % 11 == 0 ? t.a : at + random.point(-size, size); // some have no area
        t.primitive = i / 2, t.instance = i % 2;
        triangles.push_back(t);
    }
    return triangles;
}

std::vector<StressMesh> stress_meshes(uint32_t line) {
    return {{"lattice of doubled quads", grid_with_doubles(), {}},
            {"coincident triangles", coincident(500), {}},
            {"slivers", slivers(1000), {}},
            {"soup", make_soup(3000, 0), {}},
            {"soup 150 km away", make_soup(1500, 1.5e5f), {1.5e5f, 0, -1.5e5f}},
            {"huge coordinates", scaled(make_soup(1000, 0), 0x1p38f), {}, 0x1p36f},
            {"a line", in_a_line(line), {}},
            {"torus", triangles_of(make_torus(40, 24), 5), {}},
            {"one triangle", make_soup(1, 0), {}},
            {"nothing", {}, {}}};
}

std::vector<Ray> stress_rays(uint32_t count, const StressMesh& mesh, uint32_t seed) {
    std::vector<Ray> rays;
    Random random(seed);
    const auto triangle = [&]() -> const BvhTriangle& {
        return mesh.triangles[random.below(static_cast<uint32_t>(mesh.triangles.size()))];
    };
    for (uint32_t i = 0; i < count; ++i) {
        Ray ray;
        ray.origin = mesh.centre + mesh.extent * random.point(-4, 4);
        ray.direction = random.direction();
        const auto snap = [](float x) { return floor(x + 0.5f); };
        if (i % 2 == 0) ray.origin = {snap(ray.origin.x), snap(ray.origin.y), snap(ray.origin.z)};
        if (i % 4 == 0) ray.direction = {snap(ray.direction.x), snap(ray.direction.y), snap(ray.direction.z)};
        if (i % 16 == 2) ray.direction = {0.0f, -0.0f, random.unit() < 0.5f ? 1.0f : -1.0f};
        if (i % 16 == 6) ray.direction = {1.0f, 0x1p-140f, -0x1p-90f};
        if (i % 5 == 1 && !mesh.triangles.empty()) ray.direction = triangle().b - ray.origin;
        if (i % 20 == 3 && !mesh.triangles.empty()) { // the ray runs along an edge
            const BvhTriangle& t = triangle();
            ray.direction = t.b - t.a;
            ray.origin = t.a - 2 * ray.direction;
        }
        if (ray.direction == Vec3{}) ray.direction = {1, 0, 0};
        if (i % 3 == 0) {
            ray.t_min = 1;
            ray.t_max = static_cast<float>(1 + random.below(4));
        }
        rays.push_back(ray);
    }
    return rays;
}

std::string text_of(const Ray& r) {
    char text[256];
    std::snprintf(text, sizeof text, "origin %a %a %a direction %a %a %a t %a %a", static_cast<double>(r.origin.x),
                  static_cast<double>(r.origin.y), static_cast<double>(r.origin.z), static_cast<double>(r.direction.x),
                  static_cast<double>(r.direction.y), static_cast<double>(r.direction.z), static_cast<double>(r.t_min),
                  static_cast<double>(r.t_max));
    return text;
}

} // namespace pertev::test
