// Names in light-path expressions: their objects in a scene, and errors for unknown names.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "render/light_paths/light_path_layers.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

/// A wall, an emitter and a light under the node "house", a floor, and a light without a parent.
Scene make_named_scene() {
    Scene scene;
    scene.nodes.resize(2);
    scene.nodes[0].name = "house";
    scene.nodes[1].name = "room";
    scene.nodes[1].parent = 0;
    const auto add = [&](const char* object, const char* mesh, Material material, uint32_t node) {
        test::add(scene, test::floor_at(0, 1), material);
        scene.meshes.back().name = mesh;
        scene.instances.back().name = object;
        scene.instances.back().node = node;
    };
    add("wall", "panel", test::white(), 1);
    Material glow = test::white();
    glow.name = "glow";
    glow.emission = {1, 1, 1};
    add("lamp", "disc", glow, 0);
    add("floor", "panel", test::white(), kNoNode);
    scene.lights.push_back(test::point_light({0, 1, 0}, {1, 1, 1}));
    scene.lights.back().name = "bulb";
    scene.lights.back().node = 1;
    scene.lights.push_back(test::point_light({0, 2, 0}, {1, 1, 1}));
    scene.lights.back().name = "sun";
    scene.environment = Environment{};
    return scene;
}

LightPathLayers put_layers(std::initializer_list<const char*> texts, const Scene& scene) {
    std::vector<LightPathExpression> expressions;
    for (const char* text : texts) expressions.push_back(parse_light_path(text));
    return bind_to_scene(std::move(expressions), scene);
}

/// Returns for wall, emitter and floor whether LD<filter>E accepts scattering there.
std::vector<bool> surfaces_of_filter(const char* expression) {
    const LightPathLayers layers = put_layers({expression}, make_named_scene());
    std::vector<bool> are;
    for (const uint16_t tag : layers.surface_tags) {
        const uint16_t after = layers.automaton.next_state(layers.automaton.start, tag, LobeClass::Diffuse, false);
        are.push_back(after != LightPathAutomaton::kNothing);
    }
    return are;
}

/// Returns for emitter, bulb, sun and environment whether the expression accepts light that goes from it to the eye.
std::vector<bool> lights_of_filter(const char* expression) {
    const LightPathLayers layers = put_layers({expression}, make_named_scene());
    const LightPathAutomaton& automaton = layers.automaton;
    std::vector<bool> are;
    for (const uint16_t light :
         {layers.instance_lights[1], layers.scene_lights[0], layers.scene_lights[1], layers.environment_light}) {
        are.push_back(automaton.layers[automaton.start * automaton.light_count + light] == 1);
    }
    return are;
}

using TheseAre = std::vector<bool>;

} // namespace

TEST_CASE("a surface's names are those of its object, mesh, material and parent nodes") {
    CHECK(surfaces_of_filter("x=LD<'wall'>E") == TheseAre{true, false, false});
    CHECK(surfaces_of_filter("x=LD<'panel'>E") == TheseAre{true, false, true});
    CHECK(surfaces_of_filter("x=LD<'white'>E") == TheseAre{true, false, true});
    CHECK(surfaces_of_filter("x=LD<'room'>E") == TheseAre{true, false, false});
    CHECK(surfaces_of_filter("x=LD<'house'>E") == TheseAre{true, true, false});
    CHECK(surfaces_of_filter("x=LD<'wall' 'floor'>E") == TheseAre{true, false, true});
    CHECK(surfaces_of_filter("x=LD<^'wall' 'floor'>E") == TheseAre{false, true, false});
    CHECK(surfaces_of_filter("x=LD<'?l*'>E") == TheseAre{false, true, true}); // glow and floor
    CHECK(surfaces_of_filter("x=L[^D<'wall'>]E") == TheseAre{false, true, true});
    CHECK(surfaces_of_filter("x=L.E") == TheseAre{true, true, true});
}

TEST_CASE("a light's names are its own and its parent nodes', and the environment has a keyword") {
    CHECK(lights_of_filter("x=L<'bulb'>E") == TheseAre{false, true, false, false});
    CHECK(lights_of_filter("x=L<'lamp'>E") == TheseAre{true, false, false, false});
    CHECK(lights_of_filter("x=L<'glow'>E") == TheseAre{true, false, false, false});
    CHECK(lights_of_filter("x=L<'house'>E") == TheseAre{true, true, false, false});
    CHECK(lights_of_filter("x=L<'environment'>E") == TheseAre{false, false, false, true});
    CHECK(lights_of_filter("x=L<^'environment' 's*'>E") == TheseAre{true, true, false, false});
    CHECK(lights_of_filter("x=LE") == TheseAre{true, true, true, true});
}

TEST_CASE("an unknown name is refused at its character, with a list of names") {
    const auto fault = [](const char* text) {
        return test::thrown_error([&] { put_layers({"a=LE", text}, make_named_scene()); });
    };
    for (const char* text : {"b=LD<'wal'>E", "b=LD<'wall' 'x*'>E", "b=L<'wall'>E"}) { // the wall emits no light
        CHECK(test::is_about(fault(text), ErrorCode::BadInput, "lpe", "b"));
    }
    CHECK(test::says(fault("b=LD<'wal'>E"), "character 5"));
    CHECK(test::says(fault("b=LD<'wal'>E"), "\n      ^"));
    CHECK(test::says(fault("b=LD<'wall' 'x*'>E"), "character 12"));
    CHECK(test::says(fault("b=L<'wall'>E"), "'bulb', 'disc'"));
    CHECK(test::is_about(fault("a=LDE"), ErrorCode::BadInput, "lpe", "a"));
}

TEST_CASE("a render takes any number of layers") {
    for (const uint32_t count : {1u, 32u, 33u, 64u, 65u, 100u, 250u}) {
        CAPTURE(count);
        std::vector<LightPathExpression> expressions;
        for (uint32_t i = 0; i < count; ++i) expressions.push_back(parse_light_path(fmt::format("n{0}=LD{{{0}}}E", i)));
        const LightPathLayers layers = bind_to_scene(expressions, make_named_scene());
        CHECK(layers.count() == count);
        uint16_t state = layers.automaton.start;
        for (uint32_t i = 0; i < count; ++i) {
            for (uint32_t k = 0; k < count; ++k) CHECK(layers.automaton.takes(state, 0, k) == (i == k));
            state = layers.automaton.next_state(state, 0, LobeClass::Diffuse, false);
        }
        CHECK(state == LightPathAutomaton::kNothing);
    }
}

TEST_CASE("an error for two layers of one name shows both expressions") {
    std::vector<LightPathExpression> expressions;
    for (int i = 0; i < 100; ++i) expressions.push_back(parse_light_path(fmt::format("n{}=LE", i)));
    check_layers(expressions);
    expressions[97] = parse_light_path("n35=LDE");
    const auto error = test::thrown_error([&] { check_layers(expressions); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "lpe", "n35"));
    CHECK(test::says(error, "\n  n35=LE\n  n35=LDE"));
}
