// ReSTIR is unbiased: the mean over many frames without history is the path tracer's. With history the mean stays
// close.

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "formats/read_scene.h"
#include "render/update_scene.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kRestirWidth = 34, kRestirHeight = 25, kRestirBlocks = 4; // along each side
constexpr ReconstructionSettings kAsTheyAre = {
    .history = 1, .passes = 0, .clamp_fireflies = false, .clamp_history = false, .anti_alias = false};

struct RestirCase {
    std::string name;
    Scene scene;
    Camera camera;
    LightSelection selection = LightSelection::Power;
    uint32_t frames = 256; // enough that the noise is at most about half of the bound
};

RestirCase builtin_case(const std::string& name) {
    Messages messages;
    Scene scene = read_scene(name, {}, messages);
    const Camera camera = scene.cameras.at(0);
    return {name, std::move(scene), camera};
}

/// The mixed scene with only its panorama as light.
RestirCase sky_case() {
    Scene scene = make_mixed_scene();
    scene.lights.clear();
    for (Material& material : scene.materials) material.emission = {0, 0, 0};
    return {"sky", std::move(scene), mixed_scene_camera()};
}

/// The Cornell box with walls of rough plastic and blocks of metal.
RestirCase glossy_case() {
    RestirCase box = builtin_case("cornell-box");
    box.name = "glossy";
    for (std::size_t i = 0; i < box.scene.materials.size(); ++i) {
        Material& material = box.scene.materials[i];
        material.kind = MaterialKind::MetallicRoughness;
        material.metallic = i == 0 ? 0.8f : 0.0f;
        material.roughness = 0.3f;
    }
    return box;
}

/// The Cornell box with a point, a spot and a directional light instead of its emitter.
RestirCase lights_case() {
    RestirCase box = builtin_case("cornell-box");
    box.name = "lights";
    for (Material& material : box.scene.materials) material.emission = {0, 0, 0};
    box.scene.lights = make_mixed_scene().lights;
    const Vec3 places[] = {{0.15f, 0.4f, 0.1f}, {0.45f, 0.5f, 0.2f}, {}};
    const Vec3 directions[] = {
        {0, -1, 0}, {-0.5f, -1, 0.5f}, {0.3f, -0.6f, 1}}; // the directional light enters through the open front
    const float strengths[] = {0.02f, 0.004f, 0.5f};
    for (std::size_t i = 0; i < box.scene.lights.size(); ++i) {
        Light& light = box.scene.lights[i];
        light.position = places[i];
        light.direction = normalize(directions[i]);
        light.intensity = strengths[i] * light.intensity;
    }
    return box;
}

std::vector<RestirCase> restir_cases() {
    std::vector<RestirCase> all;
    all.push_back(builtin_case("cornell-box"));
    all.back().frames = 64; // the noise is at most 0.4 of the bound
    all.push_back(glossy_case());
    all.push_back(sky_case());
    all.back().frames = 384; // the sky is noisy
    all.push_back(lights_case());
    all.push_back(builtin_case("many-lights"));
    all.back().selection = LightSelection::Tree;
    all.back().frames = 128; // the noise is a fifth of the bound
    return all;
}

RenderSettings restir_settings(LightSelection selection = LightSelection::Power) {
    RenderSettings settings;
    settings.path.light_choice = selection;
    settings.width = kRestirWidth, settings.height = kRestirHeight;
    settings.path.max_depth = 3;
    settings.path.mip_maps = MipMaps::Off; // the pictures compared have none
    return settings;
}

/// Sums over pixels and channels of the picture and of its blocks.
struct BlockMeans {
    double whole = 0;
    std::vector<double> blocks = std::vector<double>(kRestirBlocks * kRestirBlocks);

    void add(const Image& image, double scale) {
        for (uint32_t y = 0; y < kRestirHeight; ++y) {
            for (uint32_t x = 0; x < kRestirWidth; ++x) {
                double sum = 0;
                for (int c = 0; c < 3; ++c) sum += static_cast<double>(image.at(x, y)[c]);
                whole += scale * sum;
                blocks[y * kRestirBlocks / kRestirHeight * kRestirBlocks + x * kRestirBlocks / kRestirWidth] +=
                    scale * sum;
            }
        }
    }
};

/// Returns the light of the emitters that the camera's first `samples` rays hit directly. It is noisy for small
/// emitters and the same in frames of the same samples, so pictures are compared without it.
Image emitted_light(Session& session, uint32_t samples) {
    RenderSettings settings = session.settings();
    settings.path.max_depth = 0;
    settings.samples = samples;
    return session.render_separately(session.camera(), settings).picture;
}

/// Returns the scattered light that the path tracer finds with `samples`.
BlockMeans scattered_light(Session& session, const Image& emitted, uint32_t samples) {
    BlockMeans means;
    session.cut();
    session.render(samples);
    means.add(session.picture(), 1);
    means.add(emitted, -1);
    return means;
}

