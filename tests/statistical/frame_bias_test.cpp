// The bias of each biased part of real-time frames (docs/real_time.md, "Bias"). A still camera's frames are compared
// with frames of the same samples without that part, so that most of the noise is the same.

#include <doctest/doctest.h>

#include <cmath>
#include <deque>
#include <string>
#include <vector>

#include "formats/read_scene.h"
#include "scene/tangents/make_tangents.h"
#include "session/session.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/layered_balls.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/solid_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kBiasWidth = 64, kBiasHeight = 48, kBiasBlocks = 4; // along each side
constexpr uint32_t kSettled = 16, kCounted = 48; // the numbers of frames before the mean and in the mean

RenderSettings bias_settings() {
    RenderSettings settings;
    settings.width = kBiasWidth, settings.height = kBiasHeight;
    settings.path.max_depth = 4;
    return settings;
}

struct BiasScene {
    std::string name;
    Scene scene;
    Camera camera;
};

std::vector<BiasScene> bias_scenes() {
    Messages messages;
    std::vector<BiasScene> all = {{"mixed", make_mixed_scene(), mixed_scene_camera()}};
    Scene box = read_scene("cornell-box", {}, messages);
    const Camera camera = box.cameras.at(0);
    all.push_back({"cornell-box", std::move(box), camera});
    return all;
}

Image mean_of_frames(Session& session, const ReconstructionSettings& settings, const RestirSettings& restir = {},
                     uint32_t settled = kSettled, uint32_t counted = kCounted) {
    session.cut();
    Image mean;
    for (uint32_t k = 0; k < settled + counted; ++k) {
        session.render_frame(k, settings, restir);
        if (k < settled) continue;
        const Image picture = session.frame().picture();
        if (k == settled) mean = Image{picture.width, picture.height, 3, std::vector<float>(picture.pixels.size())};
        for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
            mean.pixels[i] += picture.pixels[i] / static_cast<float>(counted);
        }
    }
    return mean;
}

/// The deviations of one mean from another, relative to the other's light. Visible emitters are left out, because a
/// few of their pixels would dominate.
struct Bias {
    double whole = 0;     // the deviation of the picture's mean; negative if darker
    double of_block = 0;  // the largest deviation of a sixteenth of the picture that has at least a tenth of the mean
    double of_pixels = 0; // the mean absolute difference of pixels
    double with_emitters = 0; // `whole` with emitters
};

Bias bias_of(const Image& mean, const Image& expected) {
    std::vector<double> ours(kBiasBlocks * kBiasBlocks), theirs(ours.size());
    const auto emitter = static_cast<float>(4 * mean_of(expected)); // radiance
    double sum = 0, expected_sum = 0, sizes = 0;
    for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
        const auto pixel = static_cast<uint32_t>(i / 3);
        if (expected.pixels[3 * pixel + 1] > emitter) continue;
        const uint32_t x = pixel % mean.width, y = pixel / mean.width;
        const uint32_t block = y * kBiasBlocks / mean.height * kBiasBlocks + x * kBiasBlocks / mean.width;
        const double a = static_cast<double>(mean.pixels[i]), b = static_cast<double>(expected.pixels[i]);
        ours[block] += a, theirs[block] += b;
        sum += a, expected_sum += b;
        sizes += std::abs(a - b);
    }
    Bias bias = {sum / expected_sum - 1, 0, sizes / expected_sum, mean_of(mean) / mean_of(expected) - 1};
    for (std::size_t i = 0; i < ours.size(); ++i) {
        if (theirs[i] < 0.1 * expected_sum / static_cast<double>(ours.size())) continue;
        bias.of_block = std::max(bias.of_block, std::abs(ours[i] / theirs[i] - 1));
    }
    return bias;
}

/// Turns off everything except the mean over time.
ReconstructionSettings history_alone() {
    ReconstructionSettings settings = of_samples_alone({});
    settings.history = 32;
    return settings;
}

void print_bias(const std::string& scene, const std::string& part, const Bias& bias) {
    MESSAGE(scene, ", ", part, ": whole ", bias.whole, ", block ", bias.of_block, ", pixels ", bias.of_pixels,
            ", with emitters ", bias.with_emitters);
}

/// Returns the mean of the frames of a scene of bias_scenes(). It is rendered once, because several cases need it.
const Image& known_mean(Session& session, const std::string& scene, const ReconstructionSettings& settings) {
    struct KnownMean {
        std::string scene;
        ReconstructionSettings settings;
        Image mean;
    };
    static std::deque<KnownMean> all; // a deque, so that references stay valid
    for (const KnownMean& known : all) {
        if (known.scene == scene && known.settings == settings) return known.mean;
    }
    return all.emplace_back(KnownMean{scene, settings, mean_of_frames(session, settings)}).mean;
}

struct Part {
    std::string name;
    ReconstructionSettings with;
    Bias most;
};

