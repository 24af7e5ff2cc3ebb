// The sets of rays that tracers are compared on: each follows its definition, agrees with published numbers, and is
// the same for any number of threads.

#include "lab/ray_sets.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "base/parallel_for.h"
#include "lab/measure_rays.h"
#include "lab/record_scenes.h"
#include "math/frame.h"
#include "tests/support/make_tracer.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// A scene with everything that tracing needs.
struct Traced {
    Scene scene;
    Messages messages;
    PreparedScene prepared;
    Queue queue;
    Tracer tracer;

    explicit Traced(Scene given, Queue of_device = Queue::make_cpu())
        : scene(std::move(given)),
          prepared(prepare_scene(scene, {.bvh = {}, .bvh_cache = {}, .keep_coordinates = true}, messages)),
          queue(std::move(of_device)), tracer(make_tracer(queue, prepared)) {}

    RaySetJob job(uint32_t width, uint32_t height) {
        return {scene, scene.cameras.front(), width, height, make_ray_tracer(queue, tracer)};
    }
    std::vector<RayHit> hits(const RaySet& set) {
        std::vector<RayHit> hits(set.rays.size());
        make_ray_tracer(queue, tracer)(set.rays, hits);
        return hits;
    }
};

Scene scene_of_mesh(Mesh mesh, const Camera& camera) {
    Scene scene;
    scene.meshes.push_back(std::move(mesh));
    scene.materials.push_back({});
    scene.instances.push_back({});
    scene.cameras.push_back(camera);
    return scene;
}

Camera looking(Vec3 eye, Vec3 target, float fov_y) {
    Camera camera;
    camera.world_from_camera = look_at(eye, target, {0, 1, 0});
    camera.fov_y = fov_y;
    return camera;
}

/// A sphere of radius 1 in an open box. About half of the rays that leave the sphere escape.
Scene allocate() {
    const TriangleMesh ball = make_sphere(5, {0, 1, 0}, 1);
    Mesh mesh;
    mesh.positions = ball.positions;
    mesh.indices = ball.indices;
    const Vec3 corners[] = {{-3, 0, 3}, {3, 0, 3}, {-3, 0, -3}, {3, 0, -3},
                            {-3, 4, 3}, {3, 4, 3}, {-3, 4, -3}, {3, 4, -3}};
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), std::begin(corners), std::end(corners));
    for (const uint32_t corner : {0, 1, 3, 0, 3, 2, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 3, 1, 5, 3, 5, 7}) {
        mesh.indices.push_back(first + corner); // floor, back, left, right
    }
    return scene_of_mesh(std::move(mesh), looking({0.3f, 1.5f, 3.6f}, {0, 0.95f, 0}, 0.8f));
}

bool same_bits(const std::vector<RaySet>& a, const std::vector<RaySet>& b) {
    return std::ranges::equal(a, b, [](const RaySet& x, const RaySet& y) {
        return x.name == y.name && x.any_hit == y.any_hit && x.rays.size() == y.rays.size() &&
               std::memcmp(x.rays.data(), y.rays.data(), x.rays.size() * sizeof(Ray)) == 0;
    });
}

/// Draws the same distribution about the normal without the code of the ray sets.
double cosine_to(Vec3 direction, Vec3 normal) { return static_cast<double>(dot(direction, normal)); }

} // namespace

TEST_CASE("the two zeros that the record found are the only ones") {
    // Among 8,294,400 rays with seed 22, only number 4,807,597 draws 0 first. Its direction is the normal.
    uint32_t zeros = 0, at = 0;
    for (uint32_t o = 0; o < kRecordRays; ++o) {
        uint32_t state = secondary_state(o, 22);
        if (draw(state) == 0) ++zeros, at = o;
    }
    CHECK(zeros == 1);
    CHECK(at == 4807597);
    uint32_t state = secondary_state(7647316, 22);
    const float first = draw(state), second = draw(state);
    CHECK(first > 0);
    CHECK(second == 0);
}

TEST_CASE("rays are turned to their nearest axis or slightly off it") {
    RaySet from{"some", false, {}};
    from.rays.push_back({{1, 2, 3}, 0.5f, normalize(Vec3{0.1f, -0.9f, 0.2f}), 7});
    from.rays.push_back({{0, 0, 0}, 0, normalize(Vec3{-0.5f, -0.4f, 0.3f}), 1});
    from.rays.push_back({{0, 0, 0}, 0, normalize(Vec3{0.1f, 0.2f, 0.3f}), 1});
    const std::vector<RaySet> sets = make_axis_ray_sets(from);
    REQUIRE(sets.size() == 2);
    CHECK(sets[0].name == "along_axes");
    CHECK(sets[0].rays[0].direction == Vec3{0, -1, 0});
    CHECK(sets[0].rays[1].direction == Vec3{-1, 0, 0});
    CHECK(sets[0].rays[2].direction == Vec3{0, 0, 1});
    for (std::size_t i = 0; i < 3; ++i) {
        const Ray &along = sets[0].rays[i], &beside = sets[1].rays[i];
        CHECK(along.origin == from.rays[i].origin);
        CHECK(beside.t_max == from.rays[i].t_max);
        CHECK(dot(along.direction, beside.direction) > 0.99999f);
        CHECK(length(along.direction - beside.direction) == doctest::Approx(0.001414).epsilon(0.01));
    }
}

