// Choice of a file's animation and scene by name or number, and the text of a choice.

#include <algorithm>

#include <doctest/doctest.h>

#include "base/error.h"
#include "formats/files/file_choices.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace file_choices_test { // test files are compiled together

using Names = std::vector<std::string>;

/// Returns the only animation that plays.
std::size_t chosen(const Names& names, const std::string& choice) {
    const std::vector<bool> plays = choose_clips("a.glb", names, choice);
    REQUIRE(plays.size() == names.size());
    REQUIRE(std::count(plays.begin(), plays.end(), true) == 1);
    return static_cast<std::size_t>(std::find(plays.begin(), plays.end(), true) - plays.begin());
}

std::string refusal(const Names& names, const std::string& choice) {
    try {
        choose_clips("a.glb", names, choice);
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::BadInput);
        return error.what();
    }
    return "";
}

std::vector<Clip> clips(const Names& names, const std::vector<bool>& plays) {
    std::vector<Clip> all;
    for (std::size_t i = 0; i < names.size(); ++i) all.push_back({.name = names[i], .end_s = 1, .plays = plays[i]});
    return all;
}

TEST_CASE("a name takes precedence over a number, and without a choice the first plays") {
    const Names names = {"walk", "run", "0", ""};
    CHECK(chosen(names, "") == 0);
    CHECK(chosen(names, "run") == 1);
    CHECK(chosen(names, "1") == 1);
    CHECK(chosen(names, "0") == 2); // this animation has the number as its name
    CHECK(chosen(names, "3") == 3);
    CHECK(choose_file_scene("a.glb", names, "0") == 2);
    CHECK(choose_clips("a.glb", names, "all") == std::vector<bool>(4, true));
    CHECK(choose_clips("a.glb", {}, "").empty());
    CHECK(chosen({"walk", "all"}, "1") == 1); // "all" selects every animation, even if one has that name
    CHECK(choose_clips("a.glb", Names{"walk", "all"}, "all") == std::vector<bool>(2, true));
    CHECK(choose_file_scene("a.glb", Names{"walk", "all"}, "all") == 1);
}

TEST_CASE("each of several can be chosen, even if the number of one is the name of another") {
    for (const Names& names : {Names{"walk", "walk", "1"}, Names{"2", "", "1", "0"}, Names{"1", "1", "0", "3"}}) {
        std::vector<bool> plays(names.size());
        for (std::size_t i = 0; i < names.size(); ++i) {
            plays[i] = true;
            CHECK(chosen(names, clip_choice(clips(names, plays))) == i);
            plays[i] = false;
        }
    }
    CHECK(chosen({"walk", "walk", "1"}, "1") == 1); // no name is this number
}

TEST_CASE("a choice that matches none or two is an error that lists all") {
    CHECK(refusal({"walk", "run"}, "jump") ==
          "a.glb: `animation=jump`: no such animation; the file has:\n  walk\n  run");
    CHECK(
        refusal({"walk", "", "walk"}, "walk") ==
        "a.glb: `animation=walk`: 2 animations have this name; choose one by its number:\n  0 (walk)\n  1\n  2 (walk)");
    CHECK(refusal({}, "all") == "a.glb: `animation=all`: no such animation; the file has no animations");
    for (const char* choice : {"2", "-1", "1.0", " 1", "+1", "99999999999999999999"})
        CHECK(!refusal({"a", "b"}, choice).empty());
    const auto error = test::thrown_error([] { choose_file_scene("a.glb", {}, "x"); });
    REQUIRE(test::is_about(error, ErrorCode::BadInput, "file_scene", "x"));
    CHECK(error->location()->file == "a.glb");
}

TEST_CASE("the animation and scene in use are reported by words that choose them again") {
    const Names names = {"walk", "twin", "twin", "", "all"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        std::vector<bool> plays(names.size());
        plays[i] = true;
        CHECK(chosen(names, clip_choice(clips(names, plays))) == i);
    }
    CHECK(clip_choice(clips(names, std::vector<bool>(5, true))) == "all");
    CHECK(clip_choice(clips({"walk"}, {true})).empty()); // the file has only one
    CHECK(clip_choice({}).empty());
    CHECK(list_clips(clips(names, std::vector<bool>(5))) == Names{"walk", "1 (twin)", "2 (twin)", "3", "4 (all)"});

    Scene scene;
    CHECK(file_scene_choice(scene).empty());
    scene.file_scenes = {"hall", "hall", "all"};
    scene.file_scene = 1;
    CHECK(file_scene_choice(scene) == "1");
    CHECK(list_file_scenes(scene) == Names{"0 (hall)", "1 (hall)", "all"});
    scene.variants = {"day", "night"};
    CHECK(material_variant_choice(scene).empty()); // the file's default materials
    scene.variant = 1;
    CHECK(material_variant_choice(scene) == "night");
    CHECK(list_material_variants(scene) == Names{"day", "night"});
}

} // namespace file_choices_test
