// Radiosity against closed forms and path tracing: its error falls with the patch size and below a bound.

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "integrators/radiosity/radiosity_display_settings.h"
#include "session/opening/open_scene.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/radiosity_scenes.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

RadiosityDisplay solved(const PreparedScene& prepared, const RadiositySettings& settings) {
    return {std::make_shared<const RadiositySolution>(solve_radiosity(prepared, settings).solution), false};
}

Image shown_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera, RenderSettings settings,
                    const RadiosityDisplay& display) {
    settings.integrator = IntegratorKind::Radiosity;
    settings.radiosity = display;
    return render_picture(queue, prepared, camera, settings).picture;
}

/// The mean difference relative to the mean, without the emitter's pixels, which are far brighter than all others and
/// independent of patches.
double mean_difference(const Image& a, const Image& b) {
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const auto x = static_cast<double>(a.pixels[i]), y = static_cast<double>(b.pixels[i]);
        if (y > 2) continue;
        sum += std::abs(x - y), all += y;
    }
    return sum / all;
}

} // namespace

TEST_CASE("a closed box that emits E and reflects r has radiosity E / (1 - r) everywhere") {
    Messages messages;
    const float reflectance = 0.6f, radiance = 2;
    const Scene scene = test::closed_box(test::emitter_material(reflectance, radiance));
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const double known = std::numbers::pi * static_cast<double>(radiance) / (1 - static_cast<double>(reflectance));
    for (const FormFactors method : {FormFactors::Rays, FormFactors::Hemicube}) {
        for (const RadiositySolver solver :
             {RadiositySolver::Southwell, RadiositySolver::GaussSeidel, RadiositySolver::Matrix}) {
            RadiositySettings settings;
            settings.patch_size = 0.8f;
            settings.rays = 64;
            settings.hemicube = 32;
            settings.tolerance = 1e-6f;
            settings.form_factors = method;
            settings.solver = solver;
            const RadiositySolution solution = solve_radiosity(prepared, settings).solution;
            const RadiosityView view = solution.view();
            for (uint32_t triangle = 0; triangle < 12; ++triangle) {
                const Rgb inside = view.irradiance(2 * triangle, 0.3f, 0.2f);
                const auto received = static_cast<double>(inside.g); // light from all other patches
                CHECK(received == doctest::Approx(known).epsilon(2e-4));
            }
        }
    }
}

TEST_CASE("an unfinished solution of a closed box has mean radiosity E / (1 - r), subdivided or not") {
    Messages messages;
    const float reflectance = 0.6f, radiance = 2;
    const Scene scene = test::closed_box(test::emitter_material(reflectance, radiance));
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const double known = std::numbers::pi * static_cast<double>(radiance) / (1 - static_cast<double>(reflectance));
    for (const uint32_t steps : {1u, 12u, 48u, 400u}) {
        for (const uint32_t subdivisions : {0u, 1u, 2u}) {
            RadiositySettings settings;
            settings.patch_size = 0.8f;
            settings.rays = 256;
            settings.solver = RadiositySolver::Southwell;
            settings.steps = steps;
            settings.subdivisions = subdivisions;
            settings.contrast = 0.02f;
            const SolvedRadiosity solved = solve_radiosity(prepared, settings);
            CHECK(solved.stats.left > 0.01);
            if (subdivisions > 0 && steps > 1) CHECK(solved.stats.shown > solved.stats.patches);
            double sum = 0;
            constexpr int kPlaces = 64;
            for (uint32_t triangle = 0; triangle < 12; ++triangle) {
                for (int i = 0; i < kPlaces; ++i) {
                    const Vec2 at = sample_uniform_triangle(
                        {(static_cast<float>(i % 8) + 0.5f) / 8, (static_cast<float>(i / 8) + 0.5f) / 8});
                    sum += static_cast<double>(solved.solution.view().irradiance(2 * triangle, at.x, at.y).g);
                }
            }
            CAPTURE(steps);
            CAPTURE(subdivisions);
            CHECK(sum / (12 * kPlaces) == doctest::Approx(known).epsilon(0.01));
        }
    }
}