/// Tests bounds of the bias in each scene. The settings `without` differ from `with` only by the part.
void bound_bias(const ReconstructionSettings& without, const std::vector<Part>& parts) {
    for (const BiasScene& s : bias_scenes()) {
        Messages messages;
        const PreparedScene prepared = prepare_scene(s.scene, {}, messages);
        Queue queue = requested_queue();
        Session session(queue, prepared, s.camera, bias_settings());
        const Image& expected = known_mean(session, s.name, without);
        for (const Part& part : parts) {
            const Bias bias = bias_of(known_mean(session, s.name, part.with), expected);
            CAPTURE(s.name);
            CAPTURE(part.name);
            print_bias(s.name, part.name, bias);
            CHECK(std::abs(bias.whole) <= part.most.whole);
            CHECK(bias.of_block <= part.most.of_block);
            CHECK(bias.of_pixels <= part.most.of_pixels);
            CHECK(bias.with_emitters <= part.most.whole); // their edges may lose light, but gain none
        }
    }
}

ReconstructionSettings with_passes(uint32_t passes) {
    ReconstructionSettings settings = history_alone();
    settings.passes = passes;
    return settings;
}

} // namespace

TEST_CASE("the wavelet filter preserves the mean light") {
    bound_bias(history_alone(), {{"1 pass", with_passes(1), {0.01, 0.08, 0.055}},
                                 {"5 passes", with_passes(5), {0.015, 0.14, 0.18}},
                                 {"8 passes", with_passes(8), {0.03, 0.22, 0.18}}});
}

TEST_CASE("clamping of fireflies and of history each lose little light") {
    ReconstructionSettings fireflies = history_alone(), held = history_alone();
    fireflies.clamp_fireflies = true;
    held.clamp_history = true;
    bound_bias(history_alone(),
               {{"clamp_fireflies", fireflies, {0.002, 0.014, 0.002}}, {"clamp_history", held, {0.002, 0.014, 0.002}}});
}

TEST_CASE("anti-aliasing and a lower resolution each lose little light") {
    ReconstructionSettings smooth = with_passes(5), coarse = smooth, coarser = smooth;
    smooth.anti_alias = true;
    coarse.resolution_scale = 0.5f;
    coarser.resolution_scale = 0.25f;
    bound_bias(with_passes(5), {{"anti_alias", smooth, {0.04, 0.21, 0.055}},
                                {"half the resolution", coarse, {0.035, 0.2, 0.15}},
                                {"a quarter of it", coarser, {0.08, 0.65, 0.24}}});
}

namespace {

/// Returns a normal map of steep waves in both directions.
TextureImage wavy_normals() {
    TextureImage image;
    image.name = "waves";
    image.rgba8 = {16, 16, {}};
    for (uint32_t i = 0; i < 256; ++i) {
        const float x = std::sin(static_cast<float>(i % 16) * 0.7854f),
                    y = std::sin(static_cast<float>(i / 16) * 0.3927f);
        const Vec3 n = normalize(Vec3{0.8f * x, 0.8f * y, 1});
        for (const float c : {n.x, n.y, n.z, 1.0f}) {
            image.rgba8.pixels.push_back(static_cast<uint8_t>(std::lround(127.5f + 127.5f * c)));
        }
    }
    return image;
}

/// The mixed scene with Fresnel layers on all diffuse surfaces and waves on all surfaces with texture coordinates,
/// seen from just above its floor. Its spheres have interpolated normals.
BiasScene bent_normals() {
    BiasScene bent = {"bent normals", make_mixed_scene(), {}};
    bent.scene.images.push_back(wavy_normals());
    for (Material& material : bent.scene.materials) {
        if (material.is_emitter()) continue;
        material.kind = MaterialKind::MetallicRoughness;
        material.metallic = 0;
        material.roughness = 0.3f;
        material.normal_texture = {.image = 1, .m00 = 4, .m11 = 4};
    }
    make_tangents(bent.scene);
    bent.camera.world_from_camera = look_at({0.3f, 0.25f, 5}, {0, 0.3f, 0}, {0, 1, 0});
    bent.camera.fov_y = 0.7f;
    return bent;
}

} // namespace

TEST_CASE("shared bounces at bent normals lose little light at grazing angles") {
    const BiasScene bent = bent_normals();
    Messages messages;
    const PreparedScene prepared = prepare_scene(bent.scene, {}, messages);
    Queue queue = requested_queue();
    RenderSettings settings = bias_settings();
    settings.width = 32, settings.height = 24;
    Session session(queue, prepared, bent.camera, settings);
    const auto frames = static_cast<uint32_t>(effort(128, 8192));
    const Image expected = mean_of_frames(session, of_samples_alone({}), {}, 0, frames);
    for (const RestirLight light : {RestirLight::Direct, RestirLight::Indirect}) {
        const RestirSettings restir = {.light = light, .radius = 6, .history = 0};
        const Bias bias = bias_of(mean_of_frames(session, of_samples_alone({}), restir, 0, frames), expected);
        print_bias(bent.name, light == RestirLight::Direct ? "di" : "gi", bias);
        CHECK(std::abs(bias.whole) < 0.01);
        CHECK(bias.of_block < 0.04);
    }
}

