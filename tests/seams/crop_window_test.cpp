// The film of a window has the bytes of that part of the whole picture, with layers, ids and light-path layers, for
// every integrator and schedule.

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <doctest/doctest.h>

#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/kinds/make_integrator.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "integrators/radiosity/radiosity_display_settings.h"
#include "radiosity/solve_radiosity.h"
#include "render/film.h"
#include "render/light_paths/light_path_layers.h"
#include "render/noisy_frame.h"
#include "tests/seams/picture_on_device.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr uint32_t kUncroppedWidth = 61, kUncroppedHeight = 35, kCropSamples = 3;
constexpr PixelWindow kWhole = {.width = kUncroppedWidth, .height = kUncroppedHeight};
constexpr PixelWindow kWindow = {.picture_width = kUncroppedWidth, .x = 17, .y = 9, .width = 23, .height = 14};
constexpr uint32_t kCropAovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;

struct CropResult {
    std::vector<Image> images; // the picture, auxiliary layers, layers of light paths
    std::vector<PixelIds> ids;
};

CropResult render_crop(Queue& queue, const PreparedScene& prepared, const IntegratorSettings& settings,
                       const PixelWindow& window, const Camera& camera = test::mixed_scene_camera()) {
    test::PictureOnDevice picture(queue, prepared, camera, kUncroppedWidth, kUncroppedHeight);
    const auto integrator = make_integrator(queue, settings);
    integrator->begin(picture.view, picture.tracer, kCropSamples);
    const std::vector<std::string> light_layers =
        settings.light_paths ? std::vector<std::string>{"lamps", "once"} : std::vector<std::string>();
    Film film(queue, window.width, window.height, kCropAovs, light_layers);
    film.set_window(window);
    integrator->render(0, kCropSamples, film.view());
    film.set_samples({0, kCropSamples});
    CropResult result = {{film.picture(true)}, film.ids()};
    for (FilmLayer& layer : film.layers()) result.images.push_back(std::move(layer.image));
    return result;
}

/// Returns how many pixels of a window differ from those of the whole image.
uint32_t differing_in_window(const Image& window, const Image& whole) {
    REQUIRE(window.channels == whole.channels);
    const std::size_t channels = static_cast<std::size_t>(whole.channels);
    uint32_t count = 0;
    for (uint32_t i = 0; i < kWindow.count(); ++i) {
        const float* const there = &whole.pixels[kWindow.pixel_at(FilmSlot{i}) * channels];
        count += std::memcmp(&window.pixels[i * channels], there, channels * sizeof(float)) != 0 ? 1 : 0;
    }
    return count;
}

/// Tests that a window has the bytes of the whole picture, in all layers and in ids of several objects.
void check_window(Queue& queue, const PreparedScene& prepared, const IntegratorSettings& settings) {
    const CropResult whole = render_crop(queue, prepared, settings, kWhole);
    const CropResult window = render_crop(queue, prepared, settings, kWindow);
    REQUIRE(whole.images.size() == (settings.light_paths ? 7 : 5));
    for (std::size_t i = 0; i < whole.images.size(); ++i) {
        CAPTURE(i);
        CHECK(differing_in_window(window.images[i], whole.images[i]) == 0);
        CHECK(*std::ranges::max_element(window.images[i].pixels) > 0);
    }
    uint32_t other_ids = 0, things = 0;
    for (uint32_t i = 0; i < window.ids.size(); ++i) {
        const PixelIds a = window.ids[i], b = whole.ids[kWindow.pixel_at(FilmSlot{i})];
        other_ids += a.instance != b.instance || a.primitive != b.primitive || a.material != b.material ? 1 : 0;
        things += a.instance != kNoHit && i > 0 && a.instance != window.ids[i - 1].instance ? 1 : 0;
    }
    CHECK(other_ids == 0);
    CHECK(things > 10);
}

} // namespace