TEST_CASE("the frame of the record matches its count, and smaller ones are whole tiles of the same shape") {
    CHECK(record_frame(kRecordRays).width == 1920);
    CHECK(record_frame(kRecordRays).height == 1080);
    for (const uint32_t count : {1u, 100u, 9216u, 100000u, 1000000u, kRecordRays - 1, 0xffffffffu}) {
        const FrameSize frame = record_frame(count);
        CAPTURE(count);
        CHECK(frame.width % 8 == 0);
        CHECK(frame.height % 4 == 0);
        CHECK(frame.width * 9 == frame.height * 16);
        CHECK((frame.width == 64 || uint64_t(frame.width) * frame.height * 4 <= count));
    }
}

TEST_CASE("primary rays are ordered by frame and tile, and each is inside its pixel") {
    Traced traced(allocate());
    const uint32_t width = 64, height = 36, pixels = width * height;
    const std::vector<Ray> rays = make_record_ray_sets(traced.job(width, height), 4 * pixels)[0].rays;
    REQUIRE(rays.size() == 4 * pixels);
    const Camera& camera = traced.scene.cameras.front();
    const Transform camera_from_world = inverse(camera.world_from_camera);
    const double half_height = std::tan(0.5 * static_cast<double>(camera.fov_y));
    std::set<std::pair<float, float>> places;
    uint64_t wrong = 0;
    for (uint32_t i = 0; i < rays.size(); ++i) {
        const Vec3 d = transform_vector(camera_from_world, rays[i].direction);
        const double px = (static_cast<double>(d.x / -d.z) / (half_height * 16 / 9) + 1) * 0.5 * width;
        const double py = (1 - static_cast<double>(d.y / -d.z) / half_height) * 0.5 * height;
        const uint32_t p = i % pixels, tile = p / 32, within = p % 32;
        const uint32_t x = tile % (width / 8) * 8 + within % 8, y = tile / (width / 8) * 4 + within / 8;
        wrong += std::abs(px - x - 0.5) > 0.5001 || std::abs(py - y - 0.5) > 0.5001 ? 1 : 0;
        wrong += rays[i].t_min != 0 || rays[i].t_max != 1e30f || rays[i].origin != camera.world_from_camera.translation;
        wrong += std::abs(length(rays[i].direction) - 1) > 1e-6f ? 1 : 0;
        places.insert({d.x, d.y});
        // The jitter is two draws in this order from the state of (index in the frame, frame).
        uint32_t state = hash_word(9781u * p + 6271u * (i / pixels) + 1u);
        const float across = draw(state), down = draw(state);
        wrong += std::abs(px - x - static_cast<double>(across)) > 1e-3 ? 1 : 0;
        wrong += std::abs(py - y - static_cast<double>(down)) > 1e-3 ? 1 : 0;
    }
    CHECK(wrong == 0);
    CHECK(places.size() > rays.size() - 8); // the four frames differ
}

TEST_CASE("a count below a whole frame is the start of one") {
    Traced traced(allocate());
    const auto whole = make_record_ray_sets(traced.job(64, 36), 4 * 64 * 36);
    const auto part = make_record_ray_sets(traced.job(64, 36), 1001);
    for (std::size_t k = 0; k < part.size(); ++k) CHECK(part[k].rays.size() == 1001);
    CHECK(std::memcmp(part[0].rays.data(), whole[0].rays.data(), 1001 * sizeof(Ray)) == 0);
}

