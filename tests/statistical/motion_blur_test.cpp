// Motion blur against closed forms, and against the mean of still pictures.

#include <doctest/doctest.h>

#include <cmath>

#include "math/portable_math.h"
#include "scene/validate/validate.h"
#include "session/moving_scene.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr Shutter kASecond = {0, 1};

/// The part `share` of a disc of radius 1/2 about the origin that faces +z, beginning at the x-axis.
Mesh disc(double share) {
    constexpr int kEdges = 512;
    Mesh mesh;
    mesh.positions.push_back({0, 0, 0});
    for (int i = 0; i <= kEdges; ++i) {
        const double angle = 2 * 3.14159265358979 * share * i / kEdges;
        mesh.positions.push_back(
            {static_cast<float>(0.5 * std::cos(angle)), static_cast<float>(0.5 * std::sin(angle)), 0});
    }
    for (uint32_t i = 1; i <= kEdges; ++i) mesh.indices.insert(mesh.indices.end(), {0, i, i + 1});
    return mesh;
}

/// An unlit white mesh on a node. An animation of a second changes the node's `part` from `begin` to `end`.
Scene unlit_scene(Mesh mesh, AnimatedPart part, std::vector<float> begin, const std::vector<float>& end) {
    Scene scene;
    test::add(scene, std::move(mesh), {{.kind = MaterialKind::Unlit, .base_color = {1, 1, 1}}, "white"});
    scene.nodes.resize(1);
    scene.instances[0].node = 0;
    begin.insert(begin.end(), end.begin(), end.end());
    scene.animations.emplace_back();
    scene.animations[0].channels.push_back({0, part, Interpolation::Linear, {0, 1}, std::move(begin)});
    Messages messages;
    validate(scene, "unlit", messages);
    return scene;
}

Camera flat_camera() {
    Camera camera;
    camera.projection = Projection::Orthographic;
    camera.world_from_camera = make_translation({0, 0, 5});
    camera.ortho_height = 1.25f;
    return camera;
}

/// Renders 64x20 pixels with samples at their centres, which are (x - 31.5) / 16, (9.5 - y) / 16 metres from the
/// origin.
Image picture_of(const MovingScene& moving, const Camera& camera) {
    RenderSettings settings;
    settings.width = 64, settings.height = 20;
    settings.samples = 1024;
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0x1p-20f;
    Queue queue = test::requested_queue();
    return render_picture(queue, moving.prepared(), camera, settings).picture;
}

template <class ShareAt>
void check_shares(const Image& picture, const ShareAt& share_at) {
    double worst = 0, sum = 0;
    for (uint32_t y = 0; y < picture.height; ++y) {
        for (uint32_t x = 0; x < picture.width; ++x) {
            const double wanted = share_at((x - 31.5) / 16, (9.5 - y) / 16);
            const double seen = static_cast<double>(picture.pixels[3 * (std::size_t(y) * picture.width + x)]);
            worst = std::max(worst, std::fabs(seen - wanted));
            sum += wanted;
        }
    }
    CHECK(worst < 0.004); // 4 of 1024 samples
    CHECK(sum > 100);
}

/// Returns the share of a second in which a disc that moves from x = -1 to 1 covers a point.
double share_of_disc(double x, double y) {
    const double half = std::sqrt(std::max(0.25 - y * y, 0.0));
    const double from = std::clamp((x + 1 - half) / 2, 0.0, 1.0), to = std::clamp((x + 1 + half) / 2, 0.0, 1.0);
    return to - from;
}

/// A moving emitter and a moving glossy block over a floor.
Scene make_lit_scene() {
    Scene scene;
    test::add(scene, test::floor_at(0, 2), test::white(0.7f));
    test::add(scene, test::sheet({0, 0, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}),
              {{.base_color = {0, 0, 0}, .emission = {5, 4, 3}}, "lamp"});
    test::add(
        scene, test::sheet({0, 0, 0}, {0.5f, 0, 0}, {0, 0.4f, -0.2f}),
        {{.kind = MaterialKind::MetallicRoughness, .base_color = {0.3f, 0.5f, 0.7f}, .roughness = 0.3f}, "plastic"});
    scene.nodes.resize(2);
    scene.instances[1].node = 0, scene.instances[2].node = 1;
    scene.animations.emplace_back();
    auto& channels = scene.animations[0].channels;
    const auto add = [&](uint32_t node, AnimatedPart part, std::vector<float> values) {
        channels.push_back({node, part, Interpolation::Linear, {0, 1}, std::move(values)});
    };
    add(0, AnimatedPart::Translation, {-0.8f, 1, 0, 0.8f, 1.5f, 0});
    add(0, AnimatedPart::Rotation, {0, 0, 0.2f, 0.98f, 0, 0, -0.3f, 0.95f}); // faces down at both ends
    add(1, AnimatedPart::Translation, {-0.5f, 0.5f, -0.3f, 0.4f, 0.6f, -0.3f});
    add(1, AnimatedPart::Rotation, {0, 0, 0, 1, 0, 0.5f, 0, 0.8660254f});
    Messages messages;
    validate(scene, "lit", messages);
    return scene;
}

Camera lit_camera() {
    Camera camera;
    camera.world_from_camera = look_at({0, 1.2f, 3}, {0, 0.5f, 0}, {0, 1, 0});
    camera.fov_y = 0.8f;
    return camera;
}

RenderSettings lit_settings(IntegratorKind integrator) {
    RenderSettings settings;
    settings.width = 20, settings.height = 14;
    settings.integrator = integrator;
    settings.path.max_depth = 3;
    return settings;
}

