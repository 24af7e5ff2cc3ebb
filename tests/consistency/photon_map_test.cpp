// The one-picture law for photon mapping: the bytes are the same for any number of threads, any split of the passes,
// either schedule, any number of subpaths in flight, and any structure for photons. With --device cuda the GPU
// renders, too.

#include <doctest/doctest.h>

#include <utility>

#include "integrators/photon_map/photon_map_settings.h"
#include "session/session.h"
#include "tests/support/check_one_picture.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/room_with_ball.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

RenderSettings photon_settings(PhotonGather gather = PhotonGather::Final, uint32_t nearest = 0) {
    RenderSettings settings;
    settings.width = 37; // not a multiple of a tile
    settings.height = 21;
    settings.samples = 4;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.transparent = true;
    settings.integrator = IntegratorKind::PhotonMap;
    settings.path.max_depth = 6;
    settings.photon_map = {.photons = 3000, .radius = 0.3f, .nearest = nearest, .gather = gather};
    return settings;
}

} // namespace

TEST_CASE(
    "pictures by photon mapping do not depend on threads, passes, schedules, photons in flight or the structure") {
    for (const auto& [gather, nearest] : {std::pair(PhotonGather::Final, 0u), std::pair(PhotonGather::Direct, 0u),
                                          std::pair(PhotonGather::Direct, 20u)}) {
        CAPTURE(static_cast<int>(gather));
        CAPTURE(nearest);
        const Scene scene = test::make_mixed_scene();
        RenderSettings settings = photon_settings(gather, nearest);
        const test::CheckedPicture reference = test::check_one_picture(scene, settings);
        CHECK(reference.rays.bounce > 4 * 6000);
        CHECK(reference.rays.shadow > 37 * 21);

        Queue queue = Queue::make_cpu();
        settings.pass_samples = 3;
        for (const PhotonSearch search : {PhotonSearch::KdTree, PhotonSearch::Octree, PhotonSearch::Grid}) {
            settings.photon_map.edit().search = search;
            test::check_same(test::checked_picture(queue, scene, settings), reference);
            if (!test::cuda_requested()) continue;
            Queue gpu = test::make_cuda_queue();
            test::check_same(test::checked_picture(gpu, scene, settings), reference);
        }
    }
}

TEST_CASE("pictures with dense photons do not depend on threads, passes, schedules or the search structure") {
    Queue queue = Queue::make_cpu();
    for (const Material& ball : {test::white(0.6f), test::of_roughness(MaterialKind::Dielectric, 0)}) {
        const Scene scene = test::room_with_ball(ball, test::white(0.6f), false);
        for (const auto& [gather, nearest] : {std::pair(PhotonGather::Final, 0u), std::pair(PhotonGather::Direct, 0u),
                                              std::pair(PhotonGather::Direct, 20u)}) {
            CAPTURE(static_cast<int>(gather));
            CAPTURE(nearest);
            RenderSettings settings = photon_settings(gather, nearest);
            settings.samples = 2;
            settings.photon_map.edit().photons = 12000;
            settings.photon_map.edit().radius = 2; // all photons are in a few buckets
            const test::CheckedPicture reference = test::check_one_picture(scene, settings);
            for (const PhotonSearch search : {PhotonSearch::KdTree, PhotonSearch::Octree}) {
                settings.photon_map.edit().search = search;
                test::check_same(test::checked_picture(queue, scene, settings), reference);
            }
        }
    }
}

TEST_CASE("photon mapping has path tracing's first-surface layers and visible emission") {
    Queue queue = test::requested_queue();
    const auto layers_of = [&](IntegratorKind integrator) {
        RenderSettings settings = photon_settings();
        settings.integrator = integrator;
        settings.samples = 2;
        return test::hash_of_layers(queue, test::make_mixed_scene(), settings);
    };
    CHECK(layers_of(IntegratorKind::PhotonMap) == layers_of(IntegratorKind::Path));
    RenderSettings settings = photon_settings();
    settings.path.max_depth = 0;
    const Hash128 seen = test::checked_picture(queue, test::make_mixed_scene(), settings).hash;
    settings.integrator = IntegratorKind::Path;
    CHECK(test::checked_picture(queue, test::make_mixed_scene(), settings).hash == seen);
}

TEST_CASE("a session that switches to photon mapping and back renders complete pictures") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = photon_settings();
    settings.samples = 3;
    settings.pass_samples = 1;
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        Session session(queue, prepared, test::camera_with_lens(), settings);
        for (const auto& [integrator, photons] :
             {std::pair(IntegratorKind::PhotonMap, 2000u), std::pair(IntegratorKind::Path, 2000u),
              std::pair(IntegratorKind::PhotonMap, 500u), std::pair(IntegratorKind::PhotonMap, 4000u)}) {
            settings.integrator = integrator;
            settings.photon_map.edit().photons = photons; // with less memory, and with more
            test::check_goes_on(session, queue, scene, settings);
        }
    }
}

TEST_CASE("memory of photon mapping equals its prediction") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const PhotonSearch search : {PhotonSearch::Grid, PhotonSearch::KdTree, PhotonSearch::Octree}) {
        for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
            for (const auto& [gather, nearest] :
                 {std::pair(PhotonGather::Final, 10u), std::pair(PhotonGather::Direct, 0u)}) {
                RenderSettings settings = photon_settings(gather, nearest);
                settings.body = body;
                settings.photon_map.edit().search = search;
                test::check_predicted_bytes(prepared, settings, true);
            }
        }
    }
}
