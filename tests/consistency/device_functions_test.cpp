// Every host-device function gives the same bits on the CPU and in CUDA, so CPU tests also hold on the GPU. Without
// --device cuda the second run is on the CPU, too, and only shows that the stages are deterministic.

#include <doctest/doctest.h>

#include "device/buffer.h"
#include "device/launch.h"
#include "device_scene/scene_on_device.h"
#include "lab/trace_rays.h"
#include "render/prepare_scene.h"
#include "tests/statistical/bsdf_cases.h"
#include "tests/support/device_stages.h"
#include "tests/support/make_tracer.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// The long setting applies only to two devices, because comparing a CPU with itself longer shows nothing new.
uint64_t effort_of_two(uint64_t count, uint64_t long_count) {
    return test::cuda_requested() ? test::effort(count, long_count) : count;
}

/// Runs make_stage(queue, out) on both devices over `count` indices and compares the contents of `out`.
template <class MakeStage>
void check_same_bits(uint32_t count, const MakeStage& make_stage) {
    std::vector<uint32_t> results[2];
    for (int device = 0; device < 2; ++device) {
        Queue queue = device == 0 ? Queue::make_cpu() : test::requested_queue();
        const Buffer<uint32_t> out(queue, count, "results");
        make_stage(queue, out.data(), count);
        queue.wait();
        results[device] = out.download();
    }
    uint32_t different = 0;
    for (uint32_t i = 0; i < count; ++i) different += results[0][i] != results[1][i] ? 1 : 0;
    CHECK(different == 0);
}

/// Rays that start around and inside the scene, some along axes.
std::vector<Ray> rays_into(const Bounds3& bounds, uint32_t count) {
    test::Random random(9);
    std::vector<Ray> rays;
    const Vec3 centre = bounds.centre(), half = 0.6f * bounds.size();
    for (uint32_t i = 0; i < count; ++i) {
        Ray ray;
        const Vec3 p = random.point(-1, 1);
        ray.origin = centre + Vec3{p.x * half.x, p.y * half.y, p.z * half.z};
        ray.direction = random.direction();
        if (i % 64 == 0) ray.direction = {i % 128 == 0 ? 1.0f : 0.0f, 0.0f, i % 128 == 0 ? 0.0f : -1.0f};
        rays.push_back(ray);
    }
    return rays;
}

void check_same_hits(const Scene& scene, uint32_t count) {
    Messages messages;
    const PreparedScene prepared =
        prepare_scene(scene, {.bvh = {}, .bvh_cache = {}, .keep_coordinates = true}, messages);
    const std::vector<Ray> rays = rays_into(bounds_of(scene), count);
    std::vector<Hit> hits[2];
    std::vector<uint32_t> occluded[2];
    for (int device = 0; device < 2; ++device) {
        Queue queue = device == 0 ? Queue::make_cpu() : test::requested_queue();
        const Tracer tracer = test::make_tracer(queue, prepared);
        const Buffer<Ray> in(queue, std::span<const Ray>(rays), "rays");
        const Buffer<Float4> places(queue, count, "hits");
        const Buffer<uint32_t> instances(queue, count, "hits"), any(queue, count, "any hits");
        tracer.find_hits(all_candidates(in.data()), count, {places.data(), instances.data()});
        tracer.find_occlusions(all_candidates(in.data()), count, {nullptr, any.data()});
        queue.wait();
        const std::vector<Float4> found_places = places.download();
        const std::vector<uint32_t> found_instances = instances.download();
        for (uint32_t i = 0; i < count; ++i) {
            const Float4 p = found_places[i];
            hits[device].push_back({p.x, p.y, p.z, found_instances[i], bits_of(p.w)});
        }
        occluded[device] = any.download();
    }
    uint32_t different = 0, found = 0, disagree = 0;
    for (uint32_t i = 0; i < count; ++i) {
        different += hits[0][i] == hits[1][i] && occluded[0][i] == occluded[1][i] ? 0 : 1;
        found += hits[0][i].instance != kNoHit ? 1 : 0;
        disagree += (hits[0][i].instance != kNoHit) == (occluded[0][i] != kNoHit) ? 0 : 1;
    }
    CHECK(different == 0);
    CHECK(disagree == 0); // a closest hit exists if and only if any hit does
    CHECK(found > count / 20);
}

} // namespace