TEST_CASE("secondary rays start at the previous hits in order, with the directions of their indices") {
    Traced traced(allocate());
    const uint32_t count = 4 * 64 * 36;
    const auto sets = make_record_ray_sets(traced.job(64, 36), count);
    REQUIRE(sets.size() == 5);
    const Bounds3 box = bounds_of(traced.scene);
    const auto targets = shadow_targets(box);
    const float eps = 2e-5f * length(box.size());
    uint64_t wrong = 0, checked = 0, refilled = 0;
    for (std::size_t k = 1; k < sets.size(); ++k) {
        CAPTURE(sets[k].name);
        CHECK(sets[k].any_hit == (k == 1));
        REQUIRE(sets[k].rays.size() == count);
        const RaySet& parents = sets[k <= 2 ? 0 : k - 1];
        const std::vector<RayHit> hits = traced.hits(parents);
        const uint32_t seed = std::map<std::size_t, uint32_t>{{1, 11}, {2, 22}, {3, 44}, {4, 66}}[k];
        uint32_t o = 0;
        for (std::size_t i = 0; i < hits.size(); ++i) {
            if (!hits[i].is_hit()) continue;
            const Ray &parent = parents.rays[i], &ray = sets[k].rays[o];
            const uint32_t* v = &traced.scene.meshes[0].indices[3 * std::size_t(hits[i].primitive)];
            const auto& at = traced.scene.meshes[0].positions;
            Vec3 normal = normalize(cross(at[v[1]] - at[v[0]], at[v[2]] - at[v[0]]));
            if (dot(normal, parent.direction) > 0) normal = -normal;
            const Vec3 hit = parent.origin + hits[i].t * parent.direction;
            wrong += length(ray.origin - (hit + eps * normal)) > 1e-5f ? 1 : 0;
            wrong += std::abs(length(ray.direction) - 1) > 1e-6f ? 1 : 0;
            uint32_t state = hash_word(2654435761u * o + seed);
            const float u1 = draw(state), u2 = draw(state);
            if (k == 1) {
                const Vec3 way = targets[static_cast<std::size_t>(64 * u1)] - ray.origin;
                wrong += std::abs(ray.t_max - 0.9995f * length(way)) > 1e-5f * length(way) ? 1 : 0;
                wrong += length(ray.direction - normalize(way)) > 1e-5f ? 1 : 0;
            } else {
                wrong += ray.t_max != 1e30f ? 1 : 0;
                wrong += std::abs(cosine_to(ray.direction, normal) - std::sqrt(1 - static_cast<double>(u1))) > 1e-4;
                const Frame frame = make_frame(normal);
                const double angle = 2 * 3.14159265358979 * static_cast<double>(u2);
                const double r = std::sqrt(static_cast<double>(u1));
                wrong += std::abs(cosine_to(ray.direction, frame.tangent) - r * std::cos(angle)) > 1e-4;
                wrong += std::abs(cosine_to(ray.direction, frame.bitangent) - r * std::sin(angle)) > 1e-4;
            }
            ++checked;
            if (++o == count) break;
        }
        refilled += o < count ? 1 : 0;
    }
    CHECK(wrong == 0);
    CHECK(checked > 2 * count);
    CHECK(refilled == 2); // diffuse2 and diffuse3 reuse parents, because rays escape from the open box
}

TEST_CASE("a second use of parents continues a set with other numbers") {
    Traced traced(allocate());
    const uint32_t count = 4 * 64 * 36;
    const auto sets = make_record_ray_sets(traced.job(64, 36), count);
    const std::vector<RayHit> hits = traced.hits(sets[2]);
    const std::size_t made = static_cast<std::size_t>(std::ranges::count_if(hits, &RayHit::is_hit));
    REQUIRE(made < count);
    const std::vector<Ray>& rays = sets[3].rays;
    uint64_t same_start = 0;
    for (std::size_t o = made; o < count; ++o) same_start += rays[o].origin == rays[o - made].origin ? 1 : 0;
    CHECK(same_start < count / 100); // with other directions these parents have other hits
    std::set<std::array<uint32_t, 3>> directions;
    for (const Ray& ray : rays)
        directions.insert({bits_of(ray.direction.x), bits_of(ray.direction.y), bits_of(ray.direction.z)});
    CHECK(directions.size() == rays.size());
}

TEST_CASE("ray sets are the same for any number of threads") {
    Traced traced(allocate());
    const uint32_t count = 40000; // more than two of the chunks that are counted at once
    std::vector<RaySet> alone;
    {
        const UseThreads one(1);
        alone = make_record_ray_sets(traced.job(144, 256), count);
    }
    for (const int threads : {2, 5}) {
        const UseThreads several(threads);
        CHECK(same_bits(alone, make_record_ray_sets(traced.job(144, 256), count)));
    }
}

TEST_CASE("ray sets, hits and work are the same on the GPU") {
    // Both run on the CPU if no GPU was requested.
    Traced here(allocate()), there(allocate(), requested_queue());
    const uint32_t count = cuda_requested() ? 1000000 : 20000;
    const auto sets = make_record_ray_sets(here.job(256, 144), count);
    CHECK(same_bits(sets, make_record_ray_sets(there.job(256, 144), count)));
    for (const RaySet& set : sets) {
        CAPTURE(set.name);
        RaysOnDevice on_here(here.queue, set), on_there(there.queue, set);
        on_here.trace(here.tracer);
        on_there.trace(there.tracer);
        CHECK(on_here.hits() == on_there.hits());
        const auto work_here = on_here.count_work(here.tracer);
        const auto work_there = on_there.count_work(there.tracer);
        const WorkSummary a = summarize_work(work_here), b = summarize_work(work_there);
        CHECK(a.max_nodes == b.max_nodes);
        CHECK(a.nodes == doctest::Approx(b.nodes));
        CHECK(on_there.time(there.tracer, 1, 3).median > 0);
    }
}

