// Messages of cast and whitted about scenes with unsupported lights.

#include <doctest/doctest.h>

#include <fmt/format.h>

#include "render/light_paths/light_path_layers.h"
#include "session/check_integrator.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

/// Returns the error or the notice about the scene; without either, an empty reason.
Remark message(IntegratorKind integrator, const Scene& scene, std::optional<Rgb> ambient = {}, uint32_t depth = 4) {
    RenderSettings settings;
    settings.integrator = integrator;
    settings.ambient = ambient;
    settings.path.max_depth = depth;
    Messages messages;
    const auto error = test::thrown_error([&] { check_light(settings, scene, messages); });
    if (error) {
        CHECK(error->code() == ErrorCode::BadInput);
        return error->remark();
    }
    return messages.all().empty() ? Remark("") : messages.all().front().remark;
}
bool is_fine(const Remark& remark) { return remark.reason.empty(); }
bool names(const Remark& remark, const std::string& text) { return remark.reason.find(text) != std::string::npos; }

} // namespace

TEST_CASE("callers of the library get the rules of the table of settings") {
    const auto refusal = [](const auto& change) {
        RenderSettings settings;
        change(settings);
        return test::thrown_error([&] { check_integrator(settings); });
    };
    const auto layers = std::make_shared<LightPathLayers>();
    layers->expressions.emplace_back();
    const auto is_about = [](const std::optional<Error>& error, const char* setting, const char* value = "") {
        return test::is_about(error, ErrorCode::BadInput, setting, value);
    };
    CHECK(!refusal([](RenderSettings& s) { s.denoise = Denoise::Svgf; }));
    CHECK(is_about(refusal([](RenderSettings& s) { s.denoise = Denoise::Svgf, s.aovs = kAovDistance; }), "denoise",
                   "svgf"));
    CHECK(is_about(refusal([](RenderSettings& s) { s.denoise = Denoise::Svgf, s.sample_layers = kLayerVariance; }),
                   "denoise", "svgf"));
    CHECK(is_about(refusal([](RenderSettings& s) { s.denoise = Denoise::Svgf, s.integrator = IntegratorKind::Light; }),
                   "denoise", "svgf"));
    CHECK(is_about(refusal([](RenderSettings& s) { s.layers_at = LayersAt::Centre, s.sample_layers = kLayerUv; }),
                   "layers_at", "centre"));
    CHECK(is_about(refusal([](RenderSettings& s) { s.irradiance = true, s.integrator = IntegratorKind::Light; }),
                   "false_color", "illuminance"));
    for (const bool is_group : {false, true}) {
        const char* const setting = is_group ? "light_group" : "lpe";
        const auto with_layers = [&](RenderSettings& s) {
            s.light_paths = layers;
            if (is_group) s.light_groups = {"a=*"};
        };
        CHECK(!refusal(with_layers));
        CHECK(is_about(refusal([&](RenderSettings& s) { with_layers(s), s.integrator = IntegratorKind::Light; }),
                       setting));
        CHECK(is_about(refusal([&](RenderSettings& s) { with_layers(s), s.denoise = Denoise::Oidn; }), setting));
    }
}

TEST_CASE("a scene that cast or whitted would render black is refused with alternatives") {
    Scene scene;
    test::add(scene, test::floor_at(0, 1), test::white());
    test::add(scene, test::floor_at(1, 1), {{.emission = {1, 1, 1}}, "lamp"});
    for (const auto& [kind, name] :
         {std::pair(IntegratorKind::Cast, "cast"), std::pair(IntegratorKind::Whitted, "whitted")}) {
        const Remark dark = message(kind, scene);
        CHECK(dark.setting == "integrator");
        CHECK(dark.value == name);
        CHECK((names(dark, "`integrator=distributed`") && names(dark, "`ambient=0.5`")));
        CHECK(is_fine(message(kind, scene, Rgb{0, 0, 0}))); // the setting requests it
        CHECK(is_fine(message(kind, scene, {}, 0)));        // shows only emission
    }
    CHECK(is_fine(message(IntegratorKind::Distributed, scene)));
    CHECK(is_fine(message(IntegratorKind::Path, scene)));

    scene.environment = Environment{};
    CHECK(message(IntegratorKind::Cast, scene).value == "cast");
    CHECK_FALSE(is_fine(message(IntegratorKind::Whitted, scene))); // this integrator uses only the environment's mean

    scene.lights.push_back(test::point_light({0, 2, 0}, {1, 1, 1}));
    CHECK(is_fine(message(IntegratorKind::Cast, scene)));
    CHECK(is_fine(message(IntegratorKind::Whitted, scene)));
    scene.lights.front().intensity = {0, 0, 0};
    CHECK_FALSE(is_fine(message(IntegratorKind::Cast, scene)));
}

