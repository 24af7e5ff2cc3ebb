// The rasteriser: coverage, depth and shading of samples.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/parallel_for.h"
#include "integrators/raster/raster_settings.h"
#include "render/raster/scan_row.h"
#include "session/check_integrator.h"
#include "session/session.h"
#include "session/session_bytes.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

RenderSettings raster_settings(uint32_t width, uint32_t height) {
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.samples = 1;
    settings.integrator = IntegratorKind::Raster;
    return settings;
}

Pinhole pinhole(const Camera& camera, uint32_t width, uint32_t height) {
    return make_pinhole(make_camera_rays(camera, {PixelFilter::Box, 0.5f, nullptr}, width, height, {0, 0, 0}));
}

/// Returns how often each pixel's sample is drawn by triangles of `mesh`.
std::vector<int> times_drawn(const Mesh& mesh, const Pinhole& camera, SamplePosition position) {
    std::vector<int> times(camera.width * camera.height);
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        PinholePoint corners[3];
        for (std::size_t k = 0; k < 3; ++k) corners[k] = camera.see(to_double(mesh.positions[mesh.indices[i + k]]));
        ProjectedTriangle t;
        if (!project_triangle(camera, corners, t)) continue;
        const PixelSpan rows = rows_of(t, position, camera.height);
        for (int32_t y = rows.first; y <= rows.last; ++y) {
            for (int k = 1; k + 1 < t.count; ++k) {
                const PixelSpan span = span_of(t, k, y, position, camera.width);
                for (int32_t x = span.first; x <= span.last; ++x) {
                    ++times[static_cast<std::size_t>(y) * camera.width + static_cast<std::size_t>(x)];
                }
            }
        }
    }
    return times;
}

/// A mesh without holes or folds in the plane z = 0: n x n cells between (-size, -size) and (size, size), with
/// displaced vertices, either diagonal and either winding.
Mesh crooked_grid(uint32_t n, float size, uint32_t seed) {
    test::Random random(seed);
    Mesh mesh;
    const float cell = 2 * size / static_cast<float>(n);
    for (uint32_t j = 0; j <= n; ++j) {
        for (uint32_t i = 0; i <= n; ++i) {
            const auto moved = [&](uint32_t k) {
                const float off = k == 0 || k == n ? 0.0f : random.within(-0.24f, 0.24f);
                return -size + cell * (static_cast<float>(k) + off);
            };
            const float x = moved(i);
            mesh.positions.push_back({x, moved(j), 0});
        }
    }
    for (uint32_t j = 0; j < n; ++j) {
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            if (random.below(2) == 0) {
                mesh.indices.insert(mesh.indices.end(), {a, b, c, b, c, d});
            } else {
                mesh.indices.insert(mesh.indices.end(), {a, d, b, c, a, d});
            }
        }
    }
    return mesh;
}

Camera raster_camera(Vec3 eye, Vec3 target, Vec3 up = {0, 1, 0}) {
    Camera camera;
    camera.world_from_camera = look_at(eye, target, up);
    return camera;
}

Vec3 pixel_of(const Image& image, uint32_t x, uint32_t y) {
    const float* p = &image.pixels[(std::size_t(y) * image.width + x) * 3];
    return {p[0], p[1], p[2]};
}

} // namespace

TEST_CASE("triangles with shared edges cover each sample once") {
    for (const uint32_t n : {3u, 40u, 300u}) { // cells cover many pixels, or less than one
        const Mesh grid = crooked_grid(n, 2, n);
        // The views are perpendicular, oblique, and one in which the mesh crosses the picture's edges and the camera's
        // plane.
        for (const Camera& camera :
             {raster_camera({0, 0, 3}, {0, 0, 0}), raster_camera({0.3f, 0.2f, 0.4f}, {0.5f, 0.7f, 0}),
              raster_camera({0.1f, 0.2f, 0.05f}, {0.1f, 1, 0}, {0, 0, 1})}) {
            const Pinhole seen = pinhole(camera, 211, 173);
            const SamplePosition middle = {kSubpixels / 2, kSubpixels / 2};
            const std::vector<int> times = times_drawn(grid, seen, middle);
            const std::vector<int> outline = times_drawn(test::sheet({0, 0, 0}, {2, 0, 0}, {0, 2, 0}), seen, middle);
            CHECK(times == outline);
            CHECK(*std::max_element(times.begin(), times.end()) == 1);
        }
    }
}

TEST_CASE("a sample on an edge belongs to the triangle to its right or below it") {
    const Camera flat = [] {
        Camera camera;
        camera.projection = Projection::Orthographic;
        camera.ortho_height = 4; // four pixels, each one metre wide
        camera.world_from_camera = look_at({0, 0, 1}, {0, 0, 0}, {0, 1, 0});
        return camera;
    }();
    const Pinhole seen = pinhole(flat, 4, 4);
    // Samples lie on its edges. The triangle covers those on its upper and left edge only.
    const std::vector<int> times =
        times_drawn(test::sheet({0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}), seen, {kSubpixels / 2, kSubpixels / 2});
    std::vector<int> expected(16);
    expected[1 * 4 + 1] = 1;
    CHECK(times == expected);
}