TEST_CASE("in a frame each bounce starts only at the previous bounce's hits") {
    Traced traced(allocate());
    const auto sets = make_frame_ray_sets(traced.job(100, 60), 8);
    REQUIRE(sets.size() == 10);
    CHECK(sets[0].rays.size() == 6000);
    const auto hits_of = [&](std::size_t k) {
        return static_cast<std::size_t>(std::ranges::count_if(traced.hits(sets[k]), &RayHit::is_hit));
    };
    CHECK(sets[1].rays.size() == hits_of(0));
    CHECK(sets[2].rays.size() == hits_of(0));
    for (std::size_t k = 3; k < sets.size(); ++k) {
        CHECK(sets[k].name == "diffuse" + std::to_string(k - 1));
        CHECK(sets[k].rays.size() == hits_of(k - 1));
        CHECK(sets[k].rays.size() < sets[k - 1].rays.size());
    }
    CHECK(make_frame_ray_sets(traced.job(8, 4), 0).size() == 2);
}

TEST_CASE("a scene without hits has no secondary rays") {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    Traced traced(scene_of_mesh(mesh, looking({0, 0, 5}, {0, 0, 9}, 1)));
    for (const auto& sets :
         {make_record_ray_sets(traced.job(64, 36), 5000), make_frame_ray_sets(traced.job(64, 36), 3)}) {
        CHECK(!sets[0].rays.empty());
        for (std::size_t k = 1; k < sets.size(); ++k) CHECK(sets[k].rays.empty());
    }
}

TEST_CASE("rays start on the outside of instances at any position") {
    const Scene scene = make_mixed_scene();
    REQUIRE(scene.instances.size() > 1);
    Scene placed = scene;
    placed.cameras.assign(1, mixed_scene_camera());
    Traced traced(std::move(placed));
    const auto sets = make_frame_ray_sets(traced.job(200, 120), 1);
    const std::vector<RayHit> hits = traced.hits(sets[0]);
    std::set<uint32_t> met;
    uint64_t wrong = 0;
    for (std::size_t i = 0, o = 0; i < hits.size(); ++i) {
        if (!hits[i].is_hit()) continue;
        met.insert(hits[i].instance);
        const Ray &parent = sets[0].rays[i], &ray = sets[2].rays[o++];
        const Vec3 off = ray.origin - (parent.origin + hits[i].t * parent.direction);
        wrong += dot(off, parent.direction) > 0 || dot(off, ray.direction) < -1e-6f * length(off) ? 1 : 0;
    }
    CHECK(met.size() > 1);
    CHECK(wrong <= hits.size() / 1000); // directions along the surface may be rounded either way
}

TEST_CASE("the first shadow targets in Sponza match the record") {
    const auto path = test_scene("crytek-sponza/sponza.obj");
    if (!path) return;
    Messages messages;
    const Scene scene =
        make_record_scene(*find_named(the_record().scenes, "sponza"), path->parent_path().parent_path(), messages);
    const auto targets = shadow_targets(bounds_of(scene));
    const float printed[6] = {31.88f, 16.88f, -64.41f, 7.11f, 89.98f, 57.20f};
    for (int i = 0; i < 6; ++i) {
        CAPTURE(i);
        CHECK(std::abs(component(targets[static_cast<std::size_t>(i / 3)], i % 3) - printed[i]) <= 0.00501f);
    }
}

TEST_CASE("the number of hits in Sponza matches the record") {
    const auto path = test_scene("crytek-sponza/sponza.obj");
    if (!path) return;
    Messages messages;
    const RecordScene& record = *find_named(the_record().scenes, "sponza");
    Traced traced(make_record_scene(record, path->parent_path().parent_path(), messages));
    CHECK(traced.prepared.triangles == record.triangles);
    const uint32_t count = static_cast<uint32_t>(effort(40000, kRecordRays));
    const FrameSize frame = record_frame(count);
    const auto sets = make_record_ray_sets(traced.job(frame.width, frame.height), count);
    for (std::size_t k = 0; k < sets.size(); ++k) {
        CAPTURE(sets[k].name);
        RaysOnDevice rays(traced.queue, sets[k]);
        rays.trace(traced.tracer);
        const double share = hit_share(rays.hits()), tolerance = count == kRecordRays ? 0.001 : 0.01;
        CAPTURE(share);
        CHECK(std::abs(share - record.sets[k].hit_share) < tolerance);
    }
}