TEST_CASE("every row solver refuses a closed box that reflects all light") {
    Messages messages;
    for (const RadiositySolver solver :
         {RadiositySolver::Southwell, RadiositySolver::GaussSeidel, RadiositySolver::Matrix}) {
        RadiositySettings settings;
        settings.patch_size = 1.5f;
        settings.rays = 64;
        settings.solver = solver;
        const auto solve = [&](const Scene& scene) {
            const PreparedScene prepared = prepare_scene(scene, {}, messages);
            return solve_radiosity(prepared, settings);
        };
        const Scene box = test::closed_box(test::emitter_material(1, 1));
        CHECK(test::is_about(test::thrown_error([&] { solve(box); }), ErrorCode::BadInput, "scene"));
        Scene open = box;
        open.instances.pop_back(); // a wall
        CHECK(solve(open).stats.left < 1e-3);
    }
}

TEST_CASE("a sphere in a furnace has the irradiance pi times the furnace's radiance and shows its albedo") {
    Messages messages;
    const Scene scene = test::make_furnace_scene(0.7f);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const FormFactors method : {FormFactors::Rays, FormFactors::Hemicube}) {
        RadiositySettings settings;
        settings.patch_size = 0.7f;
        settings.rays = method == FormFactors::Rays ? 64 : 4096; // hemicubes need a quarter as many for the sky
        settings.hemicube = 8;
        settings.form_factors = method;
        settings.subdivisions = 0;
        const RadiosityDisplay display = solved(prepared, settings);
        Camera camera;
        camera.world_from_camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
        camera.fov_y = 0.1f; // within the sphere
        RenderSettings picture;
        picture.width = picture.height = 8;
        picture.samples = 4;
        Queue queue = test::requested_queue();
        const Image image = shown_picture(queue, prepared, camera, picture, display);
        for (const float value : image.pixels) CHECK(static_cast<double>(value) == doctest::Approx(0.7).epsilon(0.01));
    }
}

TEST_CASE("radiosity converges to path tracing in the Cornell box as patches shrink") {
    Messages messages;
    const Scene scene = open_scene("cornell-box", messages);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    RenderSettings picture;
    picture.width = picture.height = 10; // each pixel is a mean over an area of the smallest patches' size
    picture.filter = PixelFilter::Box;
    picture.path.max_depth = 32;
    picture.samples = 4096;
    const Camera camera = scene.cameras.front();
    const Image reference = render_picture(queue, prepared, camera, picture).picture;
    picture.samples = 64;
    const auto error_by = [&](float patch_of_scene, uint32_t rays, uint32_t subdivisions) {
        RadiositySettings settings;
        settings.patch_size = patch_of_scene * max_component(bounds_of(scene).size());
        settings.rays = rays;
        settings.subdivisions = subdivisions;
        return mean_difference(shown_picture(queue, prepared, camera, picture, solved(prepared, settings)), reference);
    };
    // If there are fewer patches, each gets more rays, so that noise does not hide the error of their size.
    const double errors[] = {error_by(1.0f / 2, 1024, 0), error_by(1.0f / 4, 512, 0), error_by(1.0f / 8, 256, 0),
                             error_by(1.0f / 16, 128, 0)};
    CAPTURE(errors[0]);
    CAPTURE(errors[1]);
    CAPTURE(errors[2]);
    CAPTURE(errors[3]);
    for (int i = 1; i < 4; ++i) CHECK(errors[i] < 0.8 * errors[i - 1]);
    // The slope of log error over log size, by least squares over four halvings of the size.
    double slope = 0;
    for (int i = 0; i < 4; ++i) slope -= (i - 1.5) * std::log2(errors[i]) / 5;
    CAPTURE(slope);
    CHECK(slope > 1);
    CHECK(errors[3] < 0.02);
    const double divided = error_by(1.0f / 8, 256, 1);
    CAPTURE(divided);
    CHECK(divided < 0.02);
}
