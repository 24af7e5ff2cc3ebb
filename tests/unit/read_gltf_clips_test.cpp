// glTF files with several animations or several scenes: the scene contains only the selected ones.

#include <doctest/doctest.h>

#include "base/error.h"
#include "device_scene/place_meshes.h"
#include "formats/gltf/read_gltf.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"

using namespace pertev;
using test::GltfBuilder;

namespace read_gltf_clips_test { // test files are compiled together

/// Accessors: 0 positions, 1 times 0 2, 2 times 0 5, 3 two VEC3, 4 two scalars, 5 times that fall. Nodes 0 and 1 show
/// the mesh, which has a morph target, node 2 is a light. Clips: "walk" moves node 0, "bend" reshapes node 1, "dim"
/// changes the light, "broken" has an invalid channel.
GltfBuilder key_numbers() {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("SCALAR", std::vector<float>{0, 2});
    builder.add("SCALAR", std::vector<float>{0, 5});
    builder.add("VEC3", std::vector<float>{1, 1, 1, 2, 0, 0});
    builder.add("SCALAR", std::vector<float>{0, 1});
    builder.add("SCALAR", std::vector<float>{1, 0});
    return builder;
}

std::string clip(const char* name, int times, int values, const std::string& target) {
    return R"({"name":")" + std::string(name) + R"(","samplers":[{"input":)" + std::to_string(times) + R"(,"output":)" +
           std::to_string(values) + R"(}],"channels":[{"sampler":0,"target":)" + target + "}]}";
}

Scene read(const ReadOptions& options, Messages& messages, const std::string& scenes = "") {
    const std::string document = key_numbers().json(
        R"("extensionsUsed":["KHR_lights_punctual","KHR_animation_pointer"],"extensions":{"KHR_lights_punctual":)"
        R"({"lights":[{"type":"point"}]}},"meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":)"
        R"([{"POSITION":0}]}]}],"nodes":[{"mesh":0,"name":"a"},{"mesh":0,"name":"b"},)"
        R"({"extensions":{"KHR_lights_punctual":{"light":0}}}],)" +
        scenes + R"("animations":[)" + clip("walk", 1, 3, R"({"node":0,"path":"translation"})") + "," +
        clip("bend", 2, 4, R"({"node":1,"path":"weights"})") + "," +
        clip("dim", 1, 3,
             R"({"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":)"
             R"("/extensions/KHR_lights_punctual/lights/0/color"}}})") +
        "," + clip("broken", 1, 3, R"({"path":"translation"})") + "]");
    const std::filesystem::path path = test::scratch_folder() / "model.gltf";
    const std::span<const std::byte> bytes = std::as_bytes(std::span(document));
    return read_gltf(path, {bytes.begin(), bytes.end()}, FileAccess(path, {}), options, messages);
}

Scene read(const ReadOptions& options = {}) {
    Messages messages;
    return read(options, messages);
}

TEST_CASE("the scene plays the chosen animation and lists the others by name and end") {
    const Scene first = read();
    REQUIRE(first.animations.size() == 1);
    CHECK(first.animations[0].name == "walk");
    CHECK(first.animations[0].origin == "/animations/0");
    REQUIRE(first.clips.size() == 4);
    const std::vector<std::string> names = {"walk", "bend", "dim", "broken"};
    const std::vector<double> ends = {2, 5, 2, 0};
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(first.clips[i].name == names[i]);
        CHECK(first.clips[i].end_s == ends[i]);
        CHECK(first.clips[i].plays == (i == 0));
    }

    const Scene bend = read({.animation = "bend"});
    REQUIRE(bend.animations.size() == 1);
    CHECK(bend.animations[0].channels.at(0).part == AnimatedPart::Weights);
    CHECK(bend.animations[0].end_s() == 5);
    const Scene dim = read({.animation = "2"});
    CHECK(dim.animations.at(0).channels.at(0).part == AnimatedPart::LightIntensity);
    CHECK(read({.animation = "all"}).animations.size() == 4);
    CHECK_THROWS_AS(read({.animation = "jump"}), Error);
}

TEST_CASE("an instance that only an unchosen animation moves stays still and may be baked") {
    const auto moving = [](const ReadOptions& options) { return may_move(read(options)); };
    CHECK(moving({}) == std::vector<bool>{true, false});
    CHECK(moving({.animation = "bend"}) == std::vector<bool>{false, true});
    CHECK(moving({.animation = "dim"}) == std::vector<bool>{false, false});
    CHECK(moving({.animation = "all"}) == std::vector<bool>{true, true});

    // Nodes share their mesh unless the selected animation deforms one of them.
    const Scene still = read(), bent = read({.animation = "bend"});
    CHECK(still.instances.at(0).mesh == still.instances.at(1).mesh);
    CHECK(bent.instances.at(0).mesh != bent.instances.at(1).mesh);
    CHECK(place_meshes(bent).is_baked == std::vector<bool>{true, false});
    CHECK(place_meshes(read({.animation = "all"})).is_baked == std::vector<bool>{false, false});
}

TEST_CASE("channels of an animation that does not play cause no messages") {
    Messages quiet, loud;
    read({}, quiet);
    CHECK(quiet.all().empty());
    read({.animation = "broken"}, loud);
    REQUIRE(loud.all().size() == 1);
    CHECK(loud.all()[0].text.find("/animations/3/channels/0/target") != std::string::npos);
}

TEST_CASE("a requested scene of the file takes precedence over the file's own choice") {
    const std::string scenes = R"("scene":1,"scenes":[{"name":"left","nodes":[0]},{"name":"both","nodes":[0,1]}],)";
    Messages messages;
    const Scene both = read({}, messages, scenes), left = read({.file_scene = "left"}, messages, scenes),
                first = read({.file_scene = "0"}, messages, scenes);
    CHECK(both.file_scenes == std::vector<std::string>{"left", "both"});
    CHECK(both.file_scene == 1);
    CHECK(both.instances.size() == 2);
    for (const Scene& scene : {left, first}) {
        CHECK(scene.file_scene == 0);
        REQUIRE(scene.instances.size() == 1);
        CHECK(scene.instances[0].name == "a");
    }
    CHECK(left.lights.empty());
    CHECK_THROWS_AS(read({.file_scene = "right"}, messages, scenes), Error);
}

} // namespace read_gltf_clips_test
