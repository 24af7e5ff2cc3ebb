#include <stdexcept>

#include <doctest/doctest.h>

#include "render/film_channels.h"

using namespace pertev;

TEST_CASE("the requested groups of channels are stored in the order of their bits") {
    constexpr uint32_t kAll = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    CHECK(film_channel_count(0) == 4);
    CHECK(film_channel_count(kAovIds) == 4);
    CHECK(film_channel_count(kAovMotion) == 4);
    CHECK(film_channel_count(kAll) == 14);
    CHECK(channel_offset(kAll, kAovAlbedo) == 4);
    CHECK(channel_offset(kAll, kAovNormal) == 7);
    CHECK(channel_offset(kAll, kAovDepth) == 10);
    CHECK(channel_offset(kAll, kAovPosition) == 11);
    CHECK(channel_offset(kAovDepth | kAovPosition, kAovDepth) == 4);
    CHECK(channel_offset(kAovDepth | kAovPosition, kAovPosition) == 5);
    CHECK(channel_offset(kAovAlbedo | kAovPosition, kAovPosition) == 7);
}

TEST_CASE("auxiliary layers are found by their names") {
    CHECK(aov_names() ==
          std::vector<std::string>{"albedo", "normal", "depth", "position", "ids", "motion", "distance"});
    for (const std::string& name : aov_names()) CHECK(aov_group(aov_named(name).value()).name == name);
    CHECK_FALSE(aov_named("id").has_value());
    CHECK(channel_names(aov_group(kAovDepth)) == std::vector<std::string>{"Z"});
    CHECK(channel_names(aov_group(kAovIds)) == std::vector<std::string>{"instance", "primitive", "material"});
    CHECK_THROWS_AS(aov_group(static_cast<AovBits>(128)), std::logic_error);
}