TEST_CASE("coverage and depth equal those of rays through a million pixels") {
    const Scene scene = test::make_mixed_scene();
    Queue queue = test::requested_queue();
    RenderSettings settings = raster_settings(1000, 1000);
    settings.aovs = kAovDepth | kAovIds;
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0x1p-20f;
    settings.path.max_depth = 0;
    const RenderResult raster = test::render(queue, scene, test::mixed_scene_camera(), settings);
    settings.integrator = IntegratorKind::Path;
    const RenderResult path = test::render(queue, scene, test::mixed_scene_camera(), settings);
    const auto& depths = raster.layers.front().image.pixels;
    const auto& path_depths = path.layers.front().image.pixels;
    uint32_t others = 0, compared = 0, elsewhere = 0;
    double worst = 0;
    for (std::size_t i = 0; i < 1000000; ++i) {
        const bool same =
            raster.ids[i].instance == path.ids[i].instance && raster.ids[i].material == path.ids[i].material;
        others += same ? 0 : 1;
        if (!same || path.ids[i].instance == kNoHit) continue;
        const double off = double(std::abs(depths[i] - path_depths[i])) / double(path_depths[i]);
        ++compared;
        elsewhere += off > 1e-3 ? 1 : 0; // the other triangle belongs to the same instance
        if (raster.ids[i].primitive == path.ids[i].primitive) worst = std::max(worst, off);
    }
    // Corners are rounded to 1/256 of a pixel, so a sample that near to an outline may be in or out.
    CHECK(others < 1000);
    CHECK(compared > 400000);
    CHECK(elsewhere < 100);
    CHECK(worst < 1e-4);
}

TEST_CASE("light is evaluated per pixel, corner or triangle and matches the formula") {
    Scene scene;
    test::add(scene, test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), test::white(0.5f)); // faces +z
    scene.lights.push_back(test::point_light({0, 0, 1}, {3, 2, 1}));
    Queue queue = test::requested_queue();
    RenderSettings settings = raster_settings(65, 65);
    settings.ambient = Rgb{0.25f, 0, 0};
    Camera camera = raster_camera({0, 0, 2}, {0, 0, 0});
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 2;
    const auto middle = [&](RasterShading shading) {
        settings.display.edit().shading = shading;
        return pixel_of(test::render(queue, scene, camera, settings).picture, 32, 32);
    };
    // The formula is albedo / pi I cos / d^2 + albedo ambient, at the centre, at corners (d^2 = 3) and at a triangle's
    // centre.
    const auto expected = [](double square) {
        const double lit = 0.5 / 3.14159265 / (square * std::sqrt(square));
        return Vec3{static_cast<float>(3 * lit + 0.125), static_cast<float>(2 * lit), static_cast<float>(lit)};
    };
    const auto check = [](Vec3 a, Vec3 b) {
        CHECK(a.x == doctest::Approx(b.x).epsilon(1e-4));
        CHECK(a.y == doctest::Approx(b.y).epsilon(1e-4));
        CHECK(a.z == doctest::Approx(b.z).epsilon(1e-4));
    };
    check(middle(RasterShading::Phong), expected(1));
    check(middle(RasterShading::Gouraud), expected(3));
    check(middle(RasterShading::Flat), expected(1 + 2.0 / 9));
    settings.path.max_depth = 0;
    check(middle(RasterShading::Phong), {0, 0, 0});
}

TEST_CASE("without shadows raster shades as cast does, with all lobes, textures and interpolated normals") {
    Scene scene = test::make_furnace_scene(0.7f); // a smooth sphere
    scene.environment.reset();
    scene.materials.front().kind = MaterialKind::MetallicRoughness;
    scene.materials.front().roughness = 0.4f;
    scene.lights.push_back(test::point_light({3, 4, 5}, {90, 80, 70}));
    Queue queue = test::requested_queue();
    RenderSettings settings = raster_settings(60, 60);
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0x1p-20f;
    const Camera camera = raster_camera({1, 1, 4}, {0, 0, 0});
    const Image raster = test::render(queue, scene, camera, settings).picture;
    settings.integrator = IntegratorKind::Cast;
    const Image cast = test::render(queue, scene, camera, settings).picture;
    uint32_t alike = 0, lit = 0;
    for (std::size_t i = 0; i < cast.pixels.size(); ++i) {
        if (!(cast.pixels[i] > 0)) continue; // it shadows itself
        ++lit;
        alike += std::abs(raster.pixels[i] - cast.pixels[i]) <= 1e-3f * cast.pixels[i] ? 1 : 0;
    }
    CHECK(lit > 1000);
    CHECK(alike >= lit - lit / 50); // samples at edges may show another triangle
}

