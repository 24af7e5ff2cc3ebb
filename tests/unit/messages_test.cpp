// Messages: skipped parts and defaults are listed separately.

#include <doctest/doctest.h>

#include <fmt/format.h>

#include "base/json_text.h"
#include "base/sink.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

TEST_CASE("left-out parts cause warnings, defaults cause notices, and both are listed") {
    Messages messages;
    messages.warn("repaired");
    messages.leave_out("a texture");
    messages.note("a default");
    messages.make_up("a sky");
    messages.leave_out("a texture");
    messages.leave_out("a lamp");
    REQUIRE(messages.all().size() == 5);
    CHECK(messages.all()[1].is_warning);
    CHECK(messages.all()[1].times == 2);
    CHECK(!messages.all()[3].is_warning);
    CHECK(messages.left_out() == std::vector<std::string>{"a texture", "a lamp"});
    CHECK(messages.made_up() == std::vector<std::string>{"a sky"});

    Messages others;
    others.warn("a texture"); // reported before without being marked as left out
    others.add_all(messages);
    CHECK(others.left_out() == messages.left_out());
    CHECK(others.made_up() == messages.made_up());
    CHECK(others.all()[0].times == 3);
    CHECK(messages.since(4).left_out() == std::vector<std::string>{"a lamp"});
    CHECK(messages.since(3).made_up() == messages.made_up());
}

TEST_CASE("a user's sink gets the messages of partial work and stops it") {
    struct Own final : Sink {
        std::vector<std::string> texts;
        bool stops = false;
        void receive(const Message& message) override { texts.push_back(message.text); }
        bool should_stop() override { return stops; }
    } own;
    ProgressSink heard = part_of(own, 0, 0.5);
    heard.leave_out({"eye", "", "looks at itself"});
    CHECK(own.texts == std::vector<std::string>{Remark("eye", "", "looks at itself").text()});
    PartMessages unheard(own);
    unheard.make_up("a sky");
    CHECK(own.texts.size() == 1);
    CHECK(unheard.made_up() == std::vector<std::string>{"a sky"});
    own.stops = true;
    for (Sink* part : {static_cast<Sink*>(&heard), static_cast<Sink*>(&unheard)}) {
        const std::optional<Error> error = test::thrown_error([&] { part->check(); });
        CHECK((error && error->code() == ErrorCode::Interrupted));
    }
    nobody().warn("unheard");
    CHECK(nobody().messages().all().empty());
}

TEST_CASE("messages about a million faults take little memory") {
    Messages messages;
    for (int i = 0; i < 1'000'000; ++i) messages.leave_out(fmt::format("fault {}", i % 500'000));
    CHECK(messages.all().size() == 101);
    CHECK(messages.left_out().size() == 101);
    CHECK(messages.all()[0].times == 2);
    CHECK(messages.all()[100].times == 1'000'000 - 200);
}

TEST_CASE("lists of texts are arrays of JSON") {
    CHECK(json_strings({}) == "[]");
    CHECK(json_strings({"a \"b\"", "c"}) == R"(["a \"b\"","c"])");
}
