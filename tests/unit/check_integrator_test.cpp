// What cast and whitted say of scenes whose lights they do not know.

#include <doctest/doctest.h>

#include "session/check_integrator.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

/// What is said of the scene: the error, the note, or nothing.
std::string said(IntegratorKind integrator, const Scene& scene, std::optional<Rgb> ambient = {}, uint32_t depth = 4) {
    RenderSettings settings;
    settings.integrator = integrator;
    settings.ambient = ambient;
    settings.path.max_depth = depth;
    Messages messages;
    const std::string error = test::bad_input_message([&] { check_light(settings, scene, messages); });
    if (error != "no error") return error;
    return messages.all().empty() ? "" : messages.all().front().text;
}

} // namespace

TEST_CASE("a scene that cast or whitted would show as black is refused, with what to use instead") {
    Scene scene;
    test::add(scene, test::floor_at(0, 1), test::white());
    test::add(scene, test::floor_at(1, 1), {.name = "lamp", .emission = {1, 1, 1}});
    const std::string instead =
        ": --integrator distributed or path knows all lights, --ambient 0.5 lights all surfaces alike";
    const std::string lights = ": point, spot and directional lights alone light its surfaces, and this scene has ";
    for (const auto& [kind, name] : {std::pair(IntegratorKind::Cast, "--integrator cast"),
                                     std::pair(IntegratorKind::Whitted, "--integrator whitted")}) {
        CHECK(said(kind, scene) == name + lights + "lamps alone" + instead);
        CHECK(said(kind, scene, Rgb{0, 0, 0}).empty()); // asked for
        CHECK(said(kind, scene, {}, 0).empty());        // emission alone
    }
    CHECK(said(IntegratorKind::Distributed, scene).empty());
    CHECK(said(IntegratorKind::Path, scene).empty());

    scene.environment = Environment{};
    CHECK(said(IntegratorKind::Cast, scene) ==
          "--integrator cast" + lights + "lamps and an environment alone" + instead);
    CHECK(test::says(Error(ErrorCode::BadInput, said(IntegratorKind::Whitted, scene)),
                     "surfaces show the environment's mean as ambient light"));

    scene.lights.push_back(test::point_light({0, 2, 0}, {1, 1, 1}));
    CHECK(said(IntegratorKind::Cast, scene).empty());
    CHECK(said(IntegratorKind::Whitted, scene).empty());
    scene.lights.front().intensity = {0, 0, 0};
    CHECK(!said(IntegratorKind::Cast, scene).empty());
}

TEST_CASE(
    "an environment that is black is no light: what needs some refuses the scene, the others say that it is dark") {
    Scene scene;
    test::add(scene, test::floor_at(0, 1), test::white());
    const std::string none = "no lamp, no point, spot or directional light, and the environment is black";
    const auto check_dark = [&] {
        CHECK(said(IntegratorKind::PhotonMap, scene) ==
              "--integrator photon_map: photons leave lights, and this scene has none: " + none);
        CHECK(said(IntegratorKind::Radiosity, scene) ==
              "radiosity: surfaces pass light on, and this scene has none: " + none);
        for (const IntegratorKind kind :
             {IntegratorKind::Path, IntegratorKind::Hybrid, IntegratorKind::Light, IntegratorKind::Bidirectional,
              IntegratorKind::Distributed, IntegratorKind::IrradianceCache}) {
            CHECK(said(kind, scene).starts_with("nothing in this scene gives light: " + none));
        }
        for (const IntegratorKind kind :
             {IntegratorKind::Cast, IntegratorKind::Whitted, IntegratorKind::Raster, IntegratorKind::Reyes}) {
            CHECK(test::says(Error(ErrorCode::BadInput, said(kind, scene)),
                             "directional lights alone light its surfaces, and this scene has none: "));
            CHECK(said(kind, scene, Rgb{1, 1, 1}).empty()); // asked for
        }
    };
    scene.environment = Environment{.image = {}, .scale = {0, 0, 0}, .rotation = 0};
    check_dark();
    scene.environment = Environment{.image = {2, 1, 3, std::vector<float>(6)}, .scale = {1, 1, 1}, .rotation = 0};
    check_dark();
    scene.environment->image.pixels[5] = 1e-6f;
    CHECK(said(IntegratorKind::Path, scene).empty());
    CHECK(said(IntegratorKind::PhotonMap, scene).empty());
    scene.environment->scale.b = 0; // which is all that it has
    check_dark();
    test::add(scene, test::floor_at(1, 1), {.name = "lamp", .emission = {1, 1, 1}});
    CHECK(said(IntegratorKind::Path, scene).empty());
    CHECK(said(IntegratorKind::Radiosity, scene).empty());
}
