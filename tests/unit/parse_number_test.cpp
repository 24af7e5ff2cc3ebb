// Decimal text as a number, at both ends of the range.

#include <cmath>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include "formats/files/parse_number.h"

using namespace pertev;

namespace {

constexpr float kTooLarge = std::numeric_limits<float>::infinity();

} // namespace

TEST_CASE("a number too close to 0 for a float is 0 and one too large is infinite, in any notation") {
    const std::string zeros(400, '0');
    for (const std::string& tiny : {std::string("1e-46"), std::string("9.9e-400"), "0." + zeros + "1",
                                    "0." + zeros + "1e5", "." + zeros + "7e+300", "1" + zeros + "e-500",
                                    std::string("1e-99999999999999999999"), "12.5" + zeros + "E-80"}) {
        CAPTURE(tiny);
        CHECK(parse_whole_float(tiny) == 0.0f);
        CHECK_FALSE(std::signbit(parse_whole_float(tiny).value()));
        CHECK(std::signbit(parse_whole_float("-" + tiny).value()));
    }
    for (const std::string& huge :
         {std::string("1e39"), std::string("1e400"), "1" + zeros, "1" + zeros + "e-5", "0." + zeros + "1e900",
          std::string("00001e+99"), std::string("1e99999999999999999999"), "12" + zeros + ".5"}) {
        CAPTURE(huge);
        CHECK(parse_whole_float(huge) == kTooLarge);
        CHECK(parse_whole_float("-" + huge) == -kTooLarge);
    }
    CHECK(parse_whole_float<double>("1e-46") == 1e-46);
    CHECK(parse_whole_float<double>("1e39") == 1e39);
    CHECK(parse_whole_float<double>("1e-400") == 0.0);
    CHECK(parse_whole_float<double>("1e400") == HUGE_VAL);
    CHECK(parse_whole_float("1e-45") == std::numeric_limits<float>::denorm_min());
    CHECK(parse_whole_float("0e-999") == 0.0f);
}

TEST_CASE("a whole number in text has nothing around it") {
    CHECK(parse_whole_float("-1.5") == -1.5f);
    for (const char* text : {"", " 1", "1 ", "+1", "1e-400x", "1,2", "e5", "."}) {
        CAPTURE(text);
        CHECK_FALSE(parse_whole_float(text));
    }
}

TEST_CASE("a whole number consists only of digits, up to its type's limit") {
    CHECK(parse_whole_number("18446744073709551615") == std::numeric_limits<uint64_t>::max());
    CHECK(parse_whole_number<uint32_t>("007") == 7u);
    CHECK_FALSE(parse_whole_number<uint32_t>("4294967296"));
    for (const char* text : {"", "-1", "+1", " 1", "1 ", "1.0", "0x1", "one"}) {
        CAPTURE(text);
        CHECK_FALSE(parse_whole_number(text));
    }
}
