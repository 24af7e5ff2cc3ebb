// Pictures of irradiance against closed forms and against the light meter. With --device cuda the GPU renders, too.

#include <doctest/doctest.h>

#include "session/measure_irradiance.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

RenderSettings irradiance_settings(uint32_t side, uint32_t samples) {
    RenderSettings settings;
    settings.width = settings.height = side;
    settings.samples = samples;
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0x1p-20f;
    settings.irradiance = true;
    return settings;
}

} // namespace

TEST_CASE("under a point light a floor has the irradiance I cos(t) / r^2, whatever its material") {
    constexpr uint32_t kPixels = 10;
    Material glass = test::white();
    glass.kind = MaterialKind::Dielectric;
    glass.roughness = 0;
    Material glow = test::white(0);
    glow.emission = {1e-3f, 1e-3f, 1e-3f}; // the floor has less power than the light, so most samples choose the light
    Material unlit = test::white();
    unlit.kind = MaterialKind::Unlit;
    const Vec3 light = {0.3f, 1, -0.4f};
    for (const Material& material : {test::white(0.2f), test::mirror(), glass, glow, unlit}) {
        CAPTURE(static_cast<int>(material.kind));
        Scene scene;
        test::add(scene, test::sheet({0.05f, 0, 0}, {0, 0, 10}, {10, 0, 0}), material);
        scene.lights.push_back(test::point_light(light, {7, 6, 5}));
        RenderSettings settings = irradiance_settings(kPixels, 1);
        const bool is_emitter = material.emission.r > 0; // the sample may choose the floor
        if (is_emitter) settings.samples = 1024;
        Queue queue = test::requested_queue();
        const RenderResult result = test::render(queue, scene, test::camera_down({0, 3, 0}, 4), settings);
        for (uint32_t y = 0; y < kPixels; ++y) {
            for (uint32_t x = 0; x < kPixels; ++x) {
                const Vec3 p = {(static_cast<float>(x) + 0.5f) * 0.4f - 2, 0,
                                (static_cast<float>(y) + 0.5f) * 0.4f - 2};
                const float r2 = length_squared(light - p);
                const auto wanted = static_cast<double>(7 / (r2 * pertev::sqrt(r2)));
                CHECK(static_cast<double>(result.picture.at(x, y)[0]) ==
                      doctest::Approx(wanted).epsilon(is_emitter ? 0.02 : 2e-5));
            }
        }
    }
}

TEST_CASE("a pixel of an irradiance picture equals the light meter's value") {
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    const Vec3 place = {-3.5f, 0, 2.5f}; // a point of the floor
    RenderSettings settings = irradiance_settings(1, static_cast<uint32_t>(test::effort(16384, 262144)));
    const RenderResult result =
        render_picture(queue, prepared, test::camera_down(place + Vec3{0, 0.5f, 0}, 0.001f), settings);
    RenderSettings meter;
    meter.samples = static_cast<uint32_t>(test::effort(4, 64));
    const Irradiance measured = measure_irradiance(queue, prepared, {to_double(place), {0, 1, 0}}, meter);
    for (int c = 0; c < 3; ++c) {
        CAPTURE(c);
        CHECK(static_cast<double>(result.picture.pixels[static_cast<std::size_t>(c)]) ==
              doctest::Approx(measured.rgb[c].value).epsilon(0.02));
    }
}

TEST_CASE("an irradiance picture has no layers and is black where no surface is visible") {
    Queue queue = Queue::make_cpu();
    const Scene scene = test::make_mixed_scene();
    RenderSettings settings = irradiance_settings(40, 2);
    const auto hash = [&](Queue& on) {
        return test::render_hash(test::render(on, scene, test::mixed_scene_camera(), settings));
    };
    const RenderResult result = test::render(queue, scene, test::mixed_scene_camera(), settings);
    const float* corner = result.picture.at(0, 0); // sky
    CHECK((corner[0] == 0 && corner[1] == 0 && corner[2] == 0));
    const Hash128 loop = test::render_hash(result);
    settings.body = PathBody::Wavefront;
    settings.batch = 777;
    CHECK(hash(queue) == loop);
    if (!test::cuda_requested()) return;
    Queue cuda = test::make_cuda_queue();
    CHECK(hash(cuda) == loop);
}
