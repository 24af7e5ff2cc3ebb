// Irradiance caching against path tracing: the error falls with the number of records and rays at least as fast as
// published and below a bound, and light counts once.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "image/metrics.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/room_with_ball.h"

using namespace pertev;

namespace {

struct CacheCase {
    std::string name;
    Scene scene;
    double bound; // bound of the squared error with the finest records
};

std::vector<CacheCase> cache_cases() {
    const Material wall = test::white(0.6f);
    const Material plastic = test::of_roughness(MaterialKind::MetallicRoughness, 0.4f);
    const Material varnished = test::of_roughness(MaterialKind::MetallicRoughness, 0); // a delta lobe on a diffuse one
    return {{"diffuse", test::room_with_ball(test::white(0.8f), wall, false), 5e-4},
            {"glass", test::room_with_ball(test::of_roughness(MaterialKind::Dielectric, 0), wall, false), 4e-3},
            {"glossy", test::room_with_ball(plastic, plastic, false), 1e-3},
            {"varnish", test::room_with_ball(test::of_roughness(MaterialKind::Conductor, 0), varnished, false), 4e-3}};
}

struct CacheBudget {
    float accuracy;
    uint32_t rays, samples;
    uint32_t size = 24; // pixels per side
};

Image cached_picture(Queue& queue, const PreparedScene& prepared, IntegratorKind integrator, const CacheBudget& budget,
                     uint32_t seed, float filter_radius = RenderSettings{}.filter_radius) {
    RenderSettings settings;
    settings.width = settings.height = budget.size;
    settings.filter = PixelFilter::Box;
    settings.filter_radius = filter_radius;
    settings.path.max_depth = 5;
    settings.path.seed = seed;
    settings.samples = budget.samples;
    settings.integrator = integrator;
    settings.irradiance_cache = {.accuracy = budget.accuracy, .hemisphere_rays = budget.rays};
    return render_picture(queue, prepared, test::room_camera(), settings).picture;
}

} // namespace

TEST_CASE("a sphere in a furnace shows its albedo by irradiance caching") {
    Messages messages;
    const Scene scene = test::make_furnace_scene(0.7f);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Camera camera;
    camera.world_from_camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
    camera.fov_y = 0.1f; // within the sphere
    RenderSettings settings;
    settings.width = settings.height = 8;
    settings.samples = 64;
    settings.integrator = IntegratorKind::IrradianceCache;
    Queue queue = test::requested_queue();
    const Image image = render_picture(queue, prepared, camera, settings).picture;
    for (const float value : image.pixels) CHECK(static_cast<double>(value) == doctest::Approx(0.7).epsilon(0.01));
}

TEST_CASE("irradiance caching converges to path tracing with more and better records") {
    Queue queue = test::requested_queue();
    for (const CacheCase& c : cache_cases()) {
        Messages messages;
        const PreparedScene prepared = prepare_scene(c.scene, {}, messages);
        const Image reference = cached_picture(queue, prepared, IntegratorKind::Path, {.samples = 512}, 9);
        const auto error_of = [&](const CacheBudget& budget, double light_within, uint32_t seeds = 2) {
            double sum = 0;
            for (uint32_t seed = 0; seed < seeds; ++seed) {
                const Image picture = cached_picture(queue, prepared, IntegratorKind::IrradianceCache, budget, seed);
                CHECK(test::mean_of(picture) == doctest::Approx(test::mean_of(reference)).epsilon(light_within));
                sum += relative_error(picture, reference, 1).rel_mse;
            }
            return sum / seeds;
        };
        // Each step takes about four times as long: a record's error is proportional to the accuracy, the number of
        // records to the inverse of its square, and noise falls with rays and samples.
        const double coarse = error_of({1.0f, 16, 16}, 0.05);
        const double middle = error_of({0.5f, 32, 64}, 0.02);
        const double fine = error_of({0.25f, 256, 256}, 0.005, 1);
        CAPTURE(c.name);
        CAPTURE(coarse);
        CAPTURE(middle);
        CAPTURE(fine);
        CHECK(middle < coarse / 2);
        CHECK(fine < middle / 2);
        CHECK(fine < c.bound);
    }
}

namespace {

/// The room with a point light, so that only light between surfaces has noise.
Scene room_under_a_point() {
    Scene scene = test::room_with_ball(test::white(0.8f), test::white(0.6f), true);
    scene.environment.reset();
    test::add(scene, test::sheet({0, 2, 0}, {1, 0, 0}, {0, 0, 1}), test::white(0.6f));
    scene.lights.push_back(test::point_light({0.4f, 1.4f, 0.4f}, {2, 2, 2}));
    return scene;
}

/// Returns a picture with one ray through the centre of each pixel.
Image middles(Queue& queue, const PreparedScene& prepared, IntegratorKind integrator, const CacheBudget& budget,
              uint32_t seed) {
    return cached_picture(queue, prepared, integrator, budget, seed, 0x1p-20f);
}

/// Returns the mean of (a - b) (c - d) divided by that of the squared light. With c = a and independent references b
/// and d it is the squared error of a, whatever their noise.
double relative_product(const Image& a, const Image& b, const Image& c, const Image& d) {
    double sum = 0, light = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const auto of = [&](const Image& image) { return static_cast<double>(image.pixels[i]); };
        sum += (of(a) - of(b)) * (of(c) - of(d));
        light += of(b) * of(d);
    }
    return sum / light;
}

