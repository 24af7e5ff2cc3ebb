// Compares light-path layers with other ways to separate the same light: other depths, the parts of the path tracer,
// scenes with only some lights or lobes. With --device cuda it runs on the GPU.

#include <doctest/doctest.h>

#include "render/light_paths/light_path_layers.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

void request_layers(RenderSettings& settings, std::initializer_list<const char*> texts, const Scene& scene) {
    std::vector<LightPathExpression> expressions;
    for (const char* text : texts) expressions.push_back(parse_light_path(text));
    settings.light_paths = std::make_shared<const LightPathLayers>(bind_to_scene(std::move(expressions), scene));
}

/// The tolerance of floats that are summed in another order.
void check_same_light(const Image& layer, const Image& expected) {
    REQUIRE(layer.pixels.size() == expected.pixels.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < layer.pixels.size(); ++i) {
        const auto wanted = static_cast<double>(expected.pixels[i]);
        wrong += std::abs(static_cast<double>(layer.pixels[i]) - wanted) <= 2e-6 * wanted + 1e-12 ? 0 : 1;
    }
    CHECK(wrong == 0);
    CHECK(test::mean_of(expected) > 0);
}

RenderSettings small_lpe_settings(uint32_t samples) {
    RenderSettings settings;
    settings.width = 40;
    settings.height = 24;
    settings.samples = samples;
    return settings;
}

/// An open diffuse floor with a rough dielectric reflection, and a camera above it.
Scene varnished_floor(float albedo) {
    Scene scene;
    Material varnished = test::white(albedo);
    varnished.kind = MaterialKind::MetallicRoughness;
    varnished.roughness = 0.5f;
    test::add(scene, test::sheet({0.05f, 0, 0}, {0, 0, 10}, {10, 0, 0}), varnished);
    return scene;
}

} // namespace

TEST_CASE("layers of at most n scatterings equal pictures of max depth n") {
    Queue queue = test::requested_queue();
    const Scene scene = test::make_mixed_scene();
    RenderSettings settings = small_lpe_settings(4);
    request_layers(settings, {"d0=L.{0}E", "d1=L.{0,1}E", "d3=L.{0,3}E"}, scene);
    const RenderResult layers = test::render(queue, scene, test::mixed_scene_camera(), settings);
    settings.light_paths = nullptr;
    for (const auto& [name, depth] : {std::pair("d0", 0u), std::pair("d1", 1u), std::pair("d3", 3u)}) {
        CAPTURE(depth);
        settings.path.max_depth = depth;
        check_same_light(layer_named(layers, name),
                         test::render(queue, scene, test::mixed_scene_camera(), settings).picture);
    }
}

TEST_CASE("direct and indirect light equal their light path expressions") {
    Queue queue = test::requested_queue();
    const Scene scene = test::make_mixed_scene();
    RenderSettings settings = small_lpe_settings(4);
    request_layers(settings, {"direct=LS*[DG]?S*E", "indirect=L.*[DG].*[DG].*E"}, scene);
    const RenderResult layers = test::render(queue, scene, test::mixed_scene_camera(), settings);
    settings.light_paths = nullptr;
    for (const auto& [name, part] :
         {std::pair("direct", PathLight::Direct), std::pair("indirect", PathLight::Indirect)}) {
        CAPTURE(name);
        settings.path.light = part;
        check_same_light(layer_named(layers, name),
                         test::render(queue, scene, test::mixed_scene_camera(), settings).picture);
    }
}

TEST_CASE("each emitter's layer equals the picture with only that emitter") {
    Queue queue = test::requested_queue();
    const Light lights[] = {test::point_light({0.7f, 1.5f, -0.4f}, {3, 2, 1}),
                            test::point_light({-0.8f, 2.0f, 0.2f}, {1, 4, 6})};
    Scene both = varnished_floor(0.6f);
    for (const Light& light : lights) both.lights.push_back(light);
    both.lights[0].name = "warm";
    both.lights[1].name = "cold";
    RenderSettings settings = small_lpe_settings(static_cast<uint32_t>(test::effort(1024, 16384)));
    settings.width = settings.height = 6;
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0x1p-20f;
    request_layers(settings, {"warm=L<'warm'>.*E", "cold=L<'c*'>.*E"}, both);
    const Camera camera = test::camera_down({0, 3, 0}, 4);
    const RenderResult layers = test::render(queue, both, camera, settings);
    settings.light_paths = nullptr;
    settings.samples = 1; // with one light there is no random choice
    for (int i = 0; i < 2; ++i) {
        Scene one = varnished_floor(0.6f);
        one.lights.push_back(lights[i]);
        const Image alone = test::render(queue, one, camera, settings).picture;
        const Image& layer = layer_named(layers, i == 0 ? "warm" : "cold");
        for (std::size_t k = 0; k < alone.pixels.size();
             ++k) { // the choice of the emitter is stratified, so there is little noise
            CHECK(layer.pixels[k] == doctest::Approx(static_cast<double>(alone.pixels[k])).epsilon(0.01));
        }
    }
}

