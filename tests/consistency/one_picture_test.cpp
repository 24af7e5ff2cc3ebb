// The one-picture law on the CPU: the picture and all its layers have the same bytes for any number of threads, any
// split of the samples, either schedule of the path tracer, any batch and any tree. With --device cuda the GPU
// renders, too.

#include <doctest/doctest.h>

#include <functional>

#include "base/parallel_for.h"
#include "image/picture_hash.h"
#include "integrators/path/path_integrator.h"
#include "session/session_bytes.h"
#include "shading/shading_variant.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

RenderSettings odd_settings() {
    RenderSettings settings;
    settings.width = 61; // not a multiple of a tile
    settings.height = 35;
    settings.samples = 6;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.transparent = true;
    return settings;
}

/// Returns the hash of the picture, the layers, the ids and the share of hidden backs.
Hash128 hash_of_mixed(const RenderResult& result) {
    Hasher hasher;
    test::add_picture(hasher, result);
    CHECK(result.hidden_back_share > 0.001); // a sheet of the mixed scene
    hasher.add_value(result.hidden_back_share);
    return hasher.result();
}

Hash128 cpu_hash(const RenderSettings& settings, const PrepareOptions& prepare = {}) {
    Queue queue = Queue::make_cpu();
    return hash_of_mixed(test::render(queue, test::make_mixed_scene(), test::mixed_scene_camera(), settings, prepare));
}

const Hash128& reference_hash() {
    static const Hash128 hash = cpu_hash(odd_settings());
    return hash;
}

} // namespace

TEST_CASE("the picture does not depend on the number of threads") {
    for (const int threads : {1, 2, 5}) {
        CAPTURE(threads);
        const UseThreads use(threads);
        CHECK(cpu_hash(odd_settings()) == reference_hash());
    }
}

TEST_CASE("the picture does not depend on how the samples are split into passes") {
    RenderSettings settings = odd_settings();
    for (const uint32_t pass : {1u, 4u, 6u}) {
        CAPTURE(pass);
        settings.pass_samples = pass;
        CHECK(cpu_hash(settings) == reference_hash());
    }
}

TEST_CASE("the wavefront gives the bytes of the loop for any number of paths in flight") {
    RenderSettings settings = odd_settings();
    settings.body = PathBody::Wavefront;
    for (const uint32_t batch : {777u, 5000u, 1u << 20}) { // less than a picture, two samples, and all samples
        CAPTURE(batch);
        settings.batch = batch;
        CHECK(cpu_hash(settings) == reference_hash());
    }
}

TEST_CASE("the wavefront gives the bytes of the loop under every light sampling strategy") {
    for (const LightStrategy strategy : test::kLightStrategies) {
        CAPTURE(static_cast<int>(strategy));
        RenderSettings settings = odd_settings();
        settings.path.strategy = strategy;
        const Hash128 loop = cpu_hash(settings);
        CHECK((loop == reference_hash()) == (strategy == LightStrategy::Mis));
        settings.body = PathBody::Wavefront;
        CHECK(cpu_hash(settings) == loop);
    }
}

namespace {

/// The mixed scene with materials of restricted variants.
Scene scene_with(ShadingVariant variant) {
    Scene scene = test::make_mixed_scene();
    for (Material& material : scene.materials) {
        if (!has_lobes(variant)) material.kind = MaterialKind::Diffuse;
        if (variant == ShadingVariant::General) {
            material.coat_weight = 0.7f;
            material.coat_roughness = 0.3f;
            material.fuzz_weight = 0.5f;
            material.specular_color = {1, 0.5f, 0.2f};
        }
        if (variant != ShadingVariant::PlainDiffuse) continue;
        material.alpha_mode = AlphaMode::Opaque;
        material.base_color_texture = material.normal_texture = material.emission_texture = {};
    }
    return scene;
}

ShadingVariant variant_of(const Scene& scene) {
    std::vector<MaterialParameters> views;
    for (const Material& material : scene.materials) views.push_back(material);
    return pertev::variant_of(views);
}

} // namespace

