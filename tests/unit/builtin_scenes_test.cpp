#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "base/version.h"
#include "formats/builtin_scenes.h"

using namespace pertev;

TEST_CASE("the Cornell box is part of the program, whole") {
    const auto bytes = builtin_scene("cornell-box");
    REQUIRE(bytes);
    const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    CHECK(text.starts_with("{"));
    CHECK(text.ends_with("}\n"));
    CHECK(text.find("\"KHR_materials_emissive_strength\"") != std::string::npos);
    CHECK(std::ranges::count(builtin_scene_names(), "cornell-box") == 1);
}

TEST_CASE("a name that is no built-in scene finds nothing") {
    CHECK_FALSE(builtin_scene("cornell"));
    CHECK_FALSE(builtin_scene(""));
}

TEST_CASE("the version has three numbers") {
    const std::string text = version();
    CHECK(std::ranges::count(text, '.') == 2);
    CHECK(text.find_first_not_of("0123456789.") == std::string::npos);
    CHECK(std::string(git_commit()).find_first_not_of("0123456789abcdef+") == std::string::npos);
}