TEST_CASE("a point light's diffuse and glossy parts equal those of the lobes") {
    Queue queue = test::requested_queue();
    Scene scene = varnished_floor(0.6f), black = varnished_floor(0.0f);
    scene.lights.push_back(test::point_light({0.7f, 1.5f, -0.4f}, {3, 2, 1}));
    black.lights = scene.lights;
    RenderSettings settings = small_lpe_settings(2);
    request_layers(settings, {"diffuse=LDE", "glossy=LGE"}, scene);
    const Camera camera = test::camera_down({0, 3, 0}, 4);
    const RenderResult result = test::render(queue, scene, camera, settings);
    settings.light_paths = nullptr;
    const Image reflection = test::render(queue, black, camera, settings).picture; // the lobe without a base
    const Image &diffuse = layer_named(result, "diffuse"), &glossy = layer_named(result, "glossy");
    for (std::size_t i = 0; i < reflection.pixels.size(); ++i) {
        const auto whole = static_cast<double>(result.picture.pixels[i]);
        CHECK(std::abs(static_cast<double>(glossy.pixels[i]) - static_cast<double>(reflection.pixels[i])) <=
              1e-5 * whole);
        CHECK(static_cast<double>(diffuse.pixels[i]) + static_cast<double>(glossy.pixels[i]) ==
              doctest::Approx(whole).epsilon(1e-6));
    }
    CHECK(test::mean_of(glossy) > 0.01 * test::mean_of(diffuse));
}

TEST_CASE("randomly chosen lobe classes have the same mean as split ones") {
    Queue queue = test::requested_queue();
    Scene scene = varnished_floor(0.6f);
    Material glow = test::white(0);
    glow.emission = {4, 3, 2};
    test::add(scene, test::sheet({0, 1.5f, 0}, {2, 0, 0}, {0, 0, 2}), glow); // faces down
    RenderSettings settings = small_lpe_settings(static_cast<uint32_t>(test::effort(4096, 65536)));
    settings.width = settings.height = 4;
    settings.path.max_depth = 2;
    request_layers(settings, {"diffuse=LDE", "glossy=LGE"}, scene);
    const Camera camera = test::camera_down({0, 1, 0}, 1);
    double means[3][2];
    for (const LightStrategy strategy : test::kLightStrategies) {
        settings.path.strategy = strategy;
        const RenderResult result = test::render(queue, scene, camera, settings);
        means[static_cast<int>(strategy)][0] = test::mean_of(layer_named(result, "diffuse"));
        means[static_cast<int>(strategy)][1] = test::mean_of(layer_named(result, "glossy"));
    }
    for (const auto& mean : means) {
        CHECK(mean[0] == doctest::Approx(means[0][0]).epsilon(0.01));
        CHECK(mean[1] == doctest::Approx(means[0][1]).epsilon(0.02));
    }
    CHECK(means[0][1] > 0.02 * means[0][0]);
}

TEST_CASE("an emitter within glass lights a floor only by caustics") {
    Queue queue = test::requested_queue();
    Scene scene;
    test::add(scene, test::sheet({0.05f, 0, 0}, {0, 0, 10}, {10, 0, 0}), test::white(0.5f));
    Material glow = test::white(0);
    glow.emission = {50, 50, 50};
    test::add(scene, test::sheet({0, 1, 0}, {0.2f, 0, 0}, {0, 0, 0.2f}), glow); // faces down
    Material glass = test::white();
    glass.kind = MaterialKind::Dielectric;
    glass.roughness = 0;
    Mesh shell;
    const auto sphere = test::make_sphere(2, {0, 1, 0}, 0.5f);
    shell.positions = sphere.positions;
    shell.indices = sphere.indices;
    test::add(scene, shell, glass);
    RenderSettings settings = small_lpe_settings(32);
    request_layers(settings, {"caustics=LS<T>S*DE", "first=L[DG]+E", "second=LDS*DE", "seen=LS*E", "all=L.*E"}, scene);
    Camera camera;
    camera.world_from_camera = look_at({0, 2, 5}, {0, 0.5f, 0}, {0, 1, 0});
    const RenderResult result = test::render(queue, scene, camera, settings);
    CHECK(test::mean_of(layer_named(result, "first")) == 0);
    CHECK(test::mean_of(layer_named(result, "second")) == 0);
    CHECK(test::mean_of(layer_named(result, "caustics")) > 0);
    check_same_light(layer_named(result, "all"), result.picture);
}
