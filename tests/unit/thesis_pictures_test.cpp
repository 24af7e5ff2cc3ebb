// Pictures of the thesis's chapter 3: the scenes are what their figures say, and each picture shows something.

#include <doctest/doctest.h>

#include <algorithm>
#include <utility>

#include "lab/thesis_pictures.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

TEST_CASE("the point light of figure 3.3 has the intensity that the lamp of figure 3.4 has straight down") {
    const Scene hard = thesis_scene("3.3"), soft = thesis_scene("3.4");
    const auto lamp = std::ranges::find(soft.instances, "light", &Instance::name);
    REQUIRE(lamp != soft.instances.end());
    CHECK(hard.instances[static_cast<std::size_t>(lamp - soft.instances.begin())].is_hidden);
    CHECK_FALSE(lamp->is_hidden);
    CHECK(soft.lights.empty());
    REQUIRE(hard.lights.size() == 1);
    const Mesh& mesh = soft.meshes[lamp->mesh];
    float area = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const Vec3 a = mesh.positions[mesh.indices[i]];
        area += 0.5f * length(cross(mesh.positions[mesh.indices[i + 1]] - a, mesh.positions[mesh.indices[i + 2]] - a));
    }
    const Rgb emission = soft.materials[lamp->material].emission;
    CHECK(hard.lights[0].intensity.r == doctest::Approx(static_cast<double>(area * emission.r)).epsilon(1e-4));
    CHECK(hard.lights[0].intensity.b == doctest::Approx(static_cast<double>(area * emission.b)).epsilon(1e-4));
    CHECK(hard.lights[0].position.y == doctest::Approx(static_cast<double>(mesh.positions[0].y - 0.01f)));
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

TEST_CASE(
    "shadows are hard under a point light and soft under a lamp, and indirect light has neither lamp nor shadow") {
    Queue queue = test::queue_asked_for();
    RenderSettings settings;
    settings.width = 96;
    settings.height = 72;
    settings.samples = 64;
    // Shares of neighbours in a row of which one is at least 1.5 times as bright as the other, and of white.
    const auto look_at_picture = [&](const char* number) {
        const auto picture = render_thesis_picture(queue, number, settings, [](const RenderProgress&) { return true; });
        const auto& pixels = picture.image.pixels;
        int steps = 0, white = 0;
        for (uint32_t y = 0; y < settings.height; ++y) {
            for (uint32_t x = 0; x + 1 < settings.width; ++x) {
                const int a = pixels[4 * (y * settings.width + x) + 1],
                          b = pixels[4 * (y * settings.width + x + 1) + 1];
                steps += std::max(a, b) > std::min(a, b) + 40 ? 1 : 0;
                white += a > 250 ? 1 : 0;
            }
        }
        return std::pair(steps, white);
    };
    const auto [hard_steps, hard_white] = look_at_picture("3.3");
    const auto [soft_steps, soft_white] = look_at_picture("3.4");
    const auto [indirect_steps, indirect_white] = look_at_picture("3.6");
    CHECK(hard_steps > 1.3 * soft_steps);
    CHECK(soft_steps > 1.3 * indirect_steps);
    CHECK(soft_white > indirect_white);
}