TEST_CASE("the filter and ReSTIR preserve the light of each kind of lobe") {
    const LayeredBalls balls = layered_balls();
    Messages messages;
    const PreparedScene prepared = prepare_scene(balls.scene, {}, messages);
    Queue queue = requested_queue();
    RenderSettings settings = bias_settings();
    settings.width = 48, settings.height = 36;
    settings.samples = static_cast<uint32_t>(effort(48, 2048));
    const Image film = render_picture(queue, prepared, balls.camera, settings).picture;
    Session session(queue, prepared, balls.camera, settings);
    const auto compare = [&](const std::string& part, const Image& mean, const Image& wanted, const Bias& most) {
        const Bias bias = bias_of(mean, wanted);
        CAPTURE(part);
        print_bias("layers", part, bias);
        CHECK(std::abs(bias.whole) <= most.whole);
        CHECK(bias.of_block <= most.of_block);
    };
    const auto mean_with = [&](const RestirSettings& restir) {
        return mean_of_frames(session, of_samples_alone({}), restir, 0, settings.samples);
    };
    const Image alone = mean_with({});
    compare("split light", alone, film, {0.003, 0.02});
    const Image direct = mean_with({.light = RestirLight::Direct, .radius = 6, .history = 0});
    compare("di", direct, alone, {0.005, 0.06});
    // The direct light of both is the same.
    compare("gi", mean_with({.light = RestirLight::Indirect, .radius = 6, .history = 0}), direct, {0.001, 0.006});
    const auto filtered = [&](uint32_t passes) { return mean_of_frames(session, with_passes(passes), {}, 8, 24); };
    const Image unfiltered = filtered(0);
    compare("1 pass", filtered(1), unfiltered, {0.003, 0.035});
    compare("5 passes", filtered(5), unfiltered, {0.02, 0.25}); // it blurs the balls' dark sides, as Lambert's
}

TEST_CASE("light beneath a layer with Fresnel reflection does not lag behind a rising camera") {
    Scene scene;
    add(scene, floor_at(0, 50),
        {{.kind = MaterialKind::MetallicRoughness, .base_color = grey(0.8f), .metallic = 0, .roughness = 0.7f},
         "varnished"});
    scene.environment = Environment{};
    constexpr uint32_t kTurn = 32, kTimes = 4; // the frames per turn and the number of turns, each with other samples
    const auto camera_at = [](uint32_t frame) {
        const float angle = 0.05f + 1.3f * static_cast<float>(frame) / static_cast<float>(kTurn - 1);
        Camera camera;
        camera.world_from_camera = look_at({0, 5 * std::sin(angle), 5 * std::cos(angle)}, {0, 0, 0}, {0, 1, 0});
        camera.fov_y = 0.6f;
        return camera;
    };
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    Session session(queue, prepared, camera_at(kTurn - 1), bias_settings());
    const Image expected = mean_of_frames(session, of_samples_alone({}), {}, 0, 128);
    Image mean = {expected.width, expected.height, 3, std::vector<float>(expected.pixels.size())};
    for (uint32_t turn = 0; turn < kTimes; ++turn) {
        session.cut();
        for (uint32_t k = 0; k < kTurn; ++k) {
            session.set_camera(camera_at(k));
            session.render_frame(turn * kTurn + k, history_alone());
        }
        const Image last = session.frame().picture();
        for (std::size_t i = 0; i < mean.pixels.size(); ++i) mean.pixels[i] += last.pixels[i] / kTimes;
    }
    const Bias bias = bias_of(mean, expected);
    print_bias("layers", "a camera that rises", bias);
    CHECK(std::abs(bias.whole) < 0.005);
    CHECK(bias.of_block < 0.01);
}

TEST_CASE("clamped shared bounces carry the light of clamped paths") {
    for (const BiasScene& s : bias_scenes()) {
        Messages messages;
        const PreparedScene prepared = prepare_scene(s.scene, {}, messages);
        Queue queue = requested_queue();
        RenderSettings settings = bias_settings();
        settings.width = 32, settings.height = 24;
        const auto frames = static_cast<uint32_t>(effort(64, 4096));
        const auto mean_with = [&](float clamp, RestirLight light) {
            settings.path.clamp = clamp;
            Session session(queue, prepared, s.camera, settings);
            const RestirSettings restir = {.light = light, .radius = 6, .history = 0};
            return mean_of(mean_of_frames(session, of_samples_alone({}), restir, 0, frames));
        };
        constexpr float kClamp = 0.1f;
        const double all = mean_with(0, RestirLight::Off), clamped = mean_with(kClamp, RestirLight::Off);
        const double direct = mean_with(kClamp, RestirLight::Direct), shared = mean_with(kClamp, RestirLight::Indirect);
        MESSAGE(s.name, ": all ", all, ", clamped ", clamped, ", di ", direct, ", gi ", shared);
        CHECK(clamped < 0.97 * all);
        CHECK(direct == doctest::Approx(clamped).epsilon(0.02)); // this path scatters once and is not clamped
        CHECK(shared == doctest::Approx(clamped).epsilon(0.02)); // equals the emitted light with the earlier clamp
    }
}