TEST_CASE(
    "a black environment is no light: integrators that need light refuse the scene, and others warn that it is dark") {
    Scene scene;
    test::add(scene, test::floor_at(0, 1), test::white());
    const std::string none = "no emitter, no point, spot or directional light, and the environment is black";
    const auto check_dark = [&] {
        CHECK(message(IntegratorKind::PhotonMap, scene).value == "photon_map");
        CHECK(names(message(IntegratorKind::PhotonMap, scene), none));
        CHECK(names(message(IntegratorKind::Radiosity, scene), none));
        for (const IntegratorKind kind :
             {IntegratorKind::Path, IntegratorKind::Hybrid, IntegratorKind::Light, IntegratorKind::Bidirectional,
              IntegratorKind::Distributed, IntegratorKind::IrradianceCache}) {
            CHECK(names(message(kind, scene), "nothing in this scene emits light: " + none));
        }
        for (const IntegratorKind kind :
             {IntegratorKind::Cast, IntegratorKind::Whitted, IntegratorKind::Raster, IntegratorKind::Reyes}) {
            CHECK(names(message(kind, scene), "this scene has none"));
            CHECK(is_fine(message(kind, scene, Rgb{1, 1, 1}))); // the setting requests it
        }
    };
    scene.environment = Environment{.image = {}, .scale = {0, 0, 0}, .rotation = 0};
    check_dark();
    scene.environment = Environment{.image = {2, 1, 3, std::vector<float>(6)}, .scale = {1, 1, 1}, .rotation = 0};
    check_dark();
    scene.environment->image.pixels[5] = 1e-6f;
    CHECK(is_fine(message(IntegratorKind::Path, scene)));
    CHECK(is_fine(message(IntegratorKind::PhotonMap, scene)));
    scene.environment->scale.b = 0; // the scene has only this light
    check_dark();
    test::add(scene, test::floor_at(1, 1), {{.emission = {1, 1, 1}}, "lamp"});
    CHECK(is_fine(message(IntegratorKind::Path, scene)));
    CHECK(is_fine(message(IntegratorKind::Radiosity, scene)));
}

TEST_CASE("radiosity names the materials of which it leaves a part out, and no others") {
    Scene scene;
    scene.lights.push_back(test::point_light({0, 2, 0}, {1, 1, 1}));
    const auto add = [&](const char* name, const auto& change) {
        Material material = test::white(0.5f);
        material.name = name;
        material.kind = MaterialKind::MetallicRoughness;
        change(material);
        test::add(scene, test::floor_at(0, 1), material);
    };
    const auto left_out = [&](IntegratorKind kind) {
        RenderSettings settings;
        settings.integrator = kind;
        Messages messages;
        check_light(settings, scene, messages);
        std::vector<std::string> reasons;
        for (const Message& message : messages.all()) {
            CHECK(message.is_left_out);
            reasons.push_back(message.remark.reason);
        }
        return reasons;
    };
    add("plain", [](Material&) {});
    add("clear coat", [](Material& m) { m.coat_weight = 1; });
    add("no coat", [](Material& m) { m.coat_color = {1, 0, 0}; });
    add("mirror", [](Material& m) { m.metallic = 1, m.roughness = 0.03f; });
    add("black", [](Material& m) { m.metallic = 1, m.base_color = {0, 0, 0}; });
    add("glass", [](Material& m) { m.kind = MaterialKind::Dielectric, m.roughness = 0; });
    CHECK(left_out(IntegratorKind::Radiosity).empty());
    scene.materials.push_back(scene.materials[1]);
    scene.materials.back().coat_color = {0, 1, 0}; // no surface has it
    CHECK(left_out(IntegratorKind::Radiosity).empty());
    add("red coat", [](Material& m) { m.coat_weight = 1, m.coat_color = {1, 0, 0}; });
    add("leaf", [](Material& m) { m.diffuse_transmission_weight = 0.5f; });
    add("gold", [](Material& m) { m.kind = MaterialKind::Conductor; });
    add("tin", [](Material& m) { m.metallic = 1; });
    add("frosted", [](Material& m) { m.kind = MaterialKind::Dielectric; });
    const std::vector<std::string> reasons = left_out(IntegratorKind::Radiosity);
    REQUIRE(reasons.size() == 4);
    const char* const expected[] = {"'red coat'", "'leaf'", "'gold', 'tin'", "'frosted'"};
    for (std::size_t i = 0; i < 4; ++i) CHECK(reasons[i].find(fmt::format(": {} (", expected[i])) != std::string::npos);
    CHECK(left_out(IntegratorKind::Path).empty());
}
