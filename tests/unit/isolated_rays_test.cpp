// Ray rates of a mix of ray kinds from the rates of each kind.

#include <doctest/doctest.h>

#include "lab/isolated_rays.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stop_after.h"

using namespace pertev;

TEST_CASE("a mix of rays has the rate of its kinds traced one after the other") {
    const IsolatedRates rates = {.camera = 4, .bounce = 2, .shadow = 8};
    CHECK(rates.of_mix({.camera = 4, .bounce = 4, .shadow = 8}) == 4.0); // 16 rays in 1 + 2 + 1 seconds
    CHECK(rates.of_mix({.camera = 4, .bounce = 0, .shadow = 0}) == 4.0);
    CHECK(rates.of_mix({}) == 0.0);
    CHECK(IsolatedRates{.camera = 4}.of_mix({.camera = 4, .bounce = 1, .shadow = 0}) ==
          0.0); // without a rate there is no mix
}

TEST_CASE("rays of each kind have a rate, and the sink can stop the measurement") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const TracerChoice choice = default_tracers(queue.is_cuda());
    const PreparedScene prepared =
        prepare_scene(scene, {.bvh = {}, .bvh_cache = {}, .tracers = choice, .keep_coordinates = true}, messages);
    test::StopAfter sink;
    const IsolatedRates rates =
        measure_isolated_rays(queue, scene, test::mixed_scene_camera(), prepared, choice, 1000, sink);
    CHECK(rates.camera > 0);
    CHECK(rates.bounce > 0);
    CHECK(rates.shadow > 0);
    CHECK(sink.asked > 5);
    test::StopAfter stops(3);
    CHECK_THROWS_AS(measure_isolated_rays(queue, scene, test::mixed_scene_camera(), prepared, choice, 1000, stops),
                    Error);
}
