// Parts of a session work without a Session and give its bytes. Two sessions run concurrently.

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <thread>

#include <doctest/doctest.h>

#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "image/picture_hash.h"
#include "session/pictures/prepare_render.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stop_after.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

/// A scene that is prepared once.
struct MixedWorld {
    Scene scene = test::make_mixed_scene();
    PreparedScene prepared;
    MixedWorld() {
        Messages messages;
        prepared = prepare_scene(scene, {}, messages);
    }
};

RenderSettings part_settings() {
    RenderSettings settings;
    settings.width = 32, settings.height = 20, settings.samples = 5;
    settings.aovs = kAovAlbedo | kAovNormal | kAovIds;
    return settings;
}

/// The state that the parts of a session share.
struct Parts {
    DeviceScene scene;
    PictureRenderer pictures;
    Parts(Queue& queue, const MixedWorld& world, const RenderSettings& settings) : scene(queue), pictures(scene) {
        scene.set(world.prepared, settings);
    }
};

/// Stops the work after `most` of its steps.
struct EndingSink : Sink {
    explicit EndingSink(int steps) : most(steps) {}
    void progress(const Progress& now) override {
        CHECK(now.share > last);
        last = now.share;
        ++heard;
    }
    bool should_stop() override { return heard >= most; }
    int most;
    std::atomic<int> heard = 0;
    double last = 0;
};

} // namespace

TEST_CASE("frames, the meter and post steps work without a session") {
    const MixedWorld world;
    Queue queue = test::requested_queue();
    RenderSettings settings = part_settings();
    settings.denoise = Denoise::Svgf;
    settings.transparent = true;
    const Camera camera = test::mixed_scene_camera();
    Session session(queue, world.prepared, camera, settings);
    Parts parts(queue, world, settings);
    FrameSequence frames(parts.pictures);
    for (uint32_t number = 0; number < 3; ++number) {
        REQUIRE(session.render_frame(number, {}));
        REQUIRE(frames.render(number, camera, settings, {}, {}));
    }
    CHECK(picture_hash(frames.reconstruction().picture()) == picture_hash(session.frame().picture()));
    CHECK(Meter(parts.pictures).stops(camera, settings, ToneMap::Agx) == session.meter(ToneMap::Agx));
    FilmRender film(parts.pictures, camera, settings);
    CHECK(!film.denoised());
    session.render(3);
    film.render({0, 3});
    const Image denoised = film.denoised().value(), picture = film.picture();
    CHECK(picture_hash(denoised) == picture_hash(session.denoised().value()));
    CHECK(picture_hash(denoised) != picture_hash(picture));
    CHECK(denoised.channels == 4);
    for (std::size_t i = 3; i < denoised.pixels.size(); i += 4) {
        REQUIRE(denoised.pixels[i] == picture.pixels[i]); // the alpha is that of the film
    }
}

TEST_CASE("post steps refuse a film of a window") {
    const MixedWorld world;
    Queue queue = test::requested_queue();
    RenderSettings settings = part_settings();
    settings.denoise = Denoise::Svgf;
    const Camera camera = test::mixed_scene_camera();
    Parts parts(queue, world, settings);
    PostSteps steps(parts.pictures);
    steps.begin(camera, settings, nullptr);
    Integrator& integrator = parts.pictures.begin(camera, settings, 1);
    Film film(queue, settings.width, settings.height, settings.aovs);
    CHECK_NOTHROW(steps.add(integrator, 0, 1, film, nullptr));
    film.set_window({.picture_width = 64, .width = settings.width, .height = settings.height});
    CHECK_THROWS_AS(steps.add(integrator, 1, 1, film, nullptr), std::logic_error);
}

