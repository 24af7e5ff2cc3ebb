// Which of several differences between two renders is named.

#include <doctest/doctest.h>

#include "session/writing/deciding_settings.h"

using namespace pertev;

namespace {

std::string first_name(const DecidingSettings& before, const DecidingSettings& after) {
    const auto found = first_difference(before, after);
    return found ? found->name : "";
}

TEST_CASE("the difference that explains the others is named") {
    const DecidingSettings one = {
        {"hash of the scene's file", "a"}, {"exposure", "1.5"}, {"max_depth", "4"}, {"version", "1"}};
    CHECK(first_name(one, one) == "");
    DecidingSettings deeper = one;
    deeper[1].second = "1.7"; // metered anew
    deeper[2].second = "5";
    CHECK(first_name(one, deeper) == "`max_depth`");
    CHECK(first_difference(one, deeper)->before == "4");
    CHECK(first_difference(one, deeper)->after == "5");
    DecidingSettings of_another = deeper;
    of_another[0].second = "b";
    CHECK(first_name(one, of_another) == "hash of the scene's file");
    DecidingSettings newer = of_another;
    newer.emplace(newer.begin() + 1, "max_texture_size", "8"); // a setting that the older program has not
    newer.back().second = "2";
    CHECK(first_name(one, newer) == "version");
    CHECK(first_name(newer, one) == "version");
    DecidingSettings brighter = one;
    brighter[1].second = "2";
    CHECK(first_name(one, brighter) == "`exposure`");
}

} // namespace