TEST_CASE("vertices shaded in lanes give the bytes of vertices shaded one by one") {
    const Scene scene = scene_with(ShadingVariant::PlainDiffuse), mixed = scene_with(ShadingVariant::Unstacked);
    Scene nested = mixed; // with a ball of glass within the one that there is
    for (const Instance& instance : mixed.instances) {
        if (mixed.materials[instance.material].kind != MaterialKind::Dielectric) continue;
        nested.instances.push_back(instance);
        for (Vec3 Transform::*const row : {&Transform::row0, &Transform::row1, &Transform::row2})
            nested.instances.back().world_from_local.*row = 0.5f * (instance.world_from_local.*row);
    }
    CHECK(nested.instances.size() == mixed.instances.size() + 1);
    Queue queue = Queue::make_cpu();
    const auto check_lanes = [&](const Scene& in_lanes, const RenderSettings& settings) {
        Scene alone = in_lanes;
        alone.materials.push_back({{.kind = MaterialKind::Dielectric, .emission = {1, 1, 1}}, "unused"});
        alone.materials.back().transmission_depth = 1;
        const auto hash = [&](const Scene& of) {
            return test::render_hash(test::render(queue, of, test::mixed_scene_camera(), settings));
        };
        CHECK(hash(in_lanes) == hash(alone));
    };
    std::vector<RenderSettings> cases(9, odd_settings());
    cases[8].path.light_choice = LightSelection::Tree;
    cases[0].aovs = 0;
    cases[1].path.max_depth = 1;
    cases[2].path.clamp = 0.5f;
    cases[3].path.roulette = Roulette::Throughput, cases[3].path.roulette_depth = 1;
    cases[4].path.roulette = Roulette::NearCubeRoot, cases[4].path.sampler = SamplerKind::Independent;
    cases[5].path.max_depth = 0;
    cases[6].path.strategy = cases[7].path.strategy = LightStrategy::NeeOnly;
    cases[7].path.max_depth = 1;
    for (const RenderSettings& settings : cases) {
        CAPTURE(&settings - cases.data());
        for (const Scene& each : {std::cref(scene), std::cref(mixed), std::cref(nested)}) check_lanes(each, settings);
    }
    for (const Rgb sky : {Rgb{0.3f, 0.4f, 0.6f}, Rgb{0, 0, 0}}) {
        Scene under_sky = scene;
        under_sky.environment = Environment{{}, sky, 1.0f};
        check_lanes(under_sky, odd_settings());
        under_sky.lights.clear();
        for (Material& material : under_sky.materials) material.emission = {0, 0, 0};
        check_lanes(under_sky, odd_settings());
    }
}

TEST_CASE("shading variants give the bytes of the general one") {
    Hash128 before = {};
    for (const ShadingVariant variant :
         {ShadingVariant::General, ShadingVariant::Unstacked, ShadingVariant::Diffuse, ShadingVariant::PlainDiffuse}) {
        CAPTURE(static_cast<int>(variant));
        const Scene scene = scene_with(variant);
        CHECK(variant_of(scene) == variant);
        Scene of_any = scene; // the scene needs the general variant because of an unused material
        of_any.materials.push_back({{.coat_weight = 1}, "unused"});
        CHECK(variant_of(of_any) == ShadingVariant::General);
        RenderSettings settings = odd_settings();
        settings.samples = 2;
        std::vector<Queue> queues;
        queues.push_back(Queue::make_cpu());
        if (test::cuda_requested()) queues.push_back(test::make_cuda_queue());
        const auto hash = [&](Queue& queue, const Scene& of) {
            return hash_of_mixed(test::render(queue, of, test::mixed_scene_camera(), settings));
        };
        const Hash128 expected = hash(queues[0], of_any);
        CHECK(expected != before);
        before = expected;
        CHECK(hash(queues[0], scene) == expected);
        settings.body = PathBody::Wavefront;
        for (Queue& queue : queues) {
            CHECK(hash(queue, scene) == expected);
            CHECK(hash(queue, of_any) == expected);
        }
    }
    Scene unlit = scene_with(ShadingVariant::PlainDiffuse);
    unlit.materials.back().kind = MaterialKind::Unlit;
    CHECK(variant_of(unlit) == ShadingVariant::Unstacked);
    Scene blended = scene_with(ShadingVariant::PlainDiffuse);
    blended.materials.back().alpha_mode = AlphaMode::Blend;
    CHECK(variant_of(blended) == ShadingVariant::Diffuse);
}

