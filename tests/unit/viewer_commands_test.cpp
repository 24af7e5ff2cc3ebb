// The effect of commands before they are handled (inbox.h), and requests of clients that do not steer
// (control_holder.h, audience.h).

#include <atomic>

#include <doctest/doctest.h>

#include "apps/viewer/audience.h"
#include "apps/viewer/request_text.h"

using namespace pertev;

namespace viewer_commands_test { // test files are compiled together

Steer setting(const char* name, const std::variant<double, std::string>& value) {
    Steer steer;
    steer.message.kind = MessageKind::Set;
    steer.message.name = name;
    steer.message.value = value;
    return steer;
}

struct Flagged {
    std::atomic<bool> abandon{false}, hurry{false};
    Inbox inbox;
    Flagged() { inbox.raise(abandon, hurry); }
    /// Returns the flags that the command sets: "", "hurry" or "hurry abandon".
    std::string put(const Command& command) {
        inbox.put(command);
        std::string raised = hurry ? "hurry" : "";
        if (abandon) raised += " abandon";
        hurry = abandon = false;
        return raised;
    }
};

/// Returns all texts that wait for this client, joined.
std::string texts_for(Audience& audience, uint32_t client) {
    std::string all;
    while (const auto job = audience.next_job(std::chrono::milliseconds(0), [] { return 0.0; })) {
        if (job->client == client) all += job->text + "\n";
        audience.text_was_sent(job->client);
    }
    return all;
}

constexpr const char* kOrbit = R"({"type":"orbit","n":1,"dx":0.1,"dy":0})";

TEST_CASE("commands that move the camera set the flags until they are taken, and a closed inbox accepts none") {
    std::atomic<bool> abandon{false}, hurry{false};
    Inbox inbox;
    inbox.raise(abandon, hurry);
    CHECK(inbox.put(setting("spp", 9.0)));
    CHECK_FALSE(hurry);
    Steer orbit;
    orbit.message.kind = MessageKind::Orbit;
    CHECK(inbox.put(orbit));
    CHECK(abandon);
    CHECK(hurry);
    CHECK(inbox.take(std::chrono::milliseconds(0)).size() == 2);
    CHECK_FALSE(abandon);
    CHECK_FALSE(hurry);
    bool replied = false;
    CHECK(inbox.put(Save{"png", [&](std::vector<std::byte>) { replied = true; }}));
    inbox.close();
    CHECK_FALSE(inbox.put(orbit));
    CHECK(inbox.take(std::chrono::milliseconds(0)).empty());
    CHECK_FALSE(replied);
}

TEST_CASE("a refused or unchanged setting restarts nothing") {
    Flagged flagged;
    ViewState view;
    view.dark = {{IntegratorKind::Whitted, "whitted: black"}};
    view.window_pixels = 640 * 480;
    view.options.render.width = 640, view.options.render.height = 480;
    flagged.inbox.expect(view);
    CHECK(flagged.put(setting("integrator", "whitted")) == "");
    CHECK(flagged.put(setting("integrator", "no such one")) == "");
    CHECK(flagged.put(setting("max_depth", -1.0)) == "");
    CHECK(flagged.put(setting("nothing", 1.0)) == "");
    CHECK(flagged.put(setting("integrator", "path")) == ""); // has this value already
    CHECK(flagged.put(setting("spp", 128.0)) == "");
    CHECK(flagged.put(setting("integrator", "direct")) == "hurry abandon");
    CHECK(flagged.put(setting("integrator", "direct")) == ""); // the previous command is still waiting
    CHECK(flagged.put(setting("integrator", "path")) == "hurry abandon");
    CHECK(flagged.put(setting("exposure", 1.0)) == "hurry"); // shows the same samples
    CHECK(flagged.put(setting("tone_map", "aces")) == "hurry");
    Steer shape;
    shape.message.kind = MessageKind::Shape;
    shape.message.width = 640, shape.message.height = 480;
    CHECK(flagged.put(shape) == "");
    shape.message.height = 200;
    CHECK(flagged.put(shape) == "hurry abandon");
    // The state is the renderer's, with the commands that have waited since.
    flagged.inbox.expect(view);
    CHECK(flagged.put(shape) == "");
    CHECK(flagged.inbox.take(std::chrono::milliseconds(0)).size() == 14);
    flagged.inbox.expect(view);
    CHECK(flagged.put(shape) == "hurry abandon");
}

TEST_CASE("clients that do not steer are informed, and the steering one sees their requests") {
    Inbox inbox;
    Audience audience(inbox, "welcome");
    for (const uint32_t id : {1u, 2u}) {
        audience.open(id, 0);
        audience.received(id, R"({"type":"hello","key":")" + std::to_string(id) + "\"}", 0);
    }
    texts_for(audience, 1);
    inbox.take(std::chrono::milliseconds(0));
    for (int i = 0; i < 50; ++i) CHECK(audience.received(2, kOrbit, 1 + 0.01 * i) == "");
    CHECK(inbox.take(std::chrono::milliseconds(0)).empty());
    std::string notices;
    std::string seen;
    while (const auto job = audience.next_job(std::chrono::milliseconds(0), [] { return 0.0; })) {
        (job->client == 2 ? notices : seen) += job->text + "\n";
        audience.text_was_sent(job->client);
    }
    CHECK(notices.find("viewer 1 steers") != std::string::npos);
    CHECK(notices.find("viewer 1 steers", notices.find("viewer 1 steers") + 1) ==
          std::string::npos); // one request for the whole drag
    CHECK(seen.find(R"("id":2,"asks":false,"request":"orbit the view")") != std::string::npos);
    CHECK(audience.received(2, R"({"type":"set","n":1,"name":"exposure","value":2})", 2) ==
          ""); // another request follows immediately
    CHECK(texts_for(audience, 1).find(R"("request":"set \"Stops\" to 2")") != std::string::npos);
    audience.tick(40); // the request has expired
    CHECK(texts_for(audience, 1).find(R"("request":"")") != std::string::npos);
    // Picks that only show information, rates and shapes do not steer, so they record no request.
    CHECK(audience.received(2, R"({"type":"pick","n":1,"x":0,"y":0,"use":"show"})", 41) == "");
    CHECK(audience.received(2, R"({"type":"rate","hz":60})", 41) == "");
    CHECK(audience.received(2, R"({"type":"shape","width":64,"height":48})", 41) == "");
    CHECK(texts_for(audience, 2) == "");
    CHECK(inbox.take(std::chrono::milliseconds(0)).size() == 1);
    // Messages in transit when control was handed over are not requests.
    CHECK(audience.received(1, R"({"type":"hand","to":2})", 50) == "");
    texts_for(audience, 1);
    CHECK(audience.received(1, kOrbit, 50.3) == "");
    CHECK(texts_for(audience, 1) == "");
    CHECK(audience.received(1, kOrbit, 52) == "");
    CHECK(texts_for(audience, 1).find("viewer 2 steers") != std::string::npos);
    // If control is reserved for a viewer that left, the message states that.
    audience.close(2, 60);
    CHECK(audience.received(1, kOrbit, 61) == "");
    CHECK(texts_for(audience, 1).find("has left") != std::string::npos);
}

TEST_CASE("every message that steers has a text for its request") {
    for (int kind = 0; kind <= static_cast<int>(MessageKind::Hand); ++kind) {
        CAPTURE(kind);
        ClientMessage message;
        message.kind = static_cast<MessageKind>(kind);
        const MessageKind k = message.kind;
        const bool steers = k != MessageKind::Hello && k != MessageKind::Rate && k != MessageKind::Shape &&
                            k != MessageKind::Ack && k != MessageKind::RequestControl && k != MessageKind::Hand;
        CHECK(request_text(message).empty() != steers);
    }
}

} // namespace viewer_commands_test
