// Skins and morph targets with vertices computed on the device: pictures have the bits of those with vertices from the
// host, for every tree layout. Uploads of a time step and positions in the previous frame are tested, too.

#include "device_scene/deforming_meshes.h"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "base/error.h"
#include "denoise/reproject.h"
#include "device_scene/scene_on_device.h"
#include "image/picture_hash.h"
#include "scene/validate/validate.h"
#include "session/moving_scene.h"
#include "session/session.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"
#include "tracer/deforming_tree.h"
#include "tracer/traversal_kernels.h"

using namespace pertev;

namespace {

constexpr uint32_t kSkinned = 0, kMorphed = 1;

/// Spheres under a sky: the first bends about a joint, the second is stretched by two morph targets while its node
/// moves aside, and the third is still.
Scene make_bending_scene() {
    Scene scene = test::make_furnace_scene(0.6f);
    scene.nodes.resize(4);
    Mesh ball = scene.meshes[0];
    ball.tangents.assign(ball.positions.size(), {1, 0, 0, 1});
    scene.meshes.assign(2, ball);
    scene.meshes.push_back(ball);
    scene.instances.clear();
    for (uint32_t i = 0; i < 3; ++i) {
        Instance& instance = scene.instances.emplace_back();
        instance.name = "ball";
        instance.mesh = i;
        instance.node = i < 2 ? i : kNoNode;
        instance.node_from_local = make_translation({2.2f * static_cast<float>(i), 0, 0});
        instance.world_from_local = i == kSkinned ? Transform() : instance.node_from_local;
    }
    scene.instances[kSkinned].node_from_local = Transform();
    for (const uint32_t mesh : {kSkinned, kMorphed}) {
        scene.shapes.push_back({.mesh = mesh,
                                .node = mesh,
                                .positions = ball.positions,
                                .normals = ball.normals,
                                .tangents = ball.tangents});
    }
    scene.skins.push_back({.joints = {2, 3}, .joint_from_mesh = {}});
    scene.nodes[0].skin = 0;
    MeshShape& skinned = scene.shapes[0];
    skinned.skin = 0;
    skinned.joints_per_vertex = 2;
    for (const Vec3 p : ball.positions) {
        const float share = clamp(0.5f + p.y, 0.0f, 1.0f);
        skinned.joints.insert(skinned.joints.end(), {0, 1});
        skinned.weights.insert(skinned.weights.end(), {1 - share, share});
    }
    scene.nodes[1].morph_weights = {0, 0};
    for (const float side : {1.0f, -1.0f}) {
        MorphTarget& target = scene.shapes[1].targets.emplace_back();
        for (const Vec3 p : ball.positions) target.positions.push_back({0, side * p.y * p.y, 0.4f * p.x});
        if (side > 0) target.normals.assign(ball.positions.size(), {0.2f, 0, 0.1f});
    }
    std::vector<AnimationChannel>& channels = scene.animations.emplace_back().channels;
    const auto add = [&](uint32_t target, AnimatedPart part, std::vector<float> values) {
        channels.push_back({target, part, Interpolation::Linear, {0, 2}, std::move(values)});
    };
    add(3, AnimatedPart::Rotation, {0, 0, 0, 1, 0, 0, 0.6f, 0.8f});
    add(1, AnimatedPart::Weights, {0, 0, 0.5f, 0.25f});
    add(1, AnimatedPart::Translation, {0, 0, 0, 0, 0.3f, 0});
    Messages messages;
    validate(scene, "bending", messages);
    return scene;
}

Camera camera_of_bending() {
    Camera camera;
    camera.world_from_camera = look_at({2.2f, 1, 8}, {2.2f, 0, 0}, {0, 1, 0});
    return camera;
}

/// Returns the hash of a picture whose vertices are computed on the host.
Hash128 hash_by_host(const Scene& rest, double time_s, const RenderSettings& settings) {
    Messages messages;
    PosedScene posed(rest);
    PrepareOptions options;
    options.centre = world_centre(rest);
    posed.set_time(time_s);
    Queue cpu = Queue::make_cpu();
    return test::render_hash(
        render_picture(cpu, prepare_scene(posed.scene(), options, messages), camera_of_bending(), settings));
}

std::size_t left_to_device(const PreparedScene& prepared) {
    return static_cast<std::size_t>(
        std::ranges::count_if(prepared.poses, [](const MeshPose& pose) { return !pose.is_on_host; }));
}

constexpr double kTimes[] = {0.5, 2, 1.25, 0};

} // namespace

