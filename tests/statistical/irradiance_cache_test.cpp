// Irradiance caching against path tracing: the error that records leave falls with the number of records and of their
// rays, to a stated bound, and no light is missing or counted twice.

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "image/metrics.h"
#include "tests/support/options.h"
#include "tests/support/room_with_ball.h"

using namespace pertev;

namespace {

struct CacheCase {
    std::string name;
    Scene scene;
    double bound; // of the squared error with the finest records
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
};

Image cached_picture(Queue& queue, const PreparedScene& prepared, IntegratorKind integrator, const CacheBudget& budget,
                     uint32_t seed) {
    RenderSettings settings;
    settings.width = settings.height = 32;
    settings.filter = PixelFilter::Box;
    settings.path.max_depth = 5;
    settings.path.seed = seed;
    settings.samples = budget.samples;
    settings.integrator = integrator;
    settings.irradiance_cache = {.accuracy = budget.accuracy, .hemisphere_rays = budget.rays};
    return render_picture(queue, prepared, test::room_camera(), settings).picture;
}

} // namespace

TEST_CASE("irradiance caching comes to path tracing's picture as records become more and better") {
    Queue queue = test::queue_asked_for();
    for (const CacheCase& c : cache_cases()) {
        Messages messages;
        const PreparedScene prepared = prepare_scene(c.scene, {}, messages);
        const Image reference = cached_picture(queue, prepared, IntegratorKind::Path, {.samples = 1024}, 9);
        const auto error_of = [&](const CacheBudget& budget, double light_within, uint32_t seeds = 2) {
            double sum = 0;
            for (uint32_t seed = 0; seed < seeds; ++seed) {
                const Image picture = cached_picture(queue, prepared, IntegratorKind::IrradianceCache, budget, seed);
                CHECK(test::mean_of(picture) == doctest::Approx(test::mean_of(reference)).epsilon(light_within));
                sum += relative_error(picture, reference, 1).rel_mse;
            }
            return sum / seeds;
        };
        // Each takes about four times as long: a record's error is proportional to the accuracy, the number of records
        // to its square, and noise falls with rays and samples.
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
