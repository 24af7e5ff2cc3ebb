// A film that holds a window of a picture has the bytes that the whole picture has there, its layers, its ids and its
// layers of light paths too, by either body of the path tracer, and where rasterisation finds what the camera sees.

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <doctest/doctest.h>

#include "integrators/kinds/make_integrator.h"
#include "render/film.h"
#include "render/light_paths/light_path_layers.h"
#include "tests/seams/picture_on_device.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr uint32_t kUncroppedWidth = 61, kUncroppedHeight = 35, kCropSamples = 3;
constexpr PixelWindow kWindow = {.picture_width = kUncroppedWidth, .x = 17, .y = 9, .width = 23};
constexpr uint32_t kWindowHeight = 14;
constexpr uint32_t kCropAovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;

struct CropResult {
    std::vector<Image> images; // the picture, auxiliary layers, layers of light paths
    std::vector<PixelIds> ids;
};

CropResult render_crop(Queue& queue, const PreparedScene& prepared, const IntegratorSettings& settings, bool is_window,
                       const Camera& camera = test::mixed_scene_camera()) {
    test::PictureOnDevice picture(queue, prepared, camera, kUncroppedWidth, kUncroppedHeight);
    const auto integrator = make_integrator(queue, settings);
    integrator->begin(picture.view, picture.tracer, kCropSamples);
    const std::vector<std::string> light_layers =
        settings.light_paths ? std::vector<std::string>{"lamps", "once"} : std::vector<std::string>();
    Film film(queue, is_window ? kWindow.width : kUncroppedWidth, is_window ? kWindowHeight : kUncroppedHeight,
              kCropAovs, light_layers);
    if (is_window) film.set_window(kWindow);
    integrator->render(0, kCropSamples, film.view());
    film.set_samples({0, kCropSamples});
    CropResult result = {{film.picture(true)}, film.ids()};
    for (FilmLayer& layer : film.layers()) result.images.push_back(std::move(layer.image));
    return result;
}

/// Pixels of a window that are not those of the whole image.
uint32_t differing_in_window(const Image& window, const Image& whole) {
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

TEST_CASE("a film of a window has the bytes of that part of the whole picture") {
    for (uint32_t i = 0; i < kWindow.width * kWindowHeight; ++i) REQUIRE(kWindow.slot_of(kWindow.pixel_at(i)) == i);
    CHECK(PixelWindow{}.pixel_at(1234) == 1234);
    CHECK(PixelWindow{}.slot_of(1234) == 1234);

    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const auto layers = std::make_shared<const LightPathLayers>(
        put_to_scene({parse_light_path("lamps=L<'lamp'>.*E"), parse_light_path("once=L.E")}, scene));
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        for (const bool is_other : {false, true}) {
            CAPTURE(static_cast<int>(body));
            CAPTURE(is_other);
            IntegratorSettings settings;
            settings.body = body;
            settings.batch = 500;
            settings.integrator = is_other ? IntegratorKind::Hybrid : IntegratorKind::Path;
            settings.path.sampler = is_other ? SamplerKind::Independent : SamplerKind::Sobol;
            if (is_other) settings.light_paths = layers;
            Queue queue = test::requested_queue();
            const CropResult whole = render_crop(queue, prepared, settings, false);
            const CropResult window = render_crop(queue, prepared, settings, true);
            REQUIRE(whole.images.size() == (is_other ? 7 : 5));
            for (std::size_t i = 0; i < whole.images.size(); ++i) {
                CHECK(differing_in_window(window.images[i], whole.images[i]) == 0);
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

TEST_CASE("a film of a window has the bytes of that part of a light meter's whole picture") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Camera meter = test::mixed_scene_camera();
    meter.projection = Projection::Cosine;
    Queue queue = test::requested_queue();
    const CropResult whole = render_crop(queue, prepared, {}, false, meter);
    const CropResult window = render_crop(queue, prepared, {}, true, meter);
    CHECK(differing_in_window(window.images[0], whole.images[0]) == 0);
    CHECK(*std::ranges::max_element(window.images[0].pixels) > 0);
}

TEST_CASE("integrators that only fill whole pictures refuse a film of a window") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    uint32_t refused = 0;
    for (const IntegratorDescriptor& integrator : integrators()) {
        if (integrator.value == IntegratorKind::Radiosity) continue; // it needs a solution
        CAPTURE(integrator.name);
        IntegratorSettings settings;
        settings.integrator = integrator.value;
        const auto throws = [&](bool is_window) {
            try {
                render_crop(queue, prepared, settings, is_window);
                return false;
            } catch (const std::logic_error&) {
                return true;
            }
        };
        CHECK_FALSE(throws(false));
        refused += throws(true) ? 1 : 0;
    }
    CHECK(refused == integrators().size() - 3); // but path and hybrid
}
