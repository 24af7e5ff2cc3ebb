// The scene's nodes: their order, possible motion, and baking.

#include <algorithm>

#include <doctest/doctest.h>

#include "device_scene/place_meshes.h"
#include "scene/scene.h"

using namespace pertev;

namespace {

/// Instances of one mesh each, on nodes 0 to 3. Node 1 is a child of node 3, node 0 of node 1, and node 2 has no
/// parent.
Scene make_scene() {
    Scene scene;
    scene.materials.resize(1);
    scene.nodes.resize(4);
    scene.nodes[0].parent = 1, scene.nodes[1].parent = 3;
    for (uint32_t i = 0; i < 4; ++i) {
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        mesh.indices = {0, 1, 2};
        scene.meshes.push_back(mesh);
        scene.instances.push_back({.name = "", .mesh = i, .material = 0, .world_from_local = {}, .node = i});
    }
    return scene;
}

void animate(Scene& scene, uint32_t node, AnimatedPart part) {
    AnimationChannel channel;
    channel.target = node;
    channel.part = part;
    scene.animations.push_back({.name = "", .origin = "", .channels = {channel}});
}

using Moves = std::vector<bool>;

} // namespace

TEST_CASE("parents_first puts each node after its parent, whatever their indices, and leaves out cycles") {
    Scene scene = make_scene();
    CHECK(parents_first(scene.nodes) == std::vector<uint32_t>{3, 1, 0, 2});
    scene.nodes.resize(6);
    scene.nodes[3].parent = 0; // 0, 1 and 3 form a cycle
    scene.nodes[4].parent = 1; // lie below the cycle
    scene.nodes[5].parent = 2;
    CHECK(parents_first(scene.nodes) == std::vector<uint32_t>{2, 5});
    std::vector<Node> chain(1'000'000); // the chain is too deep for recursion
    for (uint32_t i = 0; i + 1 < chain.size(); ++i) chain[i].parent = i + 1;
    const std::vector<uint32_t> order = parents_first(chain);
    CHECK(order.size() == chain.size());
    CHECK(std::is_sorted(order.rbegin(), order.rend()));
}

TEST_CASE("an instance may move if an animation changes its node or an ancestor") {
    Scene scene = make_scene();
    CHECK(may_move(scene) == Moves{false, false, false, false});
    SUBCASE("an inner node moves its descendants") {
        animate(scene, 1, AnimatedPart::Rotation);
        CHECK(may_move(scene) == Moves{true, true, false, false});
    }
    SUBCASE("morph weights deform only their own node's mesh") {
        animate(scene, 3, AnimatedPart::Weights);
        CHECK(may_move(scene) == Moves{false, false, false, true});
    }
    SUBCASE("a skin moves with its joints, not with its node") {
        scene.skins.push_back({.joints = {2, 0}});
        scene.nodes[3].skin = 0;
        animate(scene, 3, AnimatedPart::Translation);
        CHECK(may_move(scene) == Moves{true, true, false, true}); // joint 0 is below node 3
        scene.skins[0].joints = {2};
        CHECK(may_move(scene) == Moves{true, true, false, false});
        scene.animations.clear();
        animate(scene, 2, AnimatedPart::Scale);
        CHECK(may_move(scene) == Moves{false, false, true, true});
    }
    SUBCASE("objects without a node do not move") {
        scene.instances[0].node = kNoNode;
        animate(scene, 0, AnimatedPart::Scale);
        CHECK(may_move(scene) == Moves{false, false, false, false});
    }
}

TEST_CASE("a mesh used once keeps its own BLAS if it may move and is baked otherwise") {
    Scene scene = make_scene();
    animate(scene, 1, AnimatedPart::Translation);
    const MeshPlacement placement = place_meshes(scene);
    CHECK(placement.is_baked == Moves{false, false, true, true});
    CHECK(placement.mesh_tree_count == 2);
    CHECK(placement.copies == 0);

    scene.instances[0].world_from_local = make_scale({1, 1, 1e-5f}); // over the limit of the condition number
    CHECK(place_meshes(scene).is_baked == Moves{true, false, true, true});
}