TEST_CASE("random numbers have the same bits on both devices") {
    for (const SamplerKind kind : {SamplerKind::Sobol, SamplerKind::Independent}) {
        check_same_bits(static_cast<uint32_t>(effort_of_two(1 << 18, 1 << 26)),
                        [&](Queue& queue, uint32_t* out, uint32_t count) {
                            launch(queue, "draw_samples", count, test::DrawSamples{kind, out});
                        });
    }
}

TEST_CASE("BSDFs have the same bits on both devices") {
    std::vector<Bsdf> bsdfs;
    for (const test::BsdfCase& c : test::rough_bsdf_cases()) bsdfs.push_back(c.bsdf);
    bsdfs.push_back(make_conductor(test::kGoldEta, test::kGoldK, 0));
    bsdfs.push_back(make_dielectric(1.5f, 0, grey(1)));
    check_same_bits(static_cast<uint32_t>(effort_of_two(1 << 18, 1 << 26)),
                    [&](Queue& queue, uint32_t* out, uint32_t count) {
                        const Buffer<Bsdf> buffer(queue, std::span<const Bsdf>(bsdfs), "bsdfs");
                        launch(queue, "scatter_randomly", count,
                               test::ScatterRandomly{buffer.data(), static_cast<uint32_t>(bsdfs.size()), out});
                        queue.wait(); // before the buffer is freed
                    });
}

TEST_CASE("light samples have the same bits on both devices") {
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    check_same_bits(static_cast<uint32_t>(effort_of_two(1 << 18, 1 << 26)),
                    [&](Queue& queue, uint32_t* out, uint32_t count) {
                        const SceneOnDevice on_device(queue, prepared);
                        launch(queue, "draw_lights", count, test::DrawLights{on_device.view().lights, 5.0f, out});
                        queue.wait();
                    });
}

