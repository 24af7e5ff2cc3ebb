// Pictures at rest on a slow machine (rest_growth.h, session_frames.h), and the shape of windows (window_shape.h).

#include <vector>

#include <doctest/doctest.h>

#include "apps/viewer/session_frames.h"
#include "apps/viewer/window_shape.h"
#include "image/picture_hash.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace viewer_growth_test { // test files are compiled together

/// The scales of a growing picture on a machine whose samples take `full_s`.
std::vector<float> scales(double full_s, float shown, bool has_whole) {
    RestGrowth growth;
    growth.begin(shown, full_s);
    std::vector<float> all;
    while (const auto scale = growth.next(has_whole)) {
        all.push_back(*scale);
        growth.took(*scale, full_s * static_cast<double>(*scale * *scale));
        growth.showed(*scale);
    }
    return all;
}

struct WatchedGrowth {
    Queue queue = test::requested_queue();
    Messages messages;
    MovingScene scene{test::make_mixed_scene(), std::nullopt, {}, messages};
    FrameRequest request;

    WatchedGrowth() {
        request.camera = test::mixed_scene_camera();
        RenderSettings& picture = request.view.options.render;
        picture.width = 48, picture.height = 32;
        picture.samples = 12; // too few samples to precede them with a full-size frame
        picture.path.max_depth = 3;
        request.view.lens = request.camera;
    }
    Session session() { return {queue, scene.prepared(), request.camera, request.view.options.render}; }
    std::string hash_alone() {
        Session plain = session();
        plain.render(request.view.options.render.samples);
        return picture_hash(plain.picture()).hex();
    }
};

TEST_CASE("a picture at rest grows through middle sizes on a slow machine, and accumulates at once on a fast one") {
    CHECK(scales(0.4, 0, true).empty());
    CHECK(scales(14, 0, false) == std::vector<float>{0.125f, 0.25f, 0.5f});
    CHECK(scales(14, 0, true) == std::vector<float>{0.125f, 0.25f, 0.5f, 1});
    CHECK(scales(14, 0.0625f, false) == std::vector<float>{0.125f, 0.25f, 0.5f}); // follows frames in motion
    CHECK(scales(14, 0.1875f, false) == std::vector<float>{0.25f, 0.5f});
    CHECK(scales(80, 0, false) == std::vector<float>{0.03125f, 0.0625f, 0.125f, 0.25f, 0.5f});
    CHECK(scales(1.5, 0, false) == std::vector<float>{0.25f, 0.5f});
    CHECK(scales(1e6, 0, false).front() == 0.03125f);
    for (const double full_s : {1.5, 14.0, 80.0, 200.0}) {
        CAPTURE(full_s);
        double before_samples = 0;
        for (const float scale : scales(full_s, 0, false))
            before_samples += static_cast<double>(scale * scale) * full_s;
        CHECK(before_samples < full_s / 3);
        const float first = scales(full_s, 0, false).front();
        CHECK(static_cast<double>(first * first) * full_s <= 0.25); // a new setting is shown within a second
    }
}

TEST_CASE("a picture has the window's aspect and at most the requested pixels and the window's") {
    CHECK(size_for_window(1280, 720, 1280 * 720) == PictureSize{1280, 720});
    CHECK(size_for_window(3840, 2160, 1280 * 720) == PictureSize{1280, 720});
    CHECK(size_for_window(800, 600, 1280 * 720) == PictureSize{800, 600});
    CHECK(size_for_window(801, 601, 1280 * 720) == PictureSize{800, 600});
    CHECK(size_for_window(1, 1, 1280 * 720) == PictureSize{16, 16});
    CHECK(size_for_window(65535, 100, 1280 * 720) == PictureSize{400, 100}); // the window is a strip
    for (const auto& [width, height] : {std::pair{390u, 844u}, {1366u, 657u}, {2560u, 1303u}, {1170u, 2532u}}) {
        CAPTURE(width);
        const PictureSize size = size_for_window(width, height, 1280 * 720);
        CHECK(uint64_t(size.width) * size.height <= 1280 * 720);
        CHECK(size.width % 2 + size.height % 2 == 0);
        const double across = double(size.width) / width, down = double(size.height) / height;
        CHECK(across / down == doctest::Approx(1).epsilon(0.006));
        CHECK(across <= 1);
    }
    ViewState view;
    CHECK_FALSE(resize_to_window(view, 64, 48)); // its size was requested
    CHECK(view.options.render.width == 1280);
    view.window_pixels = 1280 * 720;
    CHECK(resize_to_window(view, 640, 480));
    CHECK(view.options.render.height == 480);
    CHECK_FALSE(resize_to_window(view, 640, 480));
}

