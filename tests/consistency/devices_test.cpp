// Several devices render a picture together: whatever they are, however slices fall and whichever of them fails, the
// film has the bytes of one device's. In CI all of them are CPUs; with --device cuda they are the machine's GPUs, and
// CPUs if there are too few.

#include <doctest/doctest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "base/stopwatch.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "render/light_paths/light_path_layers.h"
#include "session/devices/render_on_devices.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stop_after.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

constexpr uint32_t kSharedSamples = 12;

/// A scene that is prepared once, with an emitter too bright for a film, so that there are invalid samples.
struct SharedWorld {
    Scene scene = test::make_mixed_scene();
    PreparedScene prepared;
    SharedWorld() {
        scene.materials[5].emission = grey(0x1p41f);
        Messages messages;
        prepared = prepare_scene(scene, {}, messages);
    }
};

const SharedWorld& shared_world() {
    static const SharedWorld made;
    return made;
}

RenderSettings shared_settings(IntegratorKind kind = IntegratorKind::Path) {
    RenderSettings settings;
    settings.integrator = kind;
    settings.width = 21, settings.height = 13, settings.samples = kSharedSamples;
    settings.pass_samples = 1; // one sample a slice
    settings.path.max_depth = 5;
    settings.photon_map = {.photons = 3000, .radius = 0.3f};
    settings.irradiance_cache = {.accuracy = 0.4f, .hemisphere_rays = 48};
    return settings;
}

/// Settings of all that a film may hold.
RenderSettings shared_layers(LayersAt at) {
    RenderSettings settings = shared_settings();
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.layers_at = at;
    settings.light_paths = std::make_shared<const LightPathLayers>(bind_to_scene(
        {parse_light_path("sky=L<'environment'>.*E"), parse_light_path("once=L.E")}, shared_world().scene));
    return settings;
}

Queue queue_number(std::size_t i) {
    if (test::cuda_requested() && static_cast<int>(i) < cuda_device_count())
        return Queue::make_cuda(static_cast<int>(i));
    return Queue::make_cpu(Threads(1));
}

std::vector<std::vector<std::byte>> bytes_in_film(const Film& film) {
    std::vector<std::vector<std::byte>> all;
    for (const auto& target : film.targets()) all.push_back(target->bytes());
    return all;
}

/// A picture by one device or several.
class SharedCopy {
public:
    SharedCopy(std::size_t devices, const RenderSettings& settings, const DeviceHooks& hooks = {}) {
        for (std::size_t i = 0; i < devices; ++i) queues.push_back(std::make_shared<Queue>(queue_number(i)));
        if (devices > 1) together.emplace(queues, shared_world().prepared, hooks);
        session.emplace(*queues.front(), shared_world().prepared, test::mixed_scene_camera(), settings);
        if (together) session->pictures().share(*together);
    }
    uint32_t render(SampleRange range = {0, kSharedSamples}) { return session->render(range, messages); }
    std::size_t warnings() const {
        return static_cast<std::size_t>(std::ranges::count(messages.all(), true, &Message::is_warning));
    }

    std::vector<std::shared_ptr<Queue>> queues;
    std::optional<RenderOnDevices> together;
    std::optional<Session> session;
    Messages messages;
};

/// The picture of one device.
struct OneDevice {
    std::vector<std::vector<std::byte>> bytes;
    RayCounts rays;
    explicit OneDevice(const RenderSettings& settings, SampleRange range = {0, kSharedSamples}) {
        SharedCopy picture(1, settings);
        CHECK(picture.render(range) == range.count());
        bytes = bytes_in_film(picture.session->film());
        rays = picture.session->rays();
    }
};

void check_shared(SharedCopy& picture, const OneDevice& alone) {
    CHECK(bytes_in_film(picture.session->film()) == alone.bytes);
    CHECK(picture.session->rays().total() == alone.rays.total());
}

/// Lets devices wait until all of them have begun.
struct Begun {
    void wait_for(std::size_t devices) {
        ++count;
        const Stopwatch watch;
        while (count < devices && watch.seconds() < 20) std::this_thread::yield();
    }
    std::atomic<std::size_t> count = 0;
};

/// Lets devices begin together, so that each takes part, and one of them throw after some slices while the others wait.
struct FailingDevice {
    FailingDevice(std::size_t devices, std::size_t device, int slices, ErrorCode code, double fold_s = kFoldSeconds) {
        hooks.fold_s = fold_s;
        hooks.before_samples = [=, this](std::size_t number) {
            begun.wait_for(devices);
            if (number == device && slices == 0) fail(code);
        };
        hooks.after_slice = [=, this](std::size_t number, SampleRange slice) {
            if (number == device && !has_failed) {
                lost = slice;
                if (--left == 0) fail(code);
            }
            const Stopwatch watch;
            while (number != device && !has_failed && watch.seconds() < 20) std::this_thread::yield();
        };
        left = slices;
    }
    [[noreturn]] void fail(ErrorCode code) {
        has_failed = true;
        throw Error(code, "a test ends this device");
    }

