// A film that holds a window of a picture has the bytes that the whole picture has there, its layers and its ids too,
// by either body of the path tracer.

#include <cstring>

#include <doctest/doctest.h>

#include "device_scene/scene_on_device.h"
#include "integrators/kinds/make_integrator.h"
#include "render/filter_table.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr uint32_t kWidth = 61, kHeight = 35, kSamples = 3;
constexpr PixelWindow kWindow = {.picture_width = kWidth, .x = 17, .y = 9, .width = 23};
constexpr uint32_t kWindowHeight = 14;
constexpr uint32_t kAovs = kAovAlbedo | kAovNormal | kAovDepth | kAovIds;

struct Rendered {
    Image picture;
    std::vector<FilmLayer> layers;
    std::vector<PixelIds> ids;
};

Rendered render(Queue& queue, const PreparedScene& prepared, PathBody body, SamplerKind sampler, bool is_window) {
    const SceneOnDevice scene(queue, prepared);
    SceneTracer tracer(queue, *prepared.structures, default_tracers(queue.is_cuda()));
    tracer.set_surfaces(scene.view());
    FilterTable filter(queue);
    const PixelFilter kind = PixelFilter::BlackmanHarris;
    const CameraRays rays = make_camera_rays(test::mixed_scene_camera(), filter.set(kind, default_filter_radius(kind)),
                                             kWidth, kHeight, prepared.centre);
    IntegratorSettings settings;
    settings.body = body;
    settings.batch = 500;
    settings.path.sampler = sampler;
    const auto integrator = make_integrator(queue, settings);
    integrator->begin({scene.view(), rays}, tracer, kSamples);
    Film film(queue, is_window ? kWindow.width : kWidth, is_window ? kWindowHeight : kHeight, kAovs);
    FilmView view = film.view();
    if (is_window) view.window = kWindow;
    integrator->render(0, kSamples, view);
    film.set_samples({0, kSamples});
    return {film.picture(true), film.layers(), film.ids()};
}

/// Pixels of a window that are not those of the whole image.
uint32_t differing(const Image& window, const Image& whole) {
    REQUIRE(window.channels == whole.channels);
    const std::size_t channels = static_cast<std::size_t>(whole.channels);
    uint32_t count = 0;
    for (uint32_t i = 0; i < kWindow.width * kWindowHeight; ++i) {
        const float* const there = &whole.pixels[kWindow.pixel_at(i) * channels];
        count += std::memcmp(&window.pixels[i * channels], there, channels * sizeof(float)) != 0 ? 1 : 0;
    }
    return count;
}

} // namespace

TEST_CASE("a film of a window has the bytes that the whole picture has there") {
    for (uint32_t i = 0; i < kWindow.width * kWindowHeight; ++i) REQUIRE(kWindow.place_of(kWindow.pixel_at(i)) == i);
    CHECK(PixelWindow{}.pixel_at(1234) == 1234);
    CHECK(PixelWindow{}.place_of(1234) == 1234);

    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        for (const SamplerKind sampler : {SamplerKind::Sobol, SamplerKind::Independent}) {
            CAPTURE(static_cast<int>(body));
            CAPTURE(static_cast<int>(sampler));
            Queue queue = test::queue_asked_for();
            const Rendered whole = render(queue, prepared, body, sampler, false);
            const Rendered window = render(queue, prepared, body, sampler, true);
            CHECK(differing(window.picture, whole.picture) == 0);
            REQUIRE(window.layers.size() == whole.layers.size());
            for (std::size_t i = 0; i < whole.layers.size(); ++i) {
                CHECK(differing(window.layers[i].image, whole.layers[i].image) == 0);
            }
            uint32_t other_ids = 0, things = 0;
            for (uint32_t i = 0; i < window.ids.size(); ++i) {
                const PixelIds a = window.ids[i], b = whole.ids[kWindow.pixel_at(i)];
                other_ids += a.instance != b.instance || a.primitive != b.primitive || a.material != b.material ? 1 : 0;
                things += a.instance != kNoHit && i > 0 && a.instance != window.ids[i - 1].instance ? 1 : 0;
            }
            CHECK(other_ids == 0);
            CHECK(things > 10);
        }
    }
}
