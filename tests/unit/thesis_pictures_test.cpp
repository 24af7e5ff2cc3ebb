// Pictures of the thesis's chapter 3: the scenes are what their figures say, and each picture shows something.

#include <doctest/doctest.h>

#include <algorithm>

#include "lab/thesis_pictures.h"
#include "session/measure_irradiance.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

TEST_CASE("the point light of figure 3.3 lights the floor as the lamp of figure 3.4 does") {
    Queue queue = test::queue_asked_for();
    double lux[2];
    for (const int i : {0, 1}) {
        const Scene scene = thesis_scene(i == 0 ? "3.3" : "3.4");
        CHECK(scene.lights.size() == (i == 0 ? 1 : 0));
        Messages messages;
        const PreparedScene prepared = prepare_scene(scene, {}, messages);
        RenderSettings settings;
        settings.samples = 4;
        settings.path.max_depth = 0; // straight from the light
        lux[i] = measure_irradiance(queue, prepared, {{0.278f, 0, 0.28f}, {0, 1, 0}}, settings).luminance.value;
    }
    CHECK(lux[0] == doctest::Approx(lux[1]).epsilon(0.1)); // one has a size, the other hangs a centimetre lower
}

TEST_CASE("the ball of figure 3.8 is a mirror that stands on the floor") {
    const Scene scene = thesis_scene("3.8");
    const auto ball = std::ranges::find(scene.instances, "mirror sphere", &Instance::name);
    REQUIRE(ball != scene.instances.end());
    CHECK(std::ranges::find(scene.instances, "short block", &Instance::name) == scene.instances.end());
    CHECK(scene.materials[ball->material].metallic == 1);
    CHECK(scene.materials[ball->material].roughness == 0);
    Bounds3 bounds;
    for (const Vec3 p : scene.meshes[ball->mesh].positions) bounds.extend(p);
    CHECK(bounds.lo.y == doctest::Approx(0.0).epsilon(1e-6));
    CHECK(bounds.size().x == doctest::Approx(0.2).epsilon(1e-4));
    // Normals point out, as the winding does.
    const Mesh& mesh = scene.meshes[ball->mesh];
    const Vec3 a = mesh.positions[mesh.indices[3]], b = mesh.positions[mesh.indices[4]],
               c = mesh.positions[mesh.indices[5]];
    CHECK(dot(cross(b - a, c - a), mesh.normals[mesh.indices[3]]) > 0);
}

TEST_CASE("the four figures differ, and none is black") {
    Queue queue = test::queue_asked_for();
    RenderSettings settings;
    settings.width = 32;
    settings.height = 24;
    settings.samples = 2;
    std::vector<std::vector<uint8_t>> seen;
    for (const char* number : kThesisPictures) {
        CAPTURE(number);
        const ThesisPicture picture =
            render_thesis_picture(queue, number, settings, [](const RenderProgress&) { return true; });
        CHECK(picture.stats.samples == 2);
        CHECK(picture.stats.rays.total() > 0);
        CHECK_FALSE(picture.interrupted);
        CHECK(std::ranges::count_if(picture.image.pixels, [](uint8_t c) { return c > 60 && c < 255; }) > 200);
        CHECK(std::ranges::find(seen, picture.image.pixels) == seen.end());
        seen.push_back(picture.image.pixels);
    }
}
