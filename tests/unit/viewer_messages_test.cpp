// Messages of pages to the viewer (apps/viewer/client_message.h): strict, bounded, and without a crash for any bytes.

#include <cmath>
#include <iterator>
#include <string>

#include <doctest/doctest.h>

#include "apps/viewer/client_message.h"
#include "tests/support/options.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

constexpr const char* kGood[] = {
    R"({"type":"hello","key":"abc"})",
    R"({"type":"move","n":7,"right":-1,"up":0.5,"forward":1,"ms":16.7,"pace":"fast"})",
    R"({"type":"orbit","n":8,"dx":0.1,"dy":-0.2})",
    R"({"type":"look","n":9,"dx":0.1,"dy":-0.2})",
    R"({"type":"pan","n":10,"dx":0.1,"dy":-0.2})",
    R"({"type":"zoom","n":11,"steps":-3})",
    R"({"type":"speed","n":12,"steps":1})",
    R"({"type":"pick","n":13,"x":0.5,"y":1,"use":"focus"})",
    R"({"type":"home","n":14})",
    R"({"type":"camera","n":15,"index":3})",
    R"({"type":"set","n":16,"name":"exposure","value":-1.5})",
    R"({"type":"set","n":17,"name":"tone_map","value":"aces"})",
    R"({"type":"meter","n":18})",
    R"({"type":"ack","frame":4294967295,"ms":12})",
    R"({"type":"ask"})",
    R"({"type":"hand","to":2})",
    R"({"type":"play","n":19,"on":true,"loops":false,"speed":0.25})",
    R"({"type":"time","n":20,"at":1.5})",
    R"({"type":"key","n":21,"at":0})",
    R"({"type":"unkey","n":22,"index":1})",
    R"({"type":"follow","n":23})",
    R"({"type":"rate","hz":59.94})",
    R"({"type":"shape","width":65535,"height":1})",
};

} // namespace

TEST_CASE("every kind of message is read with its values") {
    for (const char* text : kGood) CHECK_MESSAGE(parse_client_message(text).has_value(), text);
    const auto move = parse_client_message(kGood[1]);
    REQUIRE(move);
    CHECK(move->kind == MessageKind::Move);
    CHECK(move->input == 7);
    CHECK(move->right == -1);
    CHECK(move->up == 0.5f);
    CHECK(move->forward == 1);
    CHECK(move->seconds == doctest::Approx(0.0167));
    CHECK(move->pace == Pace::Fast);
    const auto pick = parse_client_message(kGood[7]);
    CHECK(pick->use == PickUse::Focus);
    CHECK(pick->y == 1);
    CHECK(std::get<double>(parse_client_message(kGood[10])->value) == -1.5);
    CHECK(std::get<std::string>(parse_client_message(kGood[11])->value) == "aces");
    CHECK(parse_client_message(kGood[13])->frame == 4294967295u);
    const auto play = parse_client_message(kGood[16]);
    CHECK(play->on);
    CHECK_FALSE(play->loops);
    CHECK(play->speed == 0.25f);
    CHECK(parse_client_message(kGood[17])->at == 1.5f);
}

TEST_CASE("malformed messages are refused") {
    for (const char* text : {
             "",
             "{}",
             "[]",
             "1",
             "null",
             R"("hello")",
             R"({"type":"hello"})",                     // a key is missing
             R"({"type":"hello","key":"a","key":"b"})", // a key occurs twice
             R"({"type":"ask","type":"ask"})",
             R"({"type":"hello","key":"a","more":1})", // there is an additional key
             R"({"type":"hello","key":7})",
             R"({"type":"hello","key":"\u0000"})",
             R"({"type":"Hello","key":"a"})",
             R"({"type":"ask"} {})",
             R"({"type":"ask",})",
             R"({"type":"zoom","n":1,"steps":21})",
             R"({"type":"zoom","n":1,"steps":"1"})",
             R"({"type":"zoom","n":1,"steps":1e400})",
             R"({"type":"zoom","n":1,"steps":NaN})",
             R"({"type":"zoom","n":-1,"steps":1})",
             R"({"type":"zoom","n":4294967296,"steps":1})",
             R"({"type":"zoom","n":1.5,"steps":1})",
             R"({"type":"pick","n":1,"x":1.01,"y":0,"use":"show"})",
             R"({"type":"pick","n":1,"x":0,"y":0,"use":"throw"})",
             R"({"type":"move","n":7,"right":-1,"up":0.5,"forward":1,"ms":251,"pace":"fast"})",
             R"({"type":"shape","width":0,"height":1})",
             R"({"type":"shape","width":65536,"height":1})",
             R"({"type":"shape","width":1.5,"height":1})",
             R"({"type":"set","n":1,"name":"exposure","value":[1]})",
             R"({"type":"set","n":1,"name":"exposure","value":null})",
             R"({"type":"set","n":1,"name":"a name that is longer than any name","value":1})",
         }) {
        CHECK_MESSAGE(!parse_client_message(text).has_value(), text);
    }
    const std::string long_key = R"({"type":"hello","key":")" + std::string(kMaxMessageBytes, 'a') + "\"}";
    CHECK_FALSE(parse_client_message(long_key).has_value());
    CHECK_FALSE(parse_client_message(std::string(900, '[')).has_value());
    CHECK_FALSE(parse_client_message(std::string_view("{\"type\":\"ask\"\0}", 15)).has_value());
}

TEST_CASE("damaged messages and random bytes are read or refused, and accepted values are in range") {
    test::Random random(5);
    const int rounds = static_cast<int>(test::effort(10'000, 1'000'000));
    int read = 0;
    for (int i = 0; i < rounds; ++i) {
        std::string text = kGood[random.below(std::size(kGood))];
        for (uint32_t changes = random.below(4); changes > 0; --changes) {
            const uint32_t at = random.below(static_cast<uint32_t>(text.size()));
            switch (random.below(4)) {
            case 0:
                text[at] = static_cast<char>(random.below(256));
                break;
            case 1:
                text.erase(at, 1 + random.below(3));
                break;
            case 2:
                text.insert(at, std::string(1 + random.below(3), "0123456789.-e\"{}[]:,\\"[random.below(21)]));
                break;
            default:
                text.insert(at, text.substr(0, random.below(20)));
                break;
            }
            if (text.empty()) text = " ";
        }
        const auto message = parse_client_message(text);
        if (!message) continue;
        ++read;
        REQUIRE(message->seconds >= 0);
        REQUIRE(message->seconds <= 0.25f);
        REQUIRE(std::abs(message->dx) <= 4);
        REQUIRE(std::abs(message->steps) <= 20);
        REQUIRE(message->key.size() <= 64);
        REQUIRE(message->hertz <= 1000);
    }
    CHECK(read > rounds / 8); // at least the undamaged messages are accepted
}