TEST_CASE("vertices deformed on the device give the picture of vertices deformed on the host, with every layout") {
    const Scene rest = make_bending_scene();
    RenderSettings settings = test::layered_settings();
    std::vector<Hash128> expected;
    for (const double time_s : kTimes) expected.push_back(hash_by_host(rest, time_s, settings));
    CHECK(expected[0] != expected[1]);
    Queue queue = test::requested_queue();
    for (const TraversalKind traversal : kValuesOf<TraversalKind>) {
        Combination c = {.structure = StructureKind::SpatialSplits, .traversal = traversal};
        if (traversal == TraversalKind::Kd) c.structure = StructureKind::KdSah;
        if (traversal == TraversalKind::Octree) c.structure = StructureKind::Octree;
        if (why_no_tracer(c, queue.is_cuda())) continue;
        CAPTURE(name_of(c));
        settings.tracers = same_for_all(c);
        Messages messages;
        MovingScene moving(rest, std::nullopt, {}, messages);
        Session session(queue, moving.prepared(), camera_of_bending(), settings);
        for (std::size_t i = 0; i < std::size(kTimes); ++i) {
            session.update_scene(moving.prepared(), moving.set_time(kTimes[i], messages));
            CHECK(left_to_device(moving.prepared()) == 2);
            session.render(settings.samples);
            CHECK(test::render_hash(session.result()) == expected[i]);
        }
        settings.tracers.reset(); // another tracer traces the moved meshes
        session.set_settings(settings);
        session.cut();
        session.render(settings.samples);
        CHECK(test::render_hash(session.result()) == expected.back());
    }
}

TEST_CASE("a step in time uploads joints and weights, not vertices, and allocates no memory") {
    Messages messages;
    Queue queue = test::requested_queue();
    RenderSettings settings = test::layered_settings();
    for (const TraversalKind traversal : {TraversalKind::Wide8Simd, TraversalKind::Compressed}) {
        const Combination c = {.structure = StructureKind::Binned, .traversal = traversal};
        if (why_no_tracer(c, queue.is_cuda())) continue;
        CAPTURE(name_of(c));
        settings.tracers = same_for_all(c);
        MovingScene moving(make_bending_scene(), 0.25, {}, messages);
        Session session(queue, moving.prepared(), camera_of_bending(), settings);
        session.render(1);
        session.render_frame(0, {});
        session.update_scene(moving.prepared(), moving.set_time(0.5, messages));
        session.render_frame(1, {});
        const uint64_t uploaded = queue.uploaded_bytes(), allocations = queue.allocation_count();
        session.update_scene(moving.prepared(), moving.set_time(0.75, messages));
        const uint64_t of_step = queue.uploaded_bytes() - uploaded;
        CHECK(of_step < 8192); // includes the TLAS, the instances, the lights and the view of the scene
        CHECK(of_step < moving.scene().meshes[0].positions.size() * sizeof(Vec3));
        session.render_frame(2, {});
        CHECK(queue.allocation_count() == allocations);
    }
}

TEST_CASE("memory of deforming meshes equals its prediction") {
    Messages messages;
    Queue queue = test::requested_queue();
    const MovingScene moving(make_bending_scene(), 0.25, {}, messages);
    const SceneOnDevice scene(queue, moving.prepared());
    CHECK(queue.allocated_bytes() == predicted_bytes(moving.prepared(), queue.is_cuda()));
    if (queue.is_cuda()) return; // a GPU's sorting memory is not counted
    const std::vector<DeformedMesh> deformed = scene.deformed(moving.prepared());
    REQUIRE(deformed.size() == 2);
    const std::size_t before = queue.allocated_bytes();
    DeformingCompressed tree(queue, deformed[0].triangles);
    tree.start(deformed[0]);
    tree.finish();
    Queue dry = Queue::make_dry_run(false);
    const DeformingCompressed predicted(dry, deformed[0].triangles);
    CHECK(queue.allocated_bytes() - before == dry.allocated_bytes());
}

namespace {

template <class Tree>
void check_rebuilds(Queue& queue) {
    const test::TriangleMesh mesh = test::make_torus(60, 30);
    std::vector<Vec3> positions = mesh.positions;
    const Buffer<uint32_t> indices(queue, std::span(mesh.indices), "indices");
    Buffer<Vec3> there(queue, positions.size(), "positions");
    const DeformedMesh deformed = {
        .triangles = mesh.triangle_count(), .positions = there.data(), .indices = indices.data()};
    Tree tree(queue, mesh.triangle_count());
    const auto fit = [&] {
        there.upload(positions);
        tree.start(deformed);
        Bounds3 bounds, all;
        bounds = tree.finish();
        for (const uint32_t i : mesh.indices) all.extend(positions[i]);
        CHECK(bounds == all);
        CHECK(tree.view().bounds_max_abs == all.max_abs());
    };
    fit();
    CHECK(tree.builds() == 1);
    for (Vec3& p : positions) p = {p.x + 0.1f * p.y, p.y, 1.2f * p.z};
    fit();
    CHECK(tree.builds() == 1);
    test::Random random(3);
    for (std::size_t i = positions.size(); i-- > 1;) { // neighbours are separated
        std::swap(positions[i], positions[static_cast<std::size_t>(random.unit() * static_cast<float>(i))]);
    }
    fit();
    CHECK(tree.builds() == 2);
    fit();
    CHECK(tree.builds() == 2); // the tree is optimal
}

} // namespace