TEST_CASE("growing pictures precede the samples of a new view and do not affect the film") {
    WatchedGrowth watched;
    FrameRequest& request = watched.request;
    request.budget_s = 100;
    const std::string at_rest = watched.hash_alone();
    for (const IntegratorKind integrator : {IntegratorKind::Path, IntegratorKind::Distributed}) {
        CAPTURE(static_cast<int>(integrator));
        request.view.options.render.integrator = integrator;
        Session session = watched.session();
        SessionFrames frames(session, watched.scene, 0.1, 0); // every sample takes long
        const auto gather = [&] {
            std::vector<uint32_t> widths;
            std::optional<ShownFrame> shown;
            while (!shown || !shown->is_final) {
                shown = frames.next(request);
                if (!shown) continue;
                if (widths.empty() || widths.back() != shown->image.width) widths.push_back(shown->image.width);
                CHECK(shown->full_width == 48);
                CHECK(shown->is_reference == !shown->hash.empty());
            }
            CHECK(std::ranges::is_sorted(widths));
            CHECK(widths.back() == 48);
            return std::pair{widths.size(), shown->hash};
        };
        request.is_moving = true;
        frames.next(request);
        request.is_moving = false;
        const auto [sizes, hash] = gather();
        CHECK(sizes >= 2);
        CHECK((hash == at_rest) == (integrator == IntegratorKind::Path));
        CHECK(gather().first == 1); // the picture is complete
        request.view.options.render.path.max_depth = 2;
        CHECK(gather().first >= 2); // a new setting is first shown as a small picture
        request.view.options.render.path.max_depth = 3;
        CHECK(gather().second == hash);
        request.view.options.render.samples = 15; // more samples of the same picture need no small picture
        CHECK(gather().first == 1);
        request.view.options.render.samples = 12; // too few samples to precede them with a full-size frame
    }
}

TEST_CASE("a change of exposure waits for no sample and loses no complete sample") {
    WatchedGrowth watched;
    if (watched.queue.is_cuda()) return; // a GPU's samples are short
    FrameRequest& request = watched.request;
    const std::string at_rest = watched.hash_alone();
    Session session = watched.session();
    SessionFrames frames(session, watched.scene, 0.1, 0);
    request.is_moving = true;
    frames.next(request);
    request.is_moving = false;
    request.budget_s = 1e-9; // a pass at a time
    while (session.history().samples < 3 || session.settings().width < 48) frames.next(request);
    const uint32_t before = session.history().samples;
    frames.hurry() = true;
    CHECK_FALSE(frames.next(request).has_value()); // is interrupted, and the samples are kept
    CHECK(session.history().samples == before);
    frames.hurry() = false;
    request.view.display.exposure_stops = 2;
    const std::optional<ShownFrame> brighter = frames.next(request);
    REQUIRE(brighter.has_value());
    CHECK(brighter->exposure_stops == 2);
    CHECK(session.history().samples == before);
    request.budget_s = 100;
    std::optional<ShownFrame> rests;
    while (!rests || !rests->is_final) rests = frames.next(request);
    CHECK(rests->hash == at_rest);
    // Interrupted frames begin again.
    request.view.options.render.path.max_depth = 2;
    frames.hurry() = true;
    CHECK_FALSE(frames.next(request).has_value());
    frames.hurry() = false;
    CHECK(frames.next(request).has_value());
}

} // namespace viewer_growth_test