TEST_CASE("slots of a window and pixels of the picture convert into each other") {
    for (uint32_t i = 0; i < kWindow.count(); ++i) {
        const uint32_t pixel = kWindow.pixel_at(FilmSlot{i});
        REQUIRE(pixel == kWindow.pixel_in(17 + i % 23, 9 + i / 23));
        REQUIRE(kWindow.slot_of(pixel) == FilmSlot{i});
    }
    CHECK(kWhole.pixel_at(FilmSlot{1234}) == 1234);
    CHECK(kWhole.slot_of(1234) == FilmSlot{1234});
    CHECK(kWhole.pixel_in(14, 20) == 1234);
}

TEST_CASE("the windows around a window contain every other pixel of the picture once") {
    const PixelWindow corner = {.picture_width = kUncroppedWidth, .x = 38, .y = 21, .width = 23, .height = 14};
    for (const PixelWindow& window : {kWindow, corner}) {
        std::vector<uint32_t> times(kWhole.count());
        for (uint32_t i = 0; i < window.count(); ++i) ++times[window.pixel_at(FilmSlot{i})];
        for (const PixelWindow& other : windows_around(window, kUncroppedHeight)) {
            for (uint32_t i = 0; i < other.count(); ++i) ++times.at(other.pixel_at(FilmSlot{i}));
        }
        CHECK(std::ranges::all_of(times, [](uint32_t n) { return n == 1; }));
    }
    for (const PixelWindow& other : windows_around(kWhole, kUncroppedHeight)) CHECK(other.count() == 0);
}

TEST_CASE("a film of a window has the bytes of that part of the whole picture, by every integrator") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    IntegratorSettings settings;
    settings.batch = 500;
    settings.path.max_depth = 6;
    settings.photon_map.edit().photons = 2000;
    settings.irradiance_cache.edit().hemisphere_rays = 64;
    RadiositySettings patches;
    patches.patch_size = 2;
    patches.rays = 16;
    settings.radiosity.edit().solution =
        std::make_shared<const RadiositySolution>(solve_radiosity(prepared, patches).solution);
    Queue queue = test::requested_queue();
    for (const IntegratorDescriptor& integrator : integrators()) {
        for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
            CAPTURE(integrator.name);
            CAPTURE(static_cast<int>(body));
            settings.integrator = integrator.value;
            settings.body = body;
            check_window(queue, prepared, settings);
        }
    }
}

TEST_CASE("a film of a window has the bytes of the whole picture's layers of light paths") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    IntegratorSettings settings;
    settings.path.sampler = SamplerKind::Independent;
    settings.light_paths = std::make_shared<const LightPathLayers>(
        bind_to_scene({parse_light_path("lamps=L<'lamp'>.*E"), parse_light_path("once=L.E")}, scene));
    Queue queue = test::requested_queue();
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        check_window(queue, prepared, settings);
    }
}

TEST_CASE("a film of a window has the bytes of that part of a light meter's whole picture") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Camera meter = test::mixed_scene_camera();
    meter.projection = Projection::Cosine;
    Queue queue = test::requested_queue();
    const CropResult whole = render_crop(queue, prepared, {}, kWhole, meter);
    const CropResult window = render_crop(queue, prepared, {}, kWindow, meter);
    CHECK(differing_in_window(window.images[0], whole.images[0]) == 0);
    CHECK(*std::ranges::max_element(window.images[0].pixels) > 0);
}

TEST_CASE("integrators refuse a window beyond the picture, and a frame that they cannot make") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    PixelWindow beyond = kWindow;
    beyond.y = kUncroppedHeight - beyond.height + 1;
    NoisyFrame frame(queue, kUncroppedWidth, kUncroppedHeight, true);
    test::PictureOnDevice picture(queue, prepared, test::mixed_scene_camera(), kUncroppedWidth, kUncroppedHeight);
    for (const IntegratorDescriptor& kind : integrators()) {
        if (kind.value == IntegratorKind::Radiosity) continue; // radiosity needs a solution
        CAPTURE(kind.name);
        IntegratorSettings settings;
        settings.integrator = kind.value;
        CHECK_THROWS_AS(render_crop(queue, prepared, settings, beyond), std::logic_error);
        if (kind.makes_frames) continue;
        const auto integrator = make_integrator(queue, settings);
        integrator->begin(picture.view, picture.tracer, 1);
        CHECK_THROWS_AS(integrator->render(0, 1, frame.film_view()), std::logic_error);
    }
}
