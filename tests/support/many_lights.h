#pragma once

// Lists of small emissive triangles, with receivers, for tests of light trees: a corridor, a hall with swarms as in
// scenes/many-lights, a city of windows, a chandelier, and clusters of dust. tools/make_light_scenes.py writes scenes
// like these.

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "math/frame.h"
#include "shading/light_tree/build_light_tree.h"
#include "shading/light_tree/light_tree.h"
#include "tests/support/random.h"

namespace pertev::test {

struct SmallLight {
    Vec3 a, ab, ac;
    float emission;
};

struct ManyLights {
    std::string name;
    std::vector<SmallLight> lights;
    std::vector<LightReceiver> receivers;

    void add(Vec3 a, Vec3 ab, Vec3 ac, float emission) { lights.push_back({a, ab, ac, emission}); }
    void add_small(Vec3 at, Vec3 normal, float size, float emission) {
        const Frame frame = make_frame(normal);
        add(at, size * frame.tangent, size * frame.bitangent, emission);
    }
    void receive(Vec3 point, Vec3 normal) { receivers.push_back({point, normal}); }

    std::vector<TreeLight> tree_lights() const {
        std::vector<TreeLight> list;
        for (const SmallLight& light : lights) {
            TreeLight& of = list.emplace_back();
            for (const Vec3 edge : {Vec3{}, light.ab, light.ac}) of.bounds.extend(light.a + edge);
            const Vec3 normal = cross(light.ab, light.ac);
            of.axis = normalize(normal);
            of.emission_angle = 0.5f * kPi;
            of.power = static_cast<double>(light.emission * length(normal));
        }
        return list;
    }
};

/// Lights, some of them copies that share a subtree, and the same lights one by one.
struct SharedLights {
    TreeLights tree;
    std::vector<TreeLight> lights;

