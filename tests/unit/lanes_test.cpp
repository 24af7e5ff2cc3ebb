// Functions of eight and of sixteen lanes give in each lane the bits of the scalar functions.

#include <doctest/doctest.h>

#include "base/processor.h"
#include "math/lanes.h"
#include "tests/support/check_lanes_16.h"

namespace pertev::test::lanes {
namespace {

using Floats = Floats8;

} // namespace
} // namespace pertev::test::lanes

#include "tests/support/check_lanes.inl"

using namespace pertev;

TEST_CASE("functions of eight lanes have the bits of one") {
    const test::LaneDifferences found = test::lanes::check_lanes();
    CAPTURE(found.line);
    CHECK(found.count == 0);
}

#if defined(PERTEV_HAS_16_LANES)
TEST_CASE("functions of sixteen lanes have the bits of one") {
    if (!has_sixteen_lanes()) return;
    const test::LaneDifferences found = test::check_lanes_of_16();
    CAPTURE(found.line);
    CHECK(found.count == 0);
}
#endif
