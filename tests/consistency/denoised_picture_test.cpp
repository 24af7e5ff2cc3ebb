// Denoised single pictures have the same bytes on both devices, with both schedules of the path tracer and in parts;
// denoising does not change the film, and reduces the error.

#include <doctest/doctest.h>

#include <cmath>

#include "formats/read_scene.h"
#include "image/picture_hash.h"
#include "session/session.h"
#include "session/session_bytes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

RenderSettings denoised_settings() {
    RenderSettings settings;
    settings.width = 96, settings.height = 64;
    settings.path.max_depth = 4;
    settings.denoise = Denoise::Svgf;
    return settings;
}

Hash128 hash_of_denoised(Queue& queue, const PreparedScene& prepared, const RenderSettings& settings,
                         std::initializer_list<uint32_t> parts) {
    Session session(queue, prepared, mixed_scene_camera(), settings);
    for (const uint32_t samples : parts) session.render(samples);
    return picture_hash(session.denoised().value());
}

double brightness_of(const Image& picture) {
    double sum = 0;
    for (const float value : picture.pixels) sum += static_cast<double>(value);
    return sum / static_cast<double>(picture.pixels.size());
}

/// Returns the mean absolute difference.
double mean_difference(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += static_cast<double>(std::abs(a.pixels[i] - b.pixels[i]));
    return sum / static_cast<double>(a.pixels.size());
}

} // namespace

TEST_CASE(
    "a denoised picture has the same bytes on every device, in every schedule, in parts and after another picture") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue cpu = Queue::make_cpu();
    const RenderSettings settings = denoised_settings();
    const Hash128 expected = hash_of_denoised(cpu, prepared, settings, {5});
    CHECK(hash_of_denoised(cpu, prepared, settings, {1, 3, 1}) == expected);

    RenderSettings wavefront = settings;
    wavefront.body = PathBody::Wavefront;
    wavefront.batch = 1000; // paths begin in several rounds
    CHECK(hash_of_denoised(cpu, prepared, wavefront, {2, 3}) == expected);

    Session session(cpu, prepared, mixed_scene_camera(), settings);
    Camera aside = mixed_scene_camera();
    aside.world_from_camera.translation.x += 0.2f;
    session.set_camera(aside);
    session.render(2);
    session.render_frame(0, {}); // uses the same frame for samples
    CHECK(picture_hash(session.denoised().value()) != expected);
    session.set_camera(mixed_scene_camera());
    CHECK(!session.denoised().has_value());
    session.render(5);
    CHECK(picture_hash(session.denoised().value()) == expected);

    if (cuda_requested()) {
        Queue cuda = make_cuda_queue();
        CHECK(hash_of_denoised(cuda, prepared, settings, {5}) == expected);
    }
}

TEST_CASE("surfaces of the first samples come with their light or before it, with the same bytes") {
    Messages messages;
    const Scene scene = read_scene("cornell-box", {}, messages); // without mirrors
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    RenderSettings settings = denoised_settings();
    settings.width = settings.height = 24;
    const auto hash_of = [&](uint32_t first, uint32_t rest) {
        Session session(queue, prepared, scene.cameras.front(), settings);
        session.render(first);
        session.render(rest);
        return picture_hash(session.denoised().value());
    };
    const Hash128 expected = hash_of(17, 3);
    CHECK(hash_of(1, 19) == expected);
    CHECK(hash_of(9, 11) == expected);
}

TEST_CASE("denoising does not change the film and its layers") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    RenderSettings settings = denoised_settings();
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.transparent = true;
    Session session(queue, prepared, mixed_scene_camera(), settings);
    session.render(3);
    const RenderResult denoised = session.result();
    settings.denoise = Denoise::None;
    session.set_settings(settings);
    session.render(3);
    const RenderResult plain = session.result();

    CHECK(picture_hash(denoised.picture) == picture_hash(plain.picture));
    CHECK(denoised.rays.total() == plain.rays.total());
    REQUIRE(denoised.layers.size() == plain.layers.size());
    for (std::size_t i = 0; i < plain.layers.size(); ++i) {
        INFO(plain.layers[i].name);
        CHECK(denoised.layers[i].image.pixels == plain.layers[i].image.pixels);
    }
    REQUIRE(denoised.ids.size() == plain.ids.size());
    bool are_same = true;
    for (std::size_t i = 0; i < plain.ids.size(); ++i) {
        are_same = are_same && denoised.ids[i].instance == plain.ids[i].instance &&
                   denoised.ids[i].primitive == plain.ids[i].primitive &&
                   denoised.ids[i].material == plain.ids[i].material;
    }
    CHECK(are_same);
    REQUIRE(denoised.denoised.has_value());
    CHECK(!plain.denoised.has_value());
    for (std::size_t i = 3; i < plain.picture.pixels.size(); i += 4) { // the alpha is that of the film
        if (denoised.denoised->pixels[i] != plain.picture.pixels[i]) FAIL("alpha of pixel ", i / 4);
    }
}

TEST_CASE("a denoised picture has less error than its samples and the same brightness") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    RenderSettings settings = denoised_settings();
    Session session(queue, prepared, mixed_scene_camera(), settings);
    session.render(4);
    const RenderResult few = session.result();
    RenderSettings many = settings;
    many.denoise = Denoise::None;
    many.path.seed = 1;
    session.set_settings(many);
    session.render(512);
    const Image reference = session.picture();
    CHECK(mean_difference(*few.denoised, reference) < 0.6 * mean_difference(few.picture, reference));
    CHECK(brightness_of(*few.denoised) == doctest::Approx(brightness_of(few.picture)).epsilon(0.02));
}

TEST_CASE("memory of a denoised render equals its prediction") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        Queue queue = requested_queue();
        RenderSettings settings = denoised_settings();
        settings.body = body;
        settings.samples = 2;
        RenderSettings plain = settings;
        plain.denoise = Denoise::None;
        plain.samples = 1; // queues do not grow, because samples are rendered one by one
        const auto bytes_of = [&](const RenderSettings& requested) {
            Session session(queue, prepared, mixed_scene_camera(), requested);
            session.render(requested.samples);
            return queue.allocated_bytes();
        };
        const std::size_t more = bytes_of(settings) - bytes_of(plain);
        CHECK(more ==
              predicted_bytes(prepared, settings, queue.is_cuda()) - predicted_bytes(prepared, plain, queue.is_cuda()));
    }
}