/// Estimates the picture from still pictures at random times while the shutter is open.
test::PictureEstimate estimate_of_moments(Queue& queue, MovingScene& moving, const Camera& camera,
                                          RenderSettings settings, uint32_t renders) {
    test::Random random(5);
    settings.path.sampler = SamplerKind::Independent;
    Messages messages;
    return test::estimate_of(renders, [&](uint32_t number) {
        moving.set_time(static_cast<double>(random.unit()), messages);
        settings.path.seed = number;
        return render_picture(queue, moving.prepared(), camera, settings).picture;
    });
}

} // namespace

TEST_CASE("a moving disc is blurred by the share of time in which it covers a point") {
    Messages messages;
    const Scene scene = unlit_scene(disc(1), AnimatedPart::Translation, {-1, 0, 0}, {1, 0, 0});
    const MovingScene moving(scene, 0, {}, messages, kASecond);
    check_shares(picture_of(moving, flat_camera()), share_of_disc);

    // A camera that moves in the opposite direction has the same picture.
    MovingScene still(scene, 0.5, {}, messages, Shutter{0, 0});
    Camera camera = flat_camera();
    camera.motion = {{{0, 0, 0, 1}, {1, 0, 5}}, {{0, 0, 0, 1}, {-1, 0, 5}}};
    check_shares(picture_of(still, camera), share_of_disc);

    // The shutter opens before the picture's time, for the last quarter of the motion.
    const MovingScene late(scene, 1, {}, messages, Shutter{-0.25, 0});
    check_shares(picture_of(late, flat_camera()), [](double x, double y) {
        const double half = std::sqrt(std::max(0.25 - y * y, 0.0));
        const double from = std::clamp((x - 0.5 - half) / 0.5, 0.0, 1.0),
                     to = std::clamp((x - 0.5 + half) / 0.5, 0.0, 1.0);
        return to - from;
    });
}

TEST_CASE("a turning half disc is blurred evenly over the angle") {
    Messages messages;
    // During a quarter turn about z the half disc covers the angles [turn, turn + 180 degrees].
    const float half = 0.70710678f;
    const Scene scene = unlit_scene(disc(0.5), AnimatedPart::Rotation, {0, 0, 0, 1}, {0, 0, half, half});
    const MovingScene moving(scene, 0, {}, messages, kASecond);
    CHECK(moving.prepared().motions->segments > 1);
    check_shares(picture_of(moving, flat_camera()), [](double x, double y) {
        const double radius = std::sqrt(x * x + y * y), pi = 3.14159265358979;
        if (radius > 0.5) return 0.0;
        double angle = std::atan2(y, x); // (-pi, pi]
        if (angle < -pi / 2) return 1 - (angle + pi) / (pi / 2);
        if (angle < 0) return 0.0;
        return angle < pi / 2 ? angle / (pi / 2) : angle <= pi ? 1.0 : 0.0;
    });
}

TEST_CASE("a picture with motion blur is the mean of the pictures at all times") {
    Queue queue = test::requested_queue();
    Messages messages;
    const auto moments = static_cast<uint32_t>(test::effort(300, 4000));
    for (const IntegratorKind integrator : {IntegratorKind::Path, IntegratorKind::Distributed}) {
        CAPTURE(static_cast<int>(integrator));
        MovingScene moving(make_lit_scene(), 0, {}, messages, kASecond), single(make_lit_scene(), 0, {}, messages);
        RenderSettings settings = lit_settings(integrator);
        settings.samples = moments / 10;
        const test::PictureEstimate blurred =
            test::estimate_picture(queue, moving.prepared(), lit_camera(), settings, 40, 1000);
        settings.samples = 8;
        const test::PictureEstimate wanted = estimate_of_moments(queue, single, lit_camera(), settings, moments);
        CHECK(test::p_value(blurred, wanted) > 1e-3);
        CHECK(test::p_value(test::brightened(blurred, 1.15, 0), wanted) < 1e-3);
    }
}

TEST_CASE("light sampling and BSDF sampling agree on moving emitters") {
    Queue queue = test::requested_queue();
    Messages messages;
    Scene scene = make_lit_scene();
    // The emitter turns far, because the density of a point on it depends on its orientation, not on its position.
    scene.animations[0].channels[1].values = {0, 0, 0.6f, 0.8f, 0, 0, -0.6f, 0.8f};
    const MovingScene moving(scene, 0, {}, messages, kASecond);
    const auto estimate_by = [&](LightStrategy strategy, uint32_t seed) {
        RenderSettings settings = lit_settings(IntegratorKind::Path);
        const uint64_t more = strategy == LightStrategy::BsdfOnly ? 10 : 1; // few of these paths find the emitter
        settings.samples = static_cast<uint32_t>(more * test::effort(16, 128));
        settings.path.max_depth = 1;
        settings.path.strategy = strategy;
        return test::estimate_picture(queue, moving.prepared(), lit_camera(), settings, 40, seed);
    };
    const test::PictureEstimate both = estimate_by(LightStrategy::Mis, 1);
    const test::PictureEstimate by_light = estimate_by(LightStrategy::NeeOnly, 100);
    CHECK(test::p_value(by_light, both) > 1e-3);
    CHECK(test::p_value(estimate_by(LightStrategy::BsdfOnly, 200), both) > 1e-3);
    CHECK(test::p_value(test::brightened(both, 1.1, 0), by_light) < 1e-3);
}
