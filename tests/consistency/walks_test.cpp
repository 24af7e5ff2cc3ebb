// The hit is a function of the scene, not of the walk: trees of every build setting give, bit for bit, what testing
// every triangle gives, also where many triangles lie at one t, and for rays along the planes of boxes.

#include <doctest/doctest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "accel/bvh/build_bvh.h"
#include "accel/bvh/top_level_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "tests/support/meshes.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// A pure function of the primitive and the place on it, as an alpha cut-out is.
struct AcceptSome {
    HD bool operator()(uint32_t instance, uint32_t primitive, float u, float) const {
        return (primitive * 2654435761u + instance) % 3 != 0 || u > 0.5f;
    }
};

std::vector<BvhTriangle> grid_with_doubles() {
    // An axis-aligned lattice of quads, each triangle there twice: every hit is a tie, every box is flat.
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

std::vector<BvhTriangle> soup(uint32_t count, float away) {
    std::vector<BvhTriangle> triangles;
    Random random(11);
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 at = random.point(-1, 1) + Vec3{away, 0, -away};
        const float size = i % 7 == 0 ? 1.0f : 0.05f;
        BvhTriangle t;
        t.a = at + random.point(-size, size);
        t.b = at + random.point(-size, size);
        t.c = i % 11 == 0 ? t.a : at + random.point(-size, size); // some without area
        t.primitive = i / 2, t.instance = i % 2;
        triangles.push_back(t);
    }
    return triangles;
}

/// Rays at random, at vertices, along axes, along planes and edges of boxes, through lattice points, and with short t
/// ranges.
std::vector<Ray> nasty_rays(uint32_t count, Vec3 centre, const std::vector<BvhTriangle>& targets, uint32_t seed) {
    std::vector<Ray> rays;
    Random random(seed);
    for (uint32_t i = 0; i < count; ++i) {
        Ray ray;
        ray.origin = centre + random.point(-4, 4);
        ray.direction = random.direction();
        const auto snap = [](float x) { return floor(x + 0.5f); };
        if (i % 2 == 0) ray.origin = {snap(ray.origin.x), snap(ray.origin.y), snap(ray.origin.z)};
        if (i % 4 == 0) ray.direction = {snap(ray.direction.x), snap(ray.direction.y), snap(ray.direction.z)};
        if (i % 16 == 2) ray.direction = {0.0f, -0.0f, random.unit() < 0.5f ? 1.0f : -1.0f};
        if (i % 16 == 6) ray.direction = {1.0f, 0x1p-140f, -0x1p-90f};
        if (i % 5 == 1 && !targets.empty()) {
            ray.direction = targets[random.below(static_cast<uint32_t>(targets.size()))].b - ray.origin;
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

template <class Accept>
void check_rays(const SceneBvhView& scene, const std::vector<Ray>& rays, const std::vector<Hit>& expected,
                const Accept& accept) {
    uint64_t wrong = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        Hit hit;
        const bool found = trace_closest(scene, rays[i], accept, hit);
        const bool any = trace_any(scene, rays[i], accept);
        Hit want = expected[i];
        if (want.instance == kNoHit) want.t = rays[i].t_max;
        if (hit == want && found == (want.instance != kNoHit) && any == found) continue;
        if (wrong++ == 0) FAIL_CHECK("ray ", i, ": ", text_of(rays[i]), " t ", hit.t, " want ", want.t, " any ", any);
    }
    CHECK(wrong == 0);
}

const BvhBuildSettings kSettings[] = {{},
                                      {.bins = 2, .max_leaf = 1},
                                      {.bins = 64, .max_leaf = 16, .leaf_cost = 0.1f},
                                      {.bins = 7, .max_leaf = 3, .max_depth = 13}};

} // namespace

TEST_CASE("a tree of any build setting gives the hits of testing every triangle, bit for bit") {
    struct Case {
        const char* name;
        std::vector<BvhTriangle> triangles;
        Vec3 centre;
    };
    const Case cases[] = {{"lattice of doubled quads", grid_with_doubles(), {}},
                          {"soup", soup(3000, 0), {}},
                          {"soup 100 km away", soup(1500, 1e5f), {1e5f, 0, -1e5f}},
                          {"torus", triangles_of(make_torus(40, 24), 5), {}},
                          {"one triangle", soup(1, 0), {}},
                          {"nothing", {}, {}}};
    for (const Case& c : cases) {
        CAPTURE(c.name);
        const std::vector<Ray> rays = nasty_rays(2000, c.centre, c.triangles, 17);
        std::vector<Hit> all(rays.size()), some(rays.size());
        uint64_t hits = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            trace_by_brute_force(c.triangles, rays[i], kNoHit, AcceptAll{}, all[i]);
            trace_by_brute_force(c.triangles, rays[i], kNoHit, AcceptSome{}, some[i]);
            hits += all[i].instance != kNoHit ? 1 : 0;
        }
        if (c.triangles.size() > 1) CHECK(hits > rays.size() / 20);
        for (const BvhBuildSettings& settings : kSettings) {
            CAPTURE(settings.bins);
            const Bvh bvh = build_bvh(c.triangles, settings);
            const std::vector<WideBvhNode> wide_nodes = make_wide_nodes(bvh);
            for (const bool wide : {false, true}) {
                CAPTURE(wide);
                SceneBvhView scene;
                scene.baked = view_of(bvh);
                if (wide) scene.baked.wide = wide_nodes.data();
                check_rays(scene, rays, all, AcceptAll{});
                check_rays(scene, rays, some, AcceptSome{});
            }
        }
    }
}

