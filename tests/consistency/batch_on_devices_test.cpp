// A batch of pictures by several devices has the bytes of one device's, whichever of them takes a chunk or fails.

#include "session/devices/batch_on_devices.h"

#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "base/stopwatch.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stop_after.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

constexpr uint32_t kPictures = 13;

/// A scene and cameras in it.
struct ManyViews {
    Scene scene = test::make_mixed_scene();
    PreparedScene prepared;
    CameraBatch batch;
    ManyViews() {
        Messages messages;
        prepared = prepare_scene(scene, {}, messages);
        for (uint32_t k = 0; k < kPictures; ++k) {
            batch.cameras.push_back(test::mixed_scene_camera());
            batch.cameras.back().fov_y = 0.5f + 0.05f * static_cast<float>(k);
            batch.seeds.push_back(k / 2);
        }
    }
};

const ManyViews& many_views() {
    static const ManyViews made;
    return made;
}

RenderSettings settings_of_views(LayersAt at, IntegratorKind kind = IntegratorKind::Path) {
    RenderSettings settings;
    settings.integrator = kind;
    settings.width = 19, settings.height = 11, settings.samples = 3;
    settings.path.max_depth = 4;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovIds;
    settings.layers_at = at;
    return settings;
}

/// The values of all arrays.
struct ViewValues {
    std::vector<std::vector<float>> floats;
    std::vector<uint32_t> ids;
    explicit ViewValues(const BatchArrays& arrays) {
        floats.push_back(arrays.color.download());
        for (const BatchArrays::Layer& layer : arrays.layers) floats.push_back(layer.values.download());
        for (const PixelIds& id : arrays.ids.download()) {
            ids.insert(ids.end(), {id.instance, id.primitive, id.material});
        }
    }
    bool operator==(const ViewValues&) const = default;
};

ViewValues views_of_one(const RenderSettings& settings, uint64_t& rays) {
    Queue queue = test::requested_queue();
    Session session(queue, many_views().prepared, test::mixed_scene_camera(), settings);
    BatchRender render(session.pictures(), many_views().batch, settings, kPictures);
    BatchArrays arrays;
    REQUIRE(render.next(arrays));
    queue.wait();
    rays = render.rays().total();
    return ViewValues(arrays);
}

/// Pictures of the views by three devices.
struct ViewsOnDevices {
    explicit ViewsOnDevices(const RenderSettings& of_each, const DeviceHooks& hooks = {}) : settings(of_each) {
        for (int i = 0; i < 3; ++i) {
            const bool is_gpu = test::cuda_requested() && i < cuda_device_count();
            queues.push_back(std::make_shared<Queue>(is_gpu ? Queue::make_cuda(i) : Queue::make_cpu(Threads(1))));
        }
        together.emplace(queues, many_views().prepared, hooks);
        session.emplace(*queues.front(), many_views().prepared, test::mixed_scene_camera(), settings);
    }
    SharedBatch render(Sink& sink, uint32_t at_once = 2) {
        return render_batch(*together, session->pictures(), many_views().batch, settings, at_once, arrays, sink);
    }

    RenderSettings settings;
    std::vector<std::shared_ptr<Queue>> queues;
    BatchArrays arrays;
    std::optional<RenderOnDevices> together;
    std::optional<Session> session;
};

} // namespace

TEST_CASE("batches by three devices have the bytes of one device's") {
    for (const RenderSettings& settings : {settings_of_views(LayersAt::Samples), settings_of_views(LayersAt::Centre),
                                           settings_of_views(LayersAt::Samples, IntegratorKind::Bidirectional)}) {
        uint64_t rays = 0;
        const ViewValues expected = views_of_one(settings, rays);
        std::atomic<uint32_t> taken[3] = {};
        DeviceHooks hooks;
        hooks.after_slice = [&](std::size_t device, SampleRange chunk) {
            taken[device] += chunk.count();
            const Stopwatch watch; // until each has taken a chunk
            const auto all_have = [&] { return taken[0] > 0 && taken[1] > 0 && taken[2] > 0; };
            while (!all_have() && watch.seconds() < 20) std::this_thread::yield();
        };
        ViewsOnDevices views(settings, hooks);
        Messages messages;
        const SharedBatch batch = views.render(messages);
        CHECK(ViewValues(views.arrays) == expected);
        CHECK(batch.rays.total() == rays);
        CHECK(views.arrays.pictures == kPictures);
        CHECK(taken[0] + taken[1] + taken[2] == kPictures);
        CHECK(messages.all().empty());
        CHECK(ViewValues(views.arrays) == expected);
    }
}

TEST_CASE("chunks of a device that fails are rendered by the others, with a warning") {
    const RenderSettings settings = settings_of_views(LayersAt::Centre);
    uint64_t rays = 0;
    const ViewValues expected = views_of_one(settings, rays);
    for (const std::size_t lost : {0u, 2u}) {
        for (const bool has_memory : {true, false}) {
            std::atomic<bool> has_failed = false;
            DeviceHooks hooks;
            hooks.before_samples = [&](std::size_t device) {
                if (device != lost || has_memory) return;
                has_failed = true;
                throw Error(ErrorCode::OutOfMemory, "a test leaves this device no memory");
            };
            std::atomic<uint32_t> taken = 0;
            hooks.after_slice = [&](std::size_t device, SampleRange chunk) {
                if (device == lost) {
                    has_failed = true;
                    throw Error(ErrorCode::DeviceFault, "a test ends this device");
                }
                taken += chunk.count();
                const Stopwatch watch;
                while (!has_failed && watch.seconds() < 20) std::this_thread::yield();
            };
            ViewsOnDevices views(settings, hooks);
            Messages messages;
            views.render(messages);
            CHECK(has_failed);
            CHECK(taken == kPictures);
            CHECK(ViewValues(views.arrays) == expected);
            REQUIRE(messages.all().size() == 1);
            CHECK(messages.all().front().is_warning);
        }
    }
}

TEST_CASE("a batch ends when all devices fail, at an error that all would meet, and when its sink stops") {
    const RenderSettings settings = settings_of_views(LayersAt::Samples);
    for (const ErrorCode code : {ErrorCode::DeviceFault, ErrorCode::BadInput}) {
        DeviceHooks hooks;
        hooks.after_slice = [&](std::size_t, SampleRange) { throw Error(code, "a test ends all devices"); };
        ViewsOnDevices views(settings, hooks);
        const auto error = test::thrown_error([&] { views.render(nobody()); });
        REQUIRE(error.has_value());
        CHECK(error->code() == code);
    }
    test::StopAfter stops(0);
    DeviceHooks hooks;
    std::atomic<uint32_t> chunks = 0;
    hooks.after_slice = [&](std::size_t, SampleRange) {
        ++chunks;
        const Stopwatch watch;
        while (stops.asked < 2 && watch.seconds() < 20) std::this_thread::yield();
    };
    ViewsOnDevices views(settings, hooks);
    views.render(stops, 1);
    CHECK(chunks <= 3);
}