TEST_CASE("edges are Bresenham's lines, and the nearer one is visible") {
    Scene scene;
    Mesh triangle; // a triangle with the pixels (2, 2), (12, 2) and (2, 6) of a picture 16 pixels wide, and one behind
                   // it
    triangle.positions = {{-5.5f, 5.5f, 0}, {4.5f, 5.5f, 0}, {-5.5f, 1.5f, 0}};
    triangle.indices = {0, 1, 2};
    test::add(scene, triangle, {{.base_color = {1, 0, 0}}, "red"});
    for (Vec3& p : triangle.positions) p.z = -1;
    test::add(scene, triangle, {{.base_color = {0, 1, 0}}, "green"});
    Queue queue = test::requested_queue();
    RenderSettings settings = raster_settings(16, 16);
    settings.display.edit().is_wireframe = true;
    settings.ambient = Rgb{0, 0, 0};
    Camera camera = raster_camera({0, 0, 2}, {0, 0, 0});
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 16;
    const Image image = test::render(queue, scene, camera, settings).picture;
    std::vector<bool> expected(256);
    for (uint32_t x = 2; x <= 12; ++x) expected[2 * 16 + x] = true;
    for (uint32_t y = 2; y <= 6; ++y) expected[y * 16 + 2] = true;
    for (uint32_t x = 2; x <= 12; ++x) { // on the slanted edge, each column has the row nearest to the line
        expected[static_cast<uint32_t>(std::lround(6 - 0.4 * (x - 2.0))) * 16 + x] = true;
    }
    for (uint32_t i = 0; i < 256; ++i) {
        CAPTURE(i);
        const Vec3 pixel = pixel_of(image, i % 16, i / 16);
        CHECK((pixel.x > 0) == expected[i]);
        CHECK(pixel.y == 0); // the green one is behind
    }
}

TEST_CASE("a pixel's samples cover its filter evenly, the first is at the centre, and the picture is their mean") {
    Scene scene;
    test::add(scene, test::sheet({-1, 0, 0}, {1, 0, 0}, {0, 9, 0}), {{.emission = {1, 1, 1}}, "lamp"});
    Queue queue = test::requested_queue();
    RenderSettings settings = raster_settings(1, 1);
    settings.ambient = Rgb{0, 0, 0};
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0.5f;
    Camera camera = raster_camera({0.2f, 0, 2}, {0.2f, 0, 0}); // it covers 0.3 of the pixel
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 1;
    CHECK(pixel_of(test::render(queue, scene, camera, settings).picture, 0, 0).x == 0);
    settings.samples = 256;
    const float covered = pixel_of(test::render(queue, scene, camera, settings).picture, 0, 0).x;
    CHECK(covered == doctest::Approx(0.3).epsilon(0.02));
}

TEST_CASE("raster refuses lenses and scenes that it would render black, and its memory equals its prediction") {
    Scene scene = test::make_furnace_scene(0.5f);
    Camera camera;
    camera.aperture_radius = 0.1f;
    Queue queue = test::requested_queue();
    const RenderSettings settings = raster_settings(40, 30);
    const auto error = test::thrown_error([&] { test::render(queue, scene, camera, settings); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "integrator", "raster"));
    scene.environment.reset();
    REQUIRE(why_dark(settings, scene));
    CHECK(why_dark(settings, scene)->value == "raster");
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Session session(queue, prepared, {}, settings);
    session.render(1);
    const std::size_t predicted = predicted_bytes(prepared, settings, queue.is_cuda());
    CHECK(queue.allocated_bytes() >= predicted);
    CHECK(queue.allocated_bytes() <= predicted + 4096); // the filter's table, the scene's view
}

TEST_CASE("rasterised pictures do not depend on threads or passes, and layers describe the first surface") {
    const Scene scene = test::make_mixed_scene(); // cut-outs, blended sheets, hidden backs, instances
    RenderSettings settings = raster_settings(67, 45);
    settings.samples = 3;
    settings.aovs = kAovAlbedo | kAovNormal | kAovIds;
    for (const bool wireframe : {false, true}) {
        for (const RasterShading shading : {RasterShading::Flat, RasterShading::Gouraud, RasterShading::Phong}) {
            settings.display = {shading, wireframe};
            settings.pass_samples = 0;
            Queue queue = Queue::make_cpu();
            const RenderResult one = test::render(queue, scene, test::mixed_scene_camera(), settings);
            CHECK(one.invalid_samples == 0);
            CHECK(test::mean_of(one.picture) > 0);
            for (const int threads : {1, 5}) {
                Queue few = Queue::make_cpu(Threads(threads));
                settings.pass_samples = threads == 1 ? 2 : 1;
                CHECK(test::render_hash(test::render(few, scene, test::mixed_scene_camera(), settings)) ==
                      test::render_hash(one));
            }
            if (!test::cuda_requested()) continue;
            Queue gpu = test::make_cuda_queue();
            CHECK(test::render_hash(test::render(gpu, scene, test::mixed_scene_camera(), settings)) ==
                  test::render_hash(one));
        }
    }
}