TEST_CASE("instances give the hits of testing every triangle of every instance, bit for bit") {
    const std::vector<BvhTriangle> meshes[] = {triangles_of(make_torus(16, 12)), soup(300, 0), soup(200, 1000.0f),
                                               triangles_of(make_sphere(0, {}, 1))};
    const std::vector<BvhTriangle> baked = triangles_of(make_torus(20, 16), 7);
    std::vector<Bvh> trees;
    std::vector<BvhView> views;
    for (const auto& mesh : meshes) trees.push_back(build_bvh(mesh));
    for (const Bvh& tree : trees) views.push_back(view_of(tree));
    const std::vector<WideBvhNode> wide_torus = make_wide_nodes(trees[0]), wide_soup = make_wide_nodes(trees[2]);
    views[0].wide = wide_torus.data();
    views[2].wide = wide_soup.data();

    Random random(5);
    std::vector<PlacedBvh> placed;
    for (uint32_t i = 0; i < 60; ++i) {
        const uint32_t mesh = i % 4;
        const Vec3 axis = random.direction();
        const float w = random.within(-1, 1), s = sqrt(1 - w * w);
        Transform place = make_rotation(s * axis.x, s * axis.y, s * axis.z, w);
        if (i % 5 == 0) place = Transform{}; // identity: exact, and ties with its neighbours
        if (i % 3 == 0) place = compose(place, make_scale({0.5f, random.within(0.01f, 4), -1}));
        if (i % 7 == 0) place = compose(place, make_scale({1e4f, 1e4f, 1e4f}));
        place = compose(make_translation(i % 5 == 0 ? Vec3{} : random.point(-3, 3)), place);
        if (mesh == 2) place = compose(place, make_translation({-1000, 0, 1000})); // far from its own origin
        placed.push_back({place, trees[mesh].bounds, mesh, i * 3 + 1});
    }
    const TopLevelBvh top = build_top_level_bvh(placed);
    const Bvh baked_tree = build_bvh(baked);
    for (const bool with_baked : {false, true}) {
        SceneBvhView scene = {{},        top.nodes.data(), top.instances.data(), views.data(), top.root,
                              top.reach, top.growth};
        if (with_baked) scene.baked = view_of(baked_tree);
        const std::vector<Ray> rays = nasty_rays(3000, {}, baked, 23);
        std::vector<Hit> expected(rays.size());
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (with_baked) trace_by_brute_force(baked, rays[i], kNoHit, AcceptSome{}, expected[i]);
            for (const PlacedBvh& p : placed) {
                const Ray local = transform_ray(inverse(p.world_from_local), rays[i]);
                trace_by_brute_force(meshes[p.mesh_bvh], local, p.instance, AcceptSome{}, expected[i]);
            }
        }
        check_rays(scene, rays, expected, AcceptSome{});
    }
}

TEST_CASE("rays at the very edge of instances whose boxes leave no slack are not lost at the top level") {
    const std::vector<BvhTriangle> quad = {{{0, 0, 0}, 0, {1, 0, 0}, 0, {1, 1, 0}, 0},
                                           {{0, 0, 0}, 1, {1, 1, 0}, 0, {0, 1, 0}, 0}};
    const Bvh bvh = build_bvh(quad);
    const BvhView mesh = view_of(bvh);
    Random random(31);
    std::vector<PlacedBvh> placed;
    for (uint32_t i = 0; i < 30; ++i) { // no rotation: the quad's edges are the world box's
        const Transform place = compose(make_translation(random.point(-1000, 1000)), make_scale(random.point(0.3f, 3)));
        placed.push_back({place, bvh.bounds, 0, i});
    }
    const TopLevelBvh top = build_top_level_bvh(placed);
    const SceneBvhView scene = {{}, top.nodes.data(), top.instances.data(), &mesh, top.root, top.reach, top.growth};
    std::vector<Ray> rays(20000);
    std::vector<Hit> expected(rays.size());
    uint64_t hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const PlacedBvh& at = placed[random.below(30)];
        const float along = random.unit(), side = static_cast<float>(random.below(2));
        const Vec3 edge = random.below(2) ? Vec3{along, side, 0} : Vec3{side, along, 0};
        rays[i].origin = random.point(-1000, 1000);
        rays[i].direction = transform_point(at.world_from_local, edge) - rays[i].origin;
        for (const PlacedBvh& p : placed) {
            const Ray local = transform_ray(inverse(p.world_from_local), rays[i]);
            trace_by_brute_force(quad, local, p.instance, AcceptAll{}, expected[i]);
        }
        hits += expected[i].instance != kNoHit ? 1 : 0;
    }
    CHECK(hits > 5000);
    check_rays(scene, rays, expected, AcceptAll{});
}
