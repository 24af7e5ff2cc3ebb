// Auxiliary layers of a plane seen by an orthographic camera, where each has a closed form. This is also the only
// test of a pixel's position in the picture.

#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr uint32_t kColumns = 8, kRows = 4;

/// A large square at z = -3, and a camera at z = 2 that looks along -z. A pixel covers one of its 8 x 4 square metres.
RenderResult render_plane(PixelFilter filter, bool whole_plane) {
    Scene scene;
    Mesh square;
    const float right = whole_plane ? 50.0f : 0.0f;
    square.positions = {{-50, -50, -3}, {right, -50, -3}, {right, 50, -3}, {-50, 50, -3}};
    square.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes = {square, square};
    scene.materials = {{{}, "unused"}, {{.base_color = {0.25f, 0.5f, 0.75f}}, "wall"}};
    scene.instances = {{"wall", 1, 1, {}}};
    Camera camera;
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 4;
    camera.world_from_camera = make_translation({0, 0, 2});
    RenderSettings settings;
    settings.width = kColumns;
    settings.height = kRows;
    settings.samples = 1024;
    settings.filter = filter;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.transparent = true;
    Queue queue = Queue::make_cpu();
    return test::render(queue, scene, camera, settings);
}

} // namespace

TEST_CASE("a pixel's samples lie around its centre, with x to the right and y down, for every filter") {
    for (const PixelFilter filter :
         {PixelFilter::Box, PixelFilter::Tent, PixelFilter::Gaussian, PixelFilter::BlackmanHarris}) {
        CAPTURE(static_cast<int>(filter));
        const Image position = render_plane(filter, true).layers.at(3).image;
        for (uint32_t y = 0; y < kRows; ++y) {
            for (uint32_t x = 0; x < kColumns; ++x) {
                CHECK(std::abs(double(position.at(x, y)[0]) - (x + 0.5 - 4)) < 2e-3);
                CHECK(std::abs(double(position.at(x, y)[1]) - (2 - (y + 0.5))) < 2e-3);
                CHECK(position.at(x, y)[2] == doctest::Approx(-3).epsilon(1e-6));
            }
        }
    }
}

TEST_CASE("albedo, normal, depth and ids are those of the first surface") {
    const RenderResult result = render_plane(PixelFilter::Box, true);
    for (uint32_t i = 0; i < kColumns * kRows; ++i) {
        CHECK(result.layers.at(0).image.pixels[3 * i + 2] == 0.75f);
        CHECK(result.layers.at(1).image.pixels[3 * i + 2] == 1.0f); // the normal points towards the camera
        CHECK(result.layers.at(2).image.pixels[i] == doctest::Approx(5).epsilon(1e-6));
        CHECK(result.picture.pixels[4 * i + 3] == 1.0f);
        CHECK(result.ids.at(i).instance == 0);
        CHECK(result.ids.at(i).material == 1);
    }
}

TEST_CASE("in a partly covered pixel alpha is the covered part and depth is the surface's own") {
    const RenderResult result = render_plane(
        PixelFilter::Tent, false); // the square covers x < 0, and the tent filter has a radius of one pixel
    const auto alpha = [&](uint32_t x) { return static_cast<double>(result.picture.at(x, 1)[3]); };
    CHECK(alpha(2) == 1);
    CHECK(alpha(3) == doctest::Approx(0.875).epsilon(3e-3)); // 1 - the tent's integral over [0.5, 1]
    CHECK(alpha(4) == doctest::Approx(0.125).epsilon(2e-2));
    CHECK(alpha(5) == 0);
    CHECK(result.layers.at(2).image.at(4, 1)[0] == doctest::Approx(5).epsilon(1e-6));
    CHECK(result.layers.at(2).image.at(5, 1)[0] == 0);
    CHECK(result.layers.at(0).image.at(3, 1)[1] == doctest::Approx(0.5 * 0.875).epsilon(3e-3));
    CHECK(result.ids.at(kColumns + 6).instance == kNoHit);
}