    DeviceHooks hooks;
    Begun begun;
    std::atomic<bool> has_failed = false;
    int left = 0;
    SampleRange lost;
};

} // namespace

TEST_CASE("one, two and three devices render the bytes of one, by integrators with and without state") {
    for (const IntegratorKind kind :
         {IntegratorKind::Path, IntegratorKind::Hybrid, IntegratorKind::Whitted, IntegratorKind::Light,
          IntegratorKind::Bidirectional, IntegratorKind::PhotonMap, IntegratorKind::IrradianceCache}) {
        CAPTURE(static_cast<int>(kind));
        const RenderSettings settings = shared_settings(kind);
        const OneDevice alone(settings);
        for (const std::size_t devices : {1u, 2u, 3u}) {
            Begun begun;
            std::atomic<uint32_t> takes[3] = {};
            DeviceHooks hooks;
            hooks.before_samples = [&](std::size_t) { begun.wait_for(devices); };
            hooks.after_slice = [&](std::size_t number, SampleRange) {
                ++takes[number];
                const Stopwatch watch; // until each has taken a slice
                const auto all_have = [&] {
                    return std::all_of(takes, takes + devices, [](auto& n) { return n > 0; });
                };
                while (!all_have() && watch.seconds() < 20) std::this_thread::yield();
            };
            SharedCopy picture(devices, settings, hooks);
            CHECK(picture.render() == kSharedSamples);
            check_shared(picture, alone);
            CHECK(picture.warnings() == 0);
            if (devices > 1) CHECK(takes[devices - 1] > 0);
        }
    }
}

TEST_CASE("the scene is copied from the caller's device, and not from the host again") {
    const auto uploaded_by_second = [](bool after_first) {
        SharedCopy picture(2, shared_settings());
        if (!after_first) return picture.queues[0]->uploaded_bytes();
        CHECK(picture.render() == kSharedSamples);
        return picture.queues[1]->uploaded_bytes();
    };
    if (test::cuda_requested() && cuda_device_count() < 2) return; // a CPU cannot copy from a GPU beside its work
    CHECK(2 * uploaded_by_second(true) < uploaded_by_second(false));
}

TEST_CASE("layers, layers at centres, ids, light-path layers and invalid samples are those of one device") {
    for (const LayersAt at : {LayersAt::Samples, LayersAt::Centre}) {
        const RenderSettings settings = shared_layers(at);
        const OneDevice alone(settings);
        for (const double fold_s : {0.0, kFoldSeconds}) {
            DeviceHooks hooks;
            hooks.fold_s = fold_s;
            SharedCopy picture(3, settings, hooks);
            CHECK(picture.render() == kSharedSamples);
            check_shared(picture, alone);
            CHECK(picture.session->film().invalid_samples() > 0);
            const RenderResult result = picture.session->result();
            CHECK(result.layers.size() > 4);
            CHECK(result.ids.size() == 21 * 13);
        }
    }
}

TEST_CASE("adjacent ranges of samples add up, and a range may begin anywhere") {
    const RenderSettings settings = shared_layers(LayersAt::Centre);
    SharedCopy picture(2, settings);
    CHECK(picture.render({0, 5}) == 5);
    CHECK(picture.render({5, kSharedSamples}) == kSharedSamples - 5);
    check_shared(picture, OneDevice(settings));
    SharedCopy part(2, settings);
    CHECK(part.render({4, 9}) == 5);
    CHECK(part.session->film().part().samples == SampleRange{4, 9});
    check_shared(part, OneDevice(settings, {4, 9}));
}

TEST_CASE("slices of many samples, as long as their devices need for a fraction of a second, change nothing") {
    RenderSettings settings = shared_settings();
    settings.pass_samples = 0;
    settings.samples = 700;
    SharedCopy picture(3, settings);
    CHECK(picture.render({0, 700}) == 700);
    check_shared(picture, OneDevice(settings, {0, 700}));
}

TEST_CASE("a device that fails in the middle costs a warning, and the others render what it had") {
    const RenderSettings settings = shared_layers(LayersAt::Centre);
    const OneDevice alone(settings);
    for (const std::size_t device : {0u, 1u}) { // the caller's too
        for (const double fold_s : {0.0, kFoldSeconds}) {
            CAPTURE(device);
            CAPTURE(fold_s);
            FailingDevice failing(3, device, 2, ErrorCode::DeviceFault, fold_s);
            SharedCopy picture(3, settings, failing.hooks);
            CHECK(picture.render() == kSharedSamples);
            CHECK(failing.has_failed);
            CHECK(failing.lost.count() == 1);
            check_shared(picture, alone);
            REQUIRE(picture.warnings() == 1);
            CHECK(std::ranges::any_of(picture.messages.all(),
                                      [](const auto& one) { // a notice of the copies between GPUs may precede it
                                          return one.is_warning && one.remark.setting == "device";
                                      }));
        }
    }
}