TEST_CASE("the picture does not depend on how the trees were built") {
    for (const int bins : {4, 32}) {
        for (const int leaf : {1, 8}) {
            CAPTURE(bins);
            CAPTURE(leaf);
            PrepareOptions prepare;
            prepare.bvh.bins = bins;
            prepare.bvh.max_leaf = leaf;
            CHECK(cpu_hash(odd_settings(), prepare) == reference_hash());
        }
    }
}

TEST_CASE("a different seed or number of samples gives a different hash") {
    RenderSettings settings = odd_settings();
    settings.path.seed = 1;
    CHECK(cpu_hash(settings) != reference_hash());
    settings = odd_settings();
    settings.samples = 7;
    CHECK(cpu_hash(settings) != reference_hash());
}

TEST_CASE("pictures and frames of two wavefronts, or of one with the memory of two, have the bytes of the CPU") {
    if (!test::cuda_requested()) return;
    Queue gpu = test::make_cuda_queue(), cpu = Queue::make_cpu();
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = odd_settings();
    settings.path.max_depth = 3;
    Session on_gpu(gpu, prepared, test::mixed_scene_camera(), settings),
        on_cpu(cpu, prepared, test::mixed_scene_camera(), settings);
    const auto check = [&](uint32_t width, uint32_t height, uint32_t samples) {
        CAPTURE(width);
        settings.width = width, settings.height = height;
        Hash128 hashes[2];
        for (Session* session : {&on_gpu, &on_cpu}) {
            session->set_settings(settings);
            session->cut();
            session->render(samples);
            hashes[session == &on_cpu] = hash_of_mixed(session->result());
        }
        CHECK(hashes[0] == hashes[1]);
    };
    check(90, 50, 1);    // one
    check(1000, 521, 1); // two with equal shares
    check(1000, 601, 2); // with room for more
    check(1000, 521, 1); // two with equal shares, once more
    check(700, 500, 1);  // one of them
    settings.path.max_depth = 17;
    check(1000, 521, 1); // one wavefront again, because it has many rounds
    // One wavefront would suffice for a pass of one sample, but the picture has two.
    settings.width = 1300, settings.height = 1100;
    on_gpu.set_settings(settings);
    on_gpu.render(3);
    const uint64_t allocations = gpu.allocation_count();
    on_gpu.cut();
    on_gpu.render(3);
    CHECK(gpu.allocation_count() == allocations);
}

TEST_CASE("frames that split light after a large picture keep their bytes and their queues' memory") {
    if (!test::cuda_requested()) return;
    Queue gpu = test::make_cuda_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = odd_settings();
    settings.width = 1920, settings.height = 1080, settings.aovs = 0;
    Hash128 hashes[2];
    for (const bool renders_before : {false, true}) {
        Session session(gpu, prepared, test::mixed_scene_camera(), settings);
        if (renders_before) session.render(2); // allows all paths that a picture can have
        const std::size_t before = gpu.allocated_bytes();
        session.render_frame(0, {});
        session.render_frame(1, {});
        hashes[renders_before ? 1 : 0] = picture_hash(session.frame_result().picture);
        if (!renders_before) continue;
        const std::size_t film = Film::predicted_bytes(1920, 1080, 0);
        CHECK(gpu.allocated_bytes() <= predicted_frame_bytes(prepared, settings, {}, {}, true) + film + 8192);
        CHECK(before > PathIntegrator::kMaxQueueBytes - 10'000'000);
    }
    CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("the GPU gives the bytes of the CPU") {
    if (!test::cuda_requested()) return;
    Queue queue = test::make_cuda_queue();
    for (const uint32_t batch : {777u, 1u << 20}) {
        for (const SamplerKind sampler : {SamplerKind::Sobol, SamplerKind::Independent}) {
            for (const PathLight light : {PathLight::Path, PathLight::Direct, PathLight::Indirect}) {
                for (const LightStrategy strategy : test::kLightStrategies) {
                    RenderSettings settings = odd_settings();
                    settings.batch = batch;
                    settings.path.sampler = sampler;
                    settings.path.light = light;
                    settings.path.strategy = strategy;
                    const Hash128 gpu = hash_of_mixed(
                        test::render(queue, test::make_mixed_scene(), test::mixed_scene_camera(), settings));
                    CHECK(gpu == cpu_hash(settings));
                }
            }
        }
    }
}