TEST_CASE("hits on instances and on a mesh of uneven triangles have the same bits on both devices") {
    check_same_hits(test::make_mixed_scene(), static_cast<uint32_t>(effort_of_two(100'000, 10'000'000)));
    const test::TriangleMesh torus = test::make_torus(400, 200);
    Scene scene;
    scene.meshes.push_back({});
    scene.meshes[0].positions = torus.positions;
    scene.meshes[0].indices = torus.indices;
    scene.materials.push_back({});
    scene.instances.push_back({"torus", 0, 0, {}});
    check_same_hits(scene, static_cast<uint32_t>(effort_of_two(100'000, 10'000'000)));
}

TEST_CASE(
    "elementary functions have the same bits on both devices, with --device cuda and --long over all 2^32 inputs") {
    constexpr uint32_t per_index = 256;
    const uint64_t inputs = effort_of_two(uint64_t(1) << 20, uint64_t(1) << 32);
    const uint32_t stride =
        static_cast<uint32_t>((uint64_t(1) << 32) / inputs); // in CI, blocks spread over all exponents
    for (int function = 0; function < test::kPortableFunctionCount; ++function) {
        CAPTURE(test::portable_function_name(function));
        const auto blocks = static_cast<uint32_t>(inputs / per_index);
        if (stride == 1) {
            check_same_bits(blocks, [&](Queue& queue, uint32_t* out, uint32_t count) {
                launch(queue, "evaluate_math", count, test::EvaluateMath{function, 0, per_index, out});
            });
            continue;
        }
        for (uint32_t part = 0; part < 16; ++part) {
            check_same_bits(blocks / 16, [&](Queue& queue, uint32_t* out, uint32_t count) {
                launch(queue, "evaluate_math", count,
                       test::EvaluateMath{function, part << 28 | part * 0x0badcafu, per_index, out});
            });
        }
        for (const uint32_t end : {0x00800000u, 0x3f800000u, 0x7e800000u, 0x7f800000u}) { // 2^-126, 1, 2^126, infinity
            for (const uint32_t sign : {0u, 0x80000000u}) {
                check_same_bits(2, [&](Queue& queue, uint32_t* out, uint32_t count) {
                    launch(queue, "evaluate_math", count,
                           test::EvaluateMath{function, (end | sign) - per_index, per_index, out});
                });
            }
        }
    }
}

TEST_CASE("ray setup has the same bits on both devices, even along axes and close to them") {
    check_same_bits(
        static_cast<uint32_t>(effort_of_two(1 << 12, 1 << 20)),
        [&](Queue& queue, uint32_t* out, uint32_t count) { launch(queue, "shear_rays", count, test::ShearRays{out}); });
}

TEST_CASE("deformed vertices have the same bits on both devices") {
    constexpr uint32_t kCount = 1u << 14, kJoints = 16, kPerVertex = 8, kTargets = 3;
    test::Random random(21);
    const auto vectors = [&](uint32_t count, float scale) {
        std::vector<Vec3> values;
        for (uint32_t i = 0; i < count; ++i) values.push_back(scale * random.point(-1, 1));
        return values;
    };
    const std::vector<Vec3> positions = vectors(kCount, 3), normals = vectors(kCount, 1);
    std::vector<Vec4> tangents;
    for (const Vec3 t : vectors(kCount, 1)) tangents.push_back({t.x, t.y, t.z, t.x < 0 ? -1.0f : 1.0f});
    const std::vector<Vec3> offsets = vectors(3 * kTargets * kCount, 0.5f);
    const std::vector<float> morph_weights = {0.3f, 0, -1.5f};
    std::vector<uint32_t> joints;
    std::vector<float> weights;
    for (uint32_t i = 0; i < kPerVertex * kCount; ++i) {
        joints.push_back(random.below(kJoints));
        weights.push_back(i % 5 == 0 ? 0.0f : random.within(0, 1));
    }
    std::vector<Transform> transforms;
    for (uint32_t i = 0; i < kJoints; ++i) {
        const std::vector<Vec3> rows = vectors(4, 1);
        transforms.push_back({rows[0], rows[1], rows[2], rows[3]});
    }
    transforms[5] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, kInfinity, 0}};
    check_same_bits(kCount, [&](Queue& queue, uint32_t* out, uint32_t count) {
        const auto copy = [&](const auto& values) { return Buffer(queue, std::span(values), "deformed"); };
        const auto base_positions = copy(positions), base_normals = copy(normals), all_offsets = copy(offsets);
        const auto base_tangents = copy(tangents);
        std::vector<MorphTargetView> views;
        for (uint32_t k = 0; k < kTargets; ++k) {
            const Vec3* first = all_offsets.data() + std::size_t(3) * k * kCount;
            views.push_back({first, first + kCount, first + 2 * kCount});
        }
        const auto targets = copy(views);
        const auto target_weights = copy(morph_weights), joint_weights = copy(weights);
        const auto joint_numbers = copy(joints);
        const auto world_from_joints = copy(transforms);
        const Buffer<Vec3> out_positions(queue, count, "deformed"), out_normals(queue, count, "deformed");
        const Buffer<Vec4> out_tangents(queue, count, "deformed");
        const DeformVertices deform = {.base_positions = base_positions.data(),
                                       .base_normals = base_normals.data(),
                                       .base_tangents = base_tangents.data(),
                                       .targets = targets.data(),
                                       .morph_weights = target_weights.data(),
                                       .target_count = kTargets,
                                       .joints_per_vertex = kPerVertex,
                                       .joints = joint_numbers.data(),
                                       .joint_weights = joint_weights.data(),
                                       .world_from_joints = world_from_joints.data(),
                                       .positions = out_positions.data(),
                                       .normals = out_normals.data(),
                                       .tangents = out_tangents.data()};
        launch(queue, "deform", count, test::DeformAndFold{deform, out});
        queue.wait();
    });
}