TEST_CASE("only trees whose refits raised their cost are rebuilt") {
    Queue cpu = Queue::make_cpu();
    check_rebuilds<DeformingWide>(cpu);
    check_rebuilds<DeformingCompressed>(cpu);
    if (!test::cuda_requested()) return;
    Queue gpu = test::make_cuda_queue();
    check_rebuilds<DeformingCompressed>(gpu);
}

TEST_CASE("reprojection follows skins and morph targets") {
    Messages messages;
    Queue cpu = Queue::make_cpu();
    const Scene rest = make_bending_scene();
    MovingScene moving(rest, 0.5, {}, messages);
    SceneOnDevice scene(cpu, moving.prepared());
    scene.keep_positions();
    const std::vector<InstanceView> instances_before(scene.view().instances,
                                                     scene.view().instances + rest.instances.size());
    const uint32_t parts = moving.set_time(0.75, messages);
    scene.update(cpu, moving.prepared(), parts);
    PosedScene at_0(rest), at_1(rest); // computed on the host
    at_0.set_time(0.5), at_1.set_time(0.75);
    const CameraView view = make_camera_view(camera_of_bending(), 640, 360);
    const FrameCameras cameras = {view, view, 640, 360};
    const Vec3 centre = moving.prepared().centre;
    float most = 0;
    for (const uint32_t instance : {kSkinned, kMorphed, 2u}) {
        const auto world = [&](const PosedScene& posed, uint32_t primitive) { // its first vertex
            const Mesh& mesh = posed.scene().meshes[instance];
            return transform_point(moved_to(posed.scene().instances[instance].world_from_local, centre),
                                   mesh.positions[mesh.indices[3 * primitive]]);
        };
        for (uint32_t primitive = 0; primitive < rest.meshes[instance].triangle_count(); primitive += 7) {
            const ProjectedPoint now = project_point(view, world(at_1, primitive)),
                                 then = project_point(view, world(at_0, primitive));
            const Reprojection found =
                reproject_surface(cameras, scene.view(), {instances_before.data(), scene.meshes_before()}, now.pixel,
                                  {float_of(instance), float_of(primitive), 0, 0});
            CHECK(found.pixel.x == then.pixel.x);
            CHECK(found.pixel.y == then.pixel.y);
            CHECK(found.depth == then.depth);
            most = max(most, std::abs(now.pixel.x - then.pixel.x));
        }
    }
    CHECK(most > 2); // pixels
}

namespace {

Hash128 hash_of_frames(Queue& queue, const RenderSettings& settings) {
    Messages messages;
    MovingScene moving(make_bending_scene(), 0, {}, messages);
    Session session(queue, moving.prepared(), camera_of_bending(), settings);
    for (uint32_t k = 0; k < 8; ++k) {
        if (const uint32_t parts = moving.set_time(k / 8.0, messages)) session.update_scene(moving.prepared(), parts);
        session.render_frame(k, {});
    }
    return picture_hash(session.frame().picture());
}

} // namespace

TEST_CASE("frames of deforming meshes have the same bytes on every device, in every schedule and with every tree") {
    RenderSettings settings;
    settings.width = 96, settings.height = 54;
    Queue cpu = Queue::make_cpu();
    const Hash128 expected = hash_of_frames(cpu, settings);
    RenderSettings wavefront = settings;
    wavefront.body = PathBody::Wavefront;
    CHECK(hash_of_frames(cpu, wavefront) == expected);
    wavefront.tracers = same_for_all({.structure = StructureKind::Hploc, .traversal = TraversalKind::Compressed});
    CHECK(hash_of_frames(cpu, wavefront) == expected);
    if (test::cuda_requested()) {
        Queue cuda = test::make_cuda_queue();
        CHECK(hash_of_frames(cuda, settings) == expected);
    }
}

namespace {

/// Returns the motion vectors of frame `k` at 8 frames per second, after the frames from `first` on.
Image motion_of_frame(Queue& queue, const RenderSettings& settings, int first, int k) {
    Messages messages;
    MovingScene moving(make_bending_scene(), 0.1, {}, messages);
    Session session(queue, moving.prepared(), camera_of_bending(), settings);
    const auto seek = [&](double time_s) {
        if (const uint32_t parts = moving.set_time(time_s, messages)) session.update_scene(moving.prepared(), parts);
    };
    for (int frame = first; frame <= k; ++frame) {
        seek((frame - 1) / 8.0);
        session.store_previous();
        seek(frame / 8.0);
    }
    return session.motion();
}

} // namespace