namespace {

/// Returns how many threads run a queue's work at once. Each waits for `wanted` threads and one more, for a limited
/// time.
int most_at_once(const Queue& queue, int wanted) {
    const UseThreads use(queue.threads());
    std::atomic<int> now{0}, most{0};
    parallel_for(16, 1, [&](uint64_t) {
        const int here = ++now;
        for (int seen = most; seen < here && !most.compare_exchange_weak(seen, here);) continue;
        const Stopwatch watch;
        while (most < wanted && watch.seconds() < 5) std::this_thread::yield();
        while (most <= wanted && watch.seconds() < 0.002) std::this_thread::yield();
        --now;
    });
    return most;
}

} // namespace

TEST_CASE("two sessions with different thread counts run at once on two threads, and give the same bytes") {
    const MixedWorld world;
    const RenderSettings settings = part_settings();
    const auto run = [&](int threads, uint32_t repeats, int& most) {
        std::vector<Hash128> hashes;
        Queue queue = Queue::make_cpu(Threads(threads));
        Session session(queue, world.prepared, test::mixed_scene_camera(), settings);
        for (uint32_t repeat = 0; repeat < repeats; ++repeat) {
            session.cut();
            session.render(settings.samples);
            session.render_frame(repeat, {});
            hashes.push_back(picture_hash(session.picture()));
            hashes.push_back(picture_hash(session.frame().picture()));
            most = std::max(most, most_at_once(queue, threads));
        }
        return hashes;
    };
    constexpr uint32_t kRepeats = 6;
    int alone = 0, of_one = 0, of_three = 0;
    const std::vector<Hash128> expected = run(2, kRepeats, alone);
    std::vector<Hash128> by_one, by_three;
    std::thread one([&] { by_one = run(1, kRepeats, of_one); });
    std::thread three([&] { by_three = run(3, kRepeats, of_three); });
    one.join();
    three.join();
    CHECK(by_one == expected);
    CHECK(by_three == expected);
    CHECK(alone == 2);
    CHECK(of_one == 1);
    CHECK(of_three == 3);
}

TEST_CASE("a sink stops the preparation of a picture between its steps") {
    PictureOptions options;
    options.scene.scene = "cornell-box";
    options.machine.device = "cpu";
    options.no_cache = true;
    for (const int step : {0, 1}) { // after reading, and after building trees
        test::StopAfter stops(step);
        const auto error = test::thrown_error([&] { prepare_render(options, kRender, stops, {}); });
        REQUIRE(error.has_value());
        CHECK(error->code() == ErrorCode::Interrupted);
        CHECK(stops.asked == step + 1);
    }
    test::StopAfter never;
    CHECK(prepare_render(options, kRender, never, {})->scene().instances.size() > 1);
}

TEST_CASE("a frame that a sink stops is discarded, and the next one begins a sequence") {
    const MixedWorld world;
    Queue queue = Queue::make_cpu(); // frames on a GPU are not interrupted
    RenderSettings settings = part_settings();
    Session session(queue, world.prepared, test::mixed_scene_camera(), settings);
    Session fresh(queue, world.prepared, test::mixed_scene_camera(), settings);
    REQUIRE(session.render_frame(0, {}));
    test::StopAfter stops(0);
    CHECK(!session.render_frame(1, {}, {}, stops));
    REQUIRE(session.render_frame(2, {}));
    REQUIRE(fresh.render_frame(2, {}));
    CHECK(picture_hash(session.frame().picture()) == picture_hash(fresh.frame().picture()));
}

TEST_CASE("a sink gets a session's progress and stops it at a whole sample") {
    const MixedWorld world;
    Queue queue = test::requested_queue();
    RenderSettings settings = part_settings();
    settings.pass_samples = 1;
    Session session(queue, world.prepared, test::mixed_scene_camera(), settings);
    EndingSink ends(2), never(1000);
    CHECK(session.render(5, ends) == 2);
    CHECK(ends.heard == 2);
    CHECK(session.render(3, never) == 3);
    CHECK(never.last == 1);
    const RenderResult whole = render_picture(queue, world.prepared, test::mixed_scene_camera(), settings);
    CHECK(picture_hash(session.picture()) == picture_hash(whole.picture));
}