/// Returns the slope of the least-squares line through (log x, log y).
double slope(const std::vector<double>& x, const std::vector<double>& y) {
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double u = std::log(x[i]), v = std::log(y[i]);
        sx += u, sy += v, sxx += u * u, sxy += u * v;
    }
    const auto n = static_cast<double>(x.size());
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

} // namespace

TEST_CASE("the error of irradiance caching falls with the accuracy and the rays at the rates of the literature") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = room_under_a_point();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const Image one = middles(queue, prepared, IntegratorKind::Path, {.samples = 512, .size = 32}, 101);
    const Image other = middles(queue, prepared, IntegratorKind::Path, {.samples = 512, .size = 32}, 102);
    const auto cached = [&](float accuracy, uint32_t rays, uint32_t seed) {
        return middles(queue, prepared, IntegratorKind::IrradianceCache, {accuracy, rays, 1, 32}, seed);
    };
    // By Ward et al. 1988 the error between records is at most proportional to the accuracy, so its square falls with
    // the square.
    const std::vector<double> accuracies = {1, 0.7, 0.5, 0.35, 0.25};
    std::vector<double> errors;
    for (const double accuracy : accuracies) {
        double sum = 0;
        for (uint32_t seed = 0; seed < 2; ++seed) {
            const Image picture = cached(static_cast<float>(accuracy), 2048, seed);
            sum += relative_product(picture, one, picture, other) / 2;
        }
        errors.push_back(sum);
        MESSAGE("accuracy ", accuracy, ": squared error ", sum);
    }
    const double by_accuracy = slope(accuracies, errors);
    CAPTURE(by_accuracy);
    CHECK(by_accuracy > 1.8);
    CHECK(errors.back() < 2e-4);
    // A record's light is a mean over its rays, so its variance is at most proportional to the inverse of their number.
    const std::vector<double> rays = {32, 128, 512};
    std::vector<double> variances;
    for (const double count : rays) {
        double sum = 0;
        for (uint32_t pair = 0; pair < 3; ++pair) {
            const Image a = cached(0.35f, static_cast<uint32_t>(count), 2 * pair);
            const Image b = cached(0.35f, static_cast<uint32_t>(count), 2 * pair + 1);
            sum += relative_product(a, b, a, b) / 2 / 3;
        }
        variances.push_back(sum);
        MESSAGE(count, " rays: variance ", sum);
    }
    const double by_rays = slope(rays, variances);
    CAPTURE(by_rays);
    CHECK(by_rays < -0.9);
    CHECK(variances.back() < 1e-4);
}

namespace {

/// A closed room with a ball of clear glass below a small, bright emitter. Of a thousand rays from the floor a few
/// reach the emitter through the ball.
Scene room_with_caustic() {
    Scene scene = test::room_with_ball(test::of_roughness(MaterialKind::Dielectric, 0), test::white(0.7f), true);
    scene.environment.reset();
    for (Material& material : scene.materials) {
        if (material.kind == MaterialKind::Dielectric) material.base_color = {1, 1, 1};
    }
    test::add(scene, test::sheet({0, 2, 0}, {1, 0, 0}, {0, 0, 1}), test::white(0.7f));
    test::add(scene, test::sheet({0.1f, 1.6f, 0.1f}, {0.06f, 0, 0}, {0, 0, 0.06f}),
              {{.base_color = {0, 0, 0}, .emission = {400, 400, 400}}, "lamp"});
    return scene;
}

/// Returns the median of red in each block of pixels, which a blotch changes but a few bright pixels do not.
std::vector<double> block_medians(const Image& picture, uint32_t side) {
    std::vector<double> medians;
    for (uint32_t top = 0; top + side <= picture.height; top += side) {
        for (uint32_t left = 0; left + side <= picture.width; left += side) {
            std::vector<double> values;
            for (uint32_t i = 0; i < side * side; ++i) {
                values.push_back(static_cast<double>(picture.at(left + i % side, top + i / side)[0]));
            }
            std::nth_element(values.begin(), values.begin() + side * side / 2, values.end());
            medians.push_back(values[side * side / 2]);
        }
    }
    return medians;
}

} // namespace

TEST_CASE("records show no blotches of emitters that later bounces see through glass") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = room_with_caustic();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const auto medians = [&](const CacheBudget& budget, uint32_t seed) {
        return block_medians(cached_picture(queue, prepared, IntegratorKind::IrradianceCache, budget, seed), 8);
    };
    const std::vector<double> reference = medians({0.25f, 4096, 16, 48}, 100);
    double most = 0, least = kInfinity;
    uint32_t lit = 0; // leaves out blocks with an edge of the room, because half of such a block may be empty
    for (uint32_t seed = 0; seed < 3; ++seed) {
        const std::vector<double> found = medians({0.25f, 256, 16, 48}, seed);
        for (std::size_t i = 0; i < found.size(); ++i) {
            if (reference[i] < 0.04) continue;
            ++lit;
            most = std::max(most, found[i] / reference[i]);
            least = std::min(least, found[i] / reference[i]);
        }
    }
    MESSAGE("blocks have ", least, " to ", most, " of the light that many rays find");
    CHECK(lit > 3 * 25);
    CHECK(most < 1.12);
    CHECK(least > 0.88);
}