TEST_CASE("motion vectors follow skins and morph targets and depend only on the frame") {
    RenderSettings settings;
    settings.width = 96, settings.height = 54;
    Queue cpu = Queue::make_cpu();
    const Image motion = motion_of_frame(cpu, settings, 5, 5);
    CHECK(motion_of_frame(cpu, settings, 1, 5).pixels == motion.pixels);
    settings.tracers = same_for_all({.structure = StructureKind::Binned, .traversal = TraversalKind::Compressed});
    CHECK(motion_of_frame(cpu, settings, 4, 5).pixels == motion.pixels);
    const auto moving_pixels = [&](uint32_t begin, uint32_t end) { // columns
        int moving = 0;
        for (uint32_t y = 0; y < motion.height; ++y) {
            for (uint32_t x = begin; x < end; ++x) {
                const float* m = &motion.pixels[2 * (std::size_t(y) * motion.width + x)];
                moving += std::abs(m[0]) + std::abs(m[1]) > 0.05f ? 1 : 0;
            }
        }
        return moving;
    };
    CHECK(moving_pixels(0, 40) > 20); // the skinned sphere
    CHECK(moving_pixels(40, 56) > 20);
    CHECK(moving_pixels(62, 96) == 0); // the third sphere is still
    if (!test::cuda_requested()) return;
    Queue cuda = test::make_cuda_queue();
    settings.tracers.reset();
    CHECK(motion_of_frame(cuda, settings, 5, 5).pixels == motion.pixels);
}

TEST_CASE("vertices of emissive, mirrored or baked meshes are computed on the host only at those times") {
    const auto left_at = [](const Scene& rest, double time_s, uint32_t shape) {
        Messages messages;
        const MovingScene moving(rest, time_s, {}, messages);
        return !moving.prepared().poses[shape].is_on_host;
    };
    Scene lit = make_bending_scene();
    lit.materials.push_back({{.emission = {1, 1, 1}}, "lamp"});
    lit.instances[kSkinned].material = 1;
    CHECK(!left_at(lit, 1, 0));
    CHECK(left_at(lit, 1, 1));
    Scene mirrored = make_bending_scene();
    mirrored.animations[0].channels.push_back(
        {2, AnimatedPart::Scale, Interpolation::Step, {0, 1, 2}, {1, 1, 1, -1, 1, 1, 1, 1, 1}});
    Scene flat = make_bending_scene();
    flat.animations[0].channels.push_back(
        {1, AnimatedPart::Scale, Interpolation::Step, {0, 1, 2}, {1, 1, 1, 1, 1e-5f, 1, 1, 1, 1}});
    const RenderSettings settings = test::layered_settings();
    for (const auto& [rest, shape] : {std::pair(mirrored, 0u), std::pair(flat, 1u)}) {
        CAPTURE(shape);
        CHECK(left_at(rest, 0.5, shape));
        CHECK(!left_at(rest, 1.5, shape));
        Messages messages;
        Queue queue = test::requested_queue();
        MovingScene moving(rest, 0.5, {}, messages);
        Session session(queue, moving.prepared(), camera_of_bending(), settings);
        for (const double time_s : {1.5, 2.0, 1.0, 0.75}) {
            CAPTURE(time_s);
            session.update_scene(moving.prepared(), moving.set_time(time_s, messages));
            session.render(settings.samples);
            CHECK(test::render_hash(session.result()) == hash_by_host(rest, time_s, settings));
        }
    }
}

TEST_CASE("vertices that move beyond the scene's limit are refused, and the next scene is complete") {
    Scene rest = make_bending_scene();
    rest.animations[0].channels.push_back(
        {3, AnimatedPart::Translation, Interpolation::Step, {0, 1, 2}, {0, 0, 0, 1e13f, 0, 0, 0, 0, 0}});
    Messages messages;
    Queue queue = test::requested_queue();
    const RenderSettings settings = test::layered_settings();
    MovingScene moving(rest, 0.5, {}, messages);
    Session session(queue, moving.prepared(), camera_of_bending(), settings);
    const uint32_t parts = moving.set_time(1.5, messages);
    CHECK_THROWS_AS(session.update_scene(moving.prepared(), parts), Error);
    moving.set_time(2, messages);
    session.set_scene(moving.prepared());
    session.render(settings.samples);
    CHECK(test::render_hash(session.result()) == hash_by_host(rest, 2, settings));
}