/// Returns the scattered light of `frames` frames, after `settled` frames that are discarded.
BlockMeans scattered_light_in_frames(Session& session, const Image& emitted, const RestirSettings& restir,
                                     uint32_t frames, uint32_t settled) {
    BlockMeans means;
    session.cut();
    for (uint32_t k = 0; k < settled + frames; ++k) {
        session.render_frame(k < settled ? frames + k : k - settled, kAsTheyAre, restir);
        if (k >= settled) means.add(session.frame().picture(), 1.0 / frames);
    }
    means.add(emitted, -1);
    return means;
}

void check_equal_light(const BlockMeans& means, const BlockMeans& expected, double whole, double block) {
    CHECK(expected.whole > 0);
    CHECK(means.whole == doctest::Approx(expected.whole).epsilon(whole));
    for (std::size_t i = 0; i < means.blocks.size(); ++i) {
        CAPTURE(i);
        // Dark blocks have a few bright pixels, so the difference is also taken relative to the blocks' mean.
        const double least = 0.01 * expected.whole / (kRestirBlocks * kRestirBlocks);
        CHECK(std::fabs(means.blocks[i] - expected.blocks[i]) <= block * expected.blocks[i] + least);
    }
}

} // namespace

TEST_CASE("without history the mean over frames with ReSTIR equals the path tracer's") {
    for (const RestirCase& c : restir_cases()) {
        CAPTURE(c.name);
        Messages messages;
        const PreparedScene prepared = prepare_scene(c.scene, {}, messages);
        Queue queue = requested_queue();
        Session session(queue, prepared, c.camera, restir_settings(c.selection));
        // The samples are the same, so the light that ReSTIR leaves to paths has the same noise.
        const auto frames = static_cast<uint32_t>(effort(c.frames, 8192));
        const Image emitted = emitted_light(session, frames);
        const BlockMeans expected = scattered_light(session, emitted, frames);
        for (const RestirLight light : {RestirLight::Direct, RestirLight::Indirect}) {
            // Indirect resampling uses the stages of direct resampling, so Direct needs only a few scenes.
            if (frames < 8192 && light == RestirLight::Direct && c.name != "cornell-box" && c.name != "sky") continue;
            CAPTURE(static_cast<int>(light));
            const RestirSettings restir = {.light = light, .radius = 6, .history = 0};
            check_equal_light(scattered_light_in_frames(session, emitted, restir, frames, 0), expected, 0.005, 0.03);
        }
    }
}

TEST_CASE("with history the mean over frames with ReSTIR stays close to the path tracer's") {
    for (const RestirCase& c : {builtin_case("cornell-box"), builtin_case("many-lights")}) {
        CAPTURE(c.name);
        Messages messages;
        const PreparedScene prepared = prepare_scene(c.scene, {}, messages);
        Queue queue = requested_queue();
        Session session(queue, prepared, c.camera, restir_settings());
        const auto frames = static_cast<uint32_t>(effort(192, 8192));
        const Image emitted = emitted_light(session, frames);
        const BlockMeans expected = scattered_light(session, emitted, frames);
        const RestirSettings restir = {.light = RestirLight::Indirect, .radius = 6};
        // Frames share samples with the twenty before, so their mean is noisier.
        check_equal_light(scattered_light_in_frames(session, emitted, restir, frames, 20), expected, 0.015, 0.06);
    }
}

TEST_CASE("while an emitter moves the mean over frames with ReSTIR stays close to the path tracer's") {
    constexpr uint32_t kMoving = 48;
    const auto mean_of_motion = [&](const RestirSettings& restir) {
        Messages messages;
        RestirCase box = builtin_case("cornell-box");
        const uint32_t emitter = static_cast<uint32_t>(box.scene.instances.size() - 1);
        PreparedScene prepared = prepare_scene(box.scene, {}, messages);
        Queue queue = requested_queue();
        Session session(queue, prepared, box.camera, restir_settings());
        BlockMeans means;
        for (uint32_t k = 0; k < kMoving; ++k) {
            if (k > 0) {
                box.scene.instances[emitter].world_from_local.translation += Vec3{0.002f, -0.003f, -0.002f};
                SceneUpdate update;
                update.moved_instances = {emitter};
                prepared = update_scene(prepared, box.scene, update, messages);
                session.update_scene(prepared, parts_of(update));
            }
            session.render_frame(k, kAsTheyAre, restir);
            means.add(session.frame().picture(), 1.0 / kMoving);
        }
        return means;
    };
    const BlockMeans expected = mean_of_motion({});
    check_equal_light(mean_of_motion({.light = RestirLight::Indirect, .radius = 6}), expected, 0.03, 0.25);
    check_equal_light(mean_of_motion({.light = RestirLight::Indirect, .radius = 6, .history = 0}), expected, 0.03,
                      0.25);
}