    void place(uint32_t subtree, const Transform& world_from_local) {
        SharedTreeInstance instance;
        instance.subtree = subtree;
        instance.first_light = static_cast<uint32_t>(lights.size());
        instance.world_from_local = world_from_local;
        const double larger = static_cast<double>(length_squared(column(world_from_local, 0)));
        for (const TreeLight& local : tree.shared[subtree]) {
            TreeLight& light = lights.emplace_back(local);
            light.bounds = {};
            for (uint32_t corner = 0; corner < 8; ++corner) {
                const Vec3 at = {(corner & 1) != 0 ? local.bounds.hi.x : local.bounds.lo.x,
                                 (corner & 2) != 0 ? local.bounds.hi.y : local.bounds.lo.y,
                                 (corner & 4) != 0 ? local.bounds.hi.z : local.bounds.lo.z};
                light.bounds.extend(transform_point(world_from_local, at));
            }
            light.axis = normalize(transform_vector(world_from_local, local.axis));
            light.power *= larger;
            if (!(light.power > 0)) continue;
            instance.bounds.extend(light.bounds);
            instance.power += light.power;
        }
        tree.lights.resize(lights.size());
        tree.instances.push_back(instance);
    }
};

/// A turn about a unit axis by an angle in radians, a uniform scaling, negative for a reflection, and a shift.
inline Transform make_similarity(Vec3 axis, float angle, float scale, Vec3 shift) {
    const float s = std::sin(0.5f * angle);
    Transform placed = make_rotation(s * axis.x, s * axis.y, s * axis.z, std::cos(0.5f * angle));
    for (Vec3* const row : {&placed.row0, &placed.row1, &placed.row2}) *row = scale * *row;
    placed.translation = shift;
    return placed;
}

/// Light of its middle at a receiver without occlusion, W/m2 up to a factor.
inline double light_at(const SmallLight& light, const LightReceiver& to) {
    const Vec3 way = light.a + (light.ab + light.ac) / 3.0f - to.point;
    const double arrives = static_cast<double>(dot(way, to.normal));
    const double leaves = -static_cast<double>(dot(way, cross(light.ab, light.ac)));
    const double square = static_cast<double>(length_squared(way));
    return arrives > 0 && leaves > 0 ? static_cast<double>(light.emission) * arrives * leaves / (square * square) : 0.0;
}

/// Calls `visit(light, probability)` for each light that the tree gives a probability, and returns the probability that
/// a draw ends without a light.
inline double visit_tree(const LightTreeView& tree, const LightReceiver& to,
                         const std::function<void(uint32_t, double)>& visit, uint32_t at = kLightTreeRoot,
                         double probability = 1) {
    const LightTreeNode& node = tree.nodes[at];
    if (node.is_instance()) {
        const LightTreeInstance& instance = tree.instances[node.number()];
        const auto visit_shared = [&](uint32_t triangle, double p) { visit(instance.first_light + triangle, p); };
        return visit_tree(tree, local_receiver(instance, to), visit_shared, instance.root, probability);
    }
    if (node.is_leaf()) {
        visit(node.number(), probability);
        return 0;
    }
    const float p =
        left_probability(importance_of(tree.nodes[node.next], to), importance_of(tree.nodes[node.next + 1], to));
    if (p < 0) return probability;
    double none = 0;
    if (p > 0) none += visit_tree(tree, to, visit, node.next, probability * static_cast<double>(p));
    if (p < 1) none += visit_tree(tree, to, visit, node.next + 1, probability * (1 - static_cast<double>(p)));
    return none;
}

inline ManyLights make_corridor(uint32_t count) {
    ManyLights scene{"corridor", {}, {}};
    Random random(5000);
    for (uint32_t i = 0; i < count; ++i) {
        const float x = random.within(-1.44f, 1.44f), y = 3 - random.within(0.03f, 0.5f);
        const Vec3 at = {x, y, random.within(-29.7f, 29.7f)};
        const float tilt = random.within(-0.7f, 0.7f);
        scene.add_small(at, normalize(Vec3{tilt, -1, random.within(-0.7f, 0.7f)}), 0.02f, 50);
    }
    for (int i = 0; i < 20; ++i) {
        const float x = random.within(-1.5f, 1.5f);
        scene.receive({x, 0, random.within(-29, 29)}, {0, 1, 0});
    }
    return scene;
}

inline ManyLights make_hall() {
    ManyLights scene{"hall", {}, {}};
    Random random(7);
    std::vector<SmallLight> swarm;
    while (swarm.size() < 100) {
        const Vec3 at = random.point(-1, 1);
        if (length_squared(at) > 1) continue;
        const Vec3 a = 0.4f * at + random.point(-0.015f, 0.015f), b = 0.4f * at + random.point(-0.015f, 0.015f);
        swarm.push_back({a, b - a, 0.4f * at + random.point(-0.015f, 0.015f) - a, 1});
    }
    for (int i = 0; i < 100; ++i) {
        const float x = random.within(-7.3f, 7.3f), y = random.within(0.6f, 5.4f);
        const Vec3 at = {x, y, random.within(-11.3f, 7)};
        const Frame turned = make_frame(random.direction());
        const auto turn = [&](Vec3 v) { return turned.to_world(v); };
        for (const SmallLight& light : swarm) {
            scene.add(at + turn(light.a), turn(light.ab), turn(light.ac), 800);
        }
    }
    for (int i = 0; i < 40; ++i) {
        const float x = random.within(-8, 8);
        scene.receive({x, 0, random.within(-12, 12)}, {0, 1, 0});
    }
    return scene;
}

inline ManyLights make_city(int blocks) {
    ManyLights scene{"city", {}, {}};
    Random random(11);
    for (int block = 0; block < blocks * blocks; ++block) {
        const Vec3 at = {30 * static_cast<float>(block % blocks), 0, 30 * static_cast<float>(block / blocks)};
        const int floors = 3 + static_cast<int>(random.below(17));
        for (int window = 0; window < 16 * floors; ++window) {
            if (random.unit() < 0.6f) continue;
            const float from = 5 * static_cast<float>(window / 4 % 4) + 1.25f;
            const float y = 3 * static_cast<float>(window / 16) + 1, emission = random.within(1, 12);
            const Vec3 corners[4] = {{from, y, 20}, {20, y, 20 - from}, {20 - from, y, 0}, {0, y, from}};
            const Vec3 along[4] = {{2.5f, 0, 0}, {0, 0, -2.5f}, {-2.5f, 0, 0}, {0, 0, 2.5f}};
            const Vec3 corner = at + corners[window % 4], across = along[window % 4], up = {0, 1.4f, 0};
            scene.add(corner, across, up, emission);
            scene.add(corner + across + up, -across, -up, emission);
        }
    }
    const float size = 30 * static_cast<float>(blocks);
    for (int i = 0; i < 20; ++i) {
        const float street = 30 * static_cast<float>(random.below(static_cast<uint32_t>(blocks - 1))) + 20;
        const float x = street + random.within(0, 10);
        scene.receive({x, 0, random.within(0, size)}, {0, 1, 0});
    }
    return scene;
}

inline ManyLights make_chandelier(uint32_t beads) {
    ManyLights scene{"chandelier", {}, {}};
    Random random(13);
    for (uint32_t i = 0; i < beads; ++i) {
        const float ring = static_cast<float>(i % 5), angle = kTwoPi * random.unit(), radius = 0.25f + 0.12f * ring;
        const Vec3 at = {radius * std::cos(angle), 2.6f - 0.15f * ring, radius * std::sin(angle)};
        for (int face = 0; face < 8; ++face) {
            const Vec3 x = {(face & 1) != 0 ? 0.01f : -0.01f, 0, 0}, y = {0, (face & 2) != 0 ? 0.01f : -0.01f, 0};
            const Vec3 z = {0, 0, (face & 4) != 0 ? 0.01f : -0.01f};
            const bool is_turned = dot(cross(y - x, z - x), x) < 0;
            scene.add(at + x, is_turned ? z - x : y - x, is_turned ? y - x : z - x, 100);
        }
    }
    for (int i = 0; i < 20; ++i) {
        const float x = random.within(-3, 3), z = random.within(-3, 3);
        scene.receive({x, 0, z}, {0, 1, 0});
        scene.receive({-3, random.within(0, 3), z}, {1, 0, 0});
    }
    return scene;
}

inline ManyLights make_dust(uint32_t count) {
    ManyLights scene{"dust", {}, {}};
    Random random(17);
    Vec3 middle;
    for (uint32_t i = 0; i < count; ++i) {
        if (i % 64 == 0) {
            const float x = random.within(-50, 50), y = random.within(1, 20);
            middle = {x, y, random.within(-50, 50)};
        }
        const Vec3 at = middle + random.point(-0.5f, 0.5f), normal = random.direction();
        scene.add_small(at, normal, 0.02f, random.within(0.1f, 100));
    }
    for (int i = 0; i < 20; ++i) {
        const float x = random.within(-50, 50);
        scene.receive({x, 0, random.within(-50, 50)}, {0, 1, 0});
    }
    return scene;
}

} // namespace pertev::test