TEST_CASE("a device that has failed takes no part in later samples of the picture") {
    const RenderSettings settings = shared_settings();
    FailingDevice failing(2, 1, 1, ErrorCode::DeviceFault);
    SharedCopy picture(2, settings, failing.hooks);
    CHECK(picture.render({0, 6}) == 6);
    const SampleRange lost = failing.lost;
    picture.messages = {};
    CHECK(picture.render({6, kSharedSamples}) == kSharedSamples - 6);
    CHECK(failing.lost == lost);
    CHECK(failing.begun.count == 3); // two devices, then one
    CHECK(picture.warnings() == 0);
    check_shared(picture, OneDevice(settings));
}

TEST_CASE("a device without memory for the scene is left out with a warning") {
    const RenderSettings settings = shared_settings();
    for (const std::size_t device : {0u, 1u}) {
        FailingDevice failing(2, device, 0, ErrorCode::OutOfMemory);
        SharedCopy picture(2, settings, failing.hooks);
        CHECK(picture.render() == kSharedSamples);
        CHECK(picture.warnings() == 1);
        check_shared(picture, OneDevice(settings));
    }
}

TEST_CASE("a render whose devices all fail throws why the first one did, and its film is empty") {
    for (const ErrorCode code : {ErrorCode::DeviceFault, ErrorCode::OutOfMemory}) {
        DeviceHooks hooks;
        hooks.after_slice = [&](std::size_t, SampleRange slice) {
            if (slice.first >= 4) throw Error(code, "a test ends all devices");
        };
        SharedCopy picture(2, shared_settings(), hooks);
        const auto error = test::thrown_error([&] { picture.render(); });
        REQUIRE(error.has_value());
        CHECK(error->code() == code);
        CHECK(picture.session->film().part().samples.count() == 0);
    }
}

TEST_CASE("an error that every device would meet ends the render") {
    DeviceHooks hooks;
    hooks.after_slice = [&](std::size_t, SampleRange slice) {
        if (slice.first == 3) throw Error(ErrorCode::BadInput, "camera", "", "a test has no such camera");
    };
    SharedCopy picture(2, shared_settings(), hooks);
    const auto error = test::thrown_error([&] { picture.render(); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "camera"));
    CHECK(picture.warnings() == 0);
}

TEST_CASE("a time limit ends at one whole sample of all devices") {
    RenderSettings settings = shared_layers(LayersAt::Samples);
    settings.pass_samples = 0;
    settings.samples = test::cuda_requested() ? 1u << 22 : 40'000; // seconds
    settings.time_limit_s = 0.4;
    SharedCopy picture(3, settings);
    const Stopwatch watch;
    const uint32_t samples = picture.render({0, settings.samples});
    CHECK(watch.seconds() < 20);
    CHECK(samples > 3);
    CHECK(samples < settings.samples);
    CHECK(picture.session->film().part().samples == SampleRange{0, samples});
    settings.time_limit_s = 0;
    check_shared(picture, OneDevice(settings, {0, samples}));
}

namespace {

/// Stops a render once its film has some samples; at 0 samples, at once.
struct StopWithSamples final : Sink {
    explicit StopWithSamples(uint32_t samples) : most(samples) {}
    void progress(const Progress& now) override {
        CHECK(now.share >= last);
        last = now.share;
        stops = now.samples_done >= most;
    }
    bool should_stop() override { return stops; }
    uint32_t most;
    double last = 0;
    std::atomic<bool> stops = false;
};

} // namespace

TEST_CASE("a sink stops devices at a whole sample, and CPUs at once while there is none") {
    RenderSettings settings = shared_settings();
    settings.samples = 1u << 22;
    SharedCopy picture(2, settings);
    StopWithSamples some(1);
    const uint32_t samples = picture.session->render(settings.range(), some);
    CHECK(samples > 0);
    CHECK(samples < settings.samples);
    check_shared(picture, OneDevice(settings, {0, samples}));

    DeviceHooks hooks; // a first slice that lasts until the sink has been heard
    test::StopAfter never(0);
    hooks.after_slice = [&](std::size_t, SampleRange) {
        const Stopwatch watch;
        while (never.asked < 2 && watch.seconds() < 20) std::this_thread::yield();
    };
    if (test::cuda_requested()) return; // a GPU finishes its slice
    SharedCopy none(2, settings, hooks);
    CHECK(none.session->render(settings.range(), never) == 0);
    CHECK(none.session->film().part().samples.count() == 0);
}

TEST_CASE("what a sink throws ends the render on all devices") {
    struct Throwing final : Sink {
        void progress(const Progress&) override { throw Error(ErrorCode::Interrupted, "a test's sink throws"); }
    } sink;
    RenderSettings settings = shared_settings();
    settings.samples = 1u << 22;
    SharedCopy picture(2, settings);
    const auto error = test::thrown_error([&] { picture.session->render(settings.range(), sink); });
    REQUIRE(error.has_value());
    CHECK(error->code() == ErrorCode::Interrupted);
}
