// Two queues in one process, each with its own scene, do not affect each other's picture. With --device cuda these are
// two GPUs or the same one twice, otherwise two queues of the CPU.

#include <thread>

#include <doctest/doctest.h>

#include "device_scene/scene_on_device.h"
#include "image/picture_hash.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/kinds/make_integrator.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "render/filter_table.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr uint32_t kSamples = 4;

Queue make_queue(int which) {
    if (!test::cuda_requested()) return Queue::make_cpu();
    return Queue::make_cuda(cuda_device_count() >= 2 ? which : 0);
}

struct Subject {
    Scene scene;
    uint32_t width, height;
};

/// Two scenes of different size, so that the buffers of one do not fit the other.
const Subject& subject(int which) {
    static const Subject subjects[2] = {{test::make_mixed_scene(), 61, 35}, {test::make_furnace_scene(0.5f), 32, 40}};
    return subjects[which];
}

/// A render that continues sample by sample.
class Render {
public:
    Render(Queue& queue, const Subject& subject, IntegratorSettings settings = {})
        : prepared_(prepare_scene(subject.scene, {}, messages_)), scene_(queue, prepared_),
          film_(queue, subject.width, subject.height, kAovNormal | kAovDepth),
          tracer_(queue, *prepared_.structures, default_tracers(queue.is_cuda())), filter_(queue) {
        settings.body = PathBody::Wavefront;
        settings.batch = 1000;
        integrator_ = make_integrator(queue, settings);
        tracer_.set_surfaces(scene_.view());
        const PixelFilter kind = PixelFilter::BlackmanHarris;
        const CameraRays rays =
            make_camera_rays(test::mixed_scene_camera(), filter_.set(kind, default_filter_radius(kind)), subject.width,
                             subject.height, prepared_.centre);
        integrator_->begin({scene_.view(), rays}, tracer_, kSamples);
    }

    void add_sample(uint32_t sample) {
        integrator_->render(sample, 1, film_.view());
        SampleRange now = film_.part().samples;
        if (now.count() == 0) now = {sample, sample};
        film_.set_samples({std::min(now.first, sample), std::max(now.end, sample + 1)});
    }
    void add_all() {
        for (uint32_t sample = 0; sample < kSamples; ++sample) add_sample(sample);
    }
    void add(const Render& other) { film_.add(other.film_); }
    Hash128 hash() const {
        Hasher hasher;
        hasher.add_values(std::span<const float>(film_.picture(true).pixels));
        for (const FilmLayer& layer : film_.layers()) {
            hasher.add_values(std::span<const float>(layer.image.pixels));
        }
        return hasher.result();
    }

private:
    Messages messages_;
    PreparedScene prepared_;
    SceneOnDevice scene_;
    Film film_;
    SceneTracer tracer_;
    FilterTable filter_;
    std::unique_ptr<Integrator> integrator_;
};

Hash128 hash_alone(int which, const IntegratorSettings& settings = {}) {
    Queue queue = Queue::make_cpu();
    Render render(queue, subject(which), settings);
    render.add_all();
    return render.hash();
}

} // namespace

TEST_CASE("two queues used alternately from one thread give the pictures of separate renders") {
    Queue first_queue = make_queue(0), second_queue = make_queue(1);
    Render first(first_queue, subject(0)), second(second_queue, subject(1));
    for (uint32_t sample = 0; sample < kSamples; ++sample) {
        first.add_sample(sample);
        second.add_sample(sample);
    }
    CHECK(first.hash() == hash_alone(0));
    CHECK(second.hash() == hash_alone(1));
    CHECK(hash_alone(0) != hash_alone(1));
}

TEST_CASE("a picture whose samples are split between two queues equals that of one queue") {
    IntegratorSettings settings;
    settings.photon_map = {.photons = 3000, .radius = 0.3f};
    settings.irradiance_cache = {.accuracy = 0.4f, .hemisphere_rays = 48};
    for (const IntegratorKind kind :
         {IntegratorKind::Path, IntegratorKind::PhotonMap, IntegratorKind::IrradianceCache}) {
        CAPTURE(static_cast<int>(kind));
        settings.integrator = kind;
        const Hash128 alone = hash_alone(0, settings);
        Queue first_queue = make_queue(0), second_queue = make_queue(1);
        Render first(first_queue, subject(0), settings), second(second_queue, subject(0), settings);
        for (uint32_t sample = 0; sample < kSamples; ++sample) (sample < 2 ? first : second).add_sample(sample);
        CHECK(first.hash() != alone);
        first.add(second);
        CHECK(first.hash() == alone);
        // The order of samples does not matter, because the radius of photons and the accuracy of records depend only
        // on a sample's number.
        Render late(first_queue, subject(0), settings), early(second_queue, subject(0), settings);
        for (uint32_t sample = kSamples; sample-- > 0;) (sample >= 2 ? late : early).add_sample(sample);
        late.add(early);
        CHECK(late.hash() == alone);
    }
}

TEST_CASE("two queues used from two threads at once give the pictures of separate renders") {
    Hash128 hashes[2];
    const auto render_on_its_queue = [&](int which) {
        Queue queue = make_queue(which);
        Render render(queue, subject(which));
        render.add_all();
        hashes[which] = render.hash();
    };
    subject(0); // the scenes are made before the threads begin
    std::thread first(render_on_its_queue, 0), second(render_on_its_queue, 1);
    first.join();
    second.join();
    CHECK(hashes[0] == hash_alone(0));
    CHECK(hashes[1] == hash_alone(1));
}

TEST_CASE("checking whether a device is available affects no queue") {
    Queue queue = make_queue(1);
    Render render(queue, subject(0));
    for (uint32_t sample = 0; sample < kSamples; ++sample) {
        static_cast<void>(why_no_cuda(0));
        static_cast<void>(why_no_cuda(1000));
        render.add_sample(sample);
    }
    CHECK(render.hash() == hash_alone(0));
}
