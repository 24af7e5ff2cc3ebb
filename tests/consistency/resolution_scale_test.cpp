// Frames with light of a lower resolution have the same bytes on both devices and with both schedules of the path
// tracer; edges and textures keep the picture's resolution.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "image/picture_hash.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

RenderSettings settings_of(uint32_t width, uint32_t height) {
    RenderSettings settings;
    settings.width = width, settings.height = height;
    settings.path.max_depth = 4;
    return settings;
}

ReconstructionSettings scaled(float scale) {
    ReconstructionSettings settings;
    settings.resolution_scale = scale;
    return settings;
}

Hash128 hash_of_traversal(Session& session, uint32_t frames, const ReconstructionSettings& settings) {
    Camera camera = mixed_scene_camera();
    for (uint32_t k = 0; k < frames; ++k) {
        session.set_camera(camera);
        session.render_frame(k, settings);
        camera.world_from_camera.translation += 0.01f * column(camera.world_from_camera, 0);
    }
    return picture_hash(session.frame().picture());
}

/// Returns the mean of a still camera's frames after the first ones, in which noise does not disturb edges.
Image mean_of_still(Session& session, const ReconstructionSettings& settings) {
    constexpr uint32_t kFirst = 16, kCount = 48;
    session.cut();
    Image mean;
    for (uint32_t k = 0; k < kCount; ++k) {
        session.render_frame(k, settings);
        if (k < kFirst) continue;
        const Image picture = session.frame().picture();
        if (k == kFirst)
            mean = Image{picture.width, picture.height, 3, std::vector<float>(picture.pixels.size(), 0.0f)};
        for (std::size_t i = 0; i < mean.pixels.size(); ++i) mean.pixels[i] += picture.pixels[i] / (kCount - kFirst);
    }
    return mean;
}

/// Doubles an image's size by linear interpolation.
Image doubled(const Image& small) {
    Image large{2 * small.width, 2 * small.height, 3, {}};
    const auto at = [&](int x, int y, uint32_t c) {
        const int px = std::clamp(x, 0, static_cast<int>(small.width) - 1),
                  py = std::clamp(y, 0, static_cast<int>(small.height) - 1);
        return small.pixels[3 * static_cast<std::size_t>(py * static_cast<int>(small.width) + px) + c];
    };
    for (uint32_t y = 0; y < large.height; ++y) {
        for (uint32_t x = 0; x < large.width; ++x) {
            const int left = static_cast<int>(x + 1) / 2 - 1, top = static_cast<int>(y + 1) / 2 - 1;
            const float u = x % 2 == 0 ? 0.75f : 0.25f, v = y % 2 == 0 ? 0.75f : 0.25f;
            for (uint32_t c = 0; c < 3; ++c) {
                const float above = at(left, top, c) + u * (at(left + 1, top, c) - at(left, top, c)),
                            below = at(left, top + 1, c) + u * (at(left + 1, top + 1, c) - at(left, top + 1, c));
                large.pixels.push_back(above + v * (below - above));
            }
        }
    }
    return large;
}

/// Returns the mean absolute difference where neighbouring pixels of the reference differ: at edges and in textures.
double error_at_edges(const Image& a, const Image& reference) {
    REQUIRE(a.pixels.size() == reference.pixels.size());
    double sum = 0, count = 0;
    for (std::size_t i = 3; i < a.pixels.size(); ++i) {
        const float light = reference.pixels[i], before = reference.pixels[i - 3];
        if (!(std::abs(light - before) > 0.2f * std::max(light, before))) continue;
        sum += static_cast<double>(std::abs(a.pixels[i] - light));
        count += 1;
    }
    REQUIRE(count > 0);
    return sum / count;
}

} // namespace

TEST_CASE("frames at half the resolution have the same bytes on every device, in every schedule and after a cut") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue cpu = Queue::make_cpu();
    const RenderSettings settings = settings_of(95, 63);
    Session session(cpu, prepared, mixed_scene_camera(), settings);
    const Hash128 expected = hash_of_traversal(session, 12, scaled(0.5f));
    const Hash128 whole = hash_of_traversal(session, 12, {}); // another scale is a cut
    CHECK(whole != expected);
    CHECK(hash_of_traversal(session, 12, scaled(0.5f)) == expected);
    CHECK(session.frame().picture().width == 95);
    session.frame().display(ToneMap::Agx, 0);
    const Rgba8Image shown = session.frame().displayed();
    REQUIRE(shown.pixels.size() == std::size_t(4) * 95 * 63);
    CHECK(shown.pixels[std::size_t(4) * 95 * 63 - 1] == 255); // the last alpha channel
    Session fresh(cpu, prepared, mixed_scene_camera(), settings);
    CHECK(hash_of_traversal(fresh, 12, {}) == whole);

    RenderSettings wavefront = settings;
    wavefront.body = PathBody::Wavefront;
    wavefront.batch = 1000; // paths begin in several rounds
    Session other(cpu, prepared, mixed_scene_camera(), wavefront);
    CHECK(hash_of_traversal(other, 12, scaled(0.5f)) == expected);
    if (cuda_requested()) {
        Queue cuda = make_cuda_queue();
        Session there(cuda, prepared, mixed_scene_camera(), settings);
        CHECK(hash_of_traversal(there, 12, scaled(0.5f)) == expected);
    }
}

TEST_CASE("at edges a frame upsampled from half the resolution is closer to the picture than an enlarged one") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    Session session(queue, prepared, mixed_scene_camera(), settings_of(96, 64));
    session.render(256);
    const Image reference = session.picture();
    const double led = error_at_edges(mean_of_still(session, scaled(0.5f)), reference);
    const double whole = error_at_edges(mean_of_still(session, {}), reference);
    Session small(queue, prepared, mixed_scene_camera(), settings_of(48, 32));
    const double plain = error_at_edges(doubled(mean_of_still(small, {})), reference);
    MESSAGE("mean error at edges at half the resolution ", led, ", enlarged by straight lines ", plain,
            ", at the whole ", whole);
    CHECK(led < 0.95 * plain); // highlights of the gold sphere are edges, too, but have the low resolution
    CHECK(led < 1.6 * whole);
}
