// Sizes in motion (frame_pace.h), links (link_pace.h), who steers (control_holder.h), and what each client gets
// (audience.h).

#include <algorithm>
#include <deque>

#include <doctest/doctest.h>

#include "apps/viewer/audience.h"
#include "apps/viewer/frame_pace.h"
#include "apps/viewer/reference_is_better.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

/// Returns the time of a frame of this scale on a machine that needs `full_s` for a full-size frame.
double frame_time(double full_s, float scale) {
    return full_s * static_cast<double>(scale) * static_cast<double>(scale);
}

SendJob next(Audience& audience) {
    const auto job = audience.next_job(std::chrono::milliseconds(0), [] { return 0.2; });
    return job.value_or(SendJob{});
}

/// Discards texts and returns the first picture, if any.
SendJob next_picture(Audience& audience) {
    for (int i = 0; i < 100; ++i) {
        const SendJob job = next(audience);
        if (job.client == 0 || job.picture != nullptr) return job;
        audience.text_was_sent(job.client);
    }
    return {};
}

ShownFrame small_frame(bool is_final = false) {
    ShownFrame frame;
    frame.image = {2, 2, std::vector<uint8_t>(16, 200)};
    frame.is_final = is_final;
    return frame;
}

constexpr const char* kHello = R"({"type":"hello","key":"a"})";

} // namespace

TEST_CASE("the size in motion is the largest that keeps the frame rate") {
    for (const double full_s : {0.001, 0.1, 0.5, 2.0, 20.0}) {
        FramePace pace(0.12);
        for (int i = 0; i < 60; ++i) pace.took(pace.scale(), frame_time(full_s, pace.scale()));
        CAPTURE(full_s);
        const double time = frame_time(full_s, pace.scale());
        CHECK(time <= 0.12);
        if (pace.scale() < 1) CHECK(time > 0.12 / 3.5); // one step larger would not keep the rate with a margin
        const float settled = pace.scale();
        for (int i = 0; i < 20; ++i) { // the size does not oscillate
            pace.took(pace.scale(), frame_time(full_s, pace.scale()));
            CHECK(pace.scale() == settled);
        }
    }
}

TEST_CASE("the first frame is small on every machine, and the second as large as the machine allows") {
    for (const double full_s : {0.001, 0.5, 20.0}) {
        CAPTURE(full_s);
        FramePace pace(0.12);
        CHECK(frame_time(full_s, pace.scale()) < 0.1);
        pace.took(pace.scale(), frame_time(full_s, pace.scale()));
        const float second = pace.scale();
        for (int i = 0; i < 20; ++i) pace.took(pace.scale(), frame_time(full_s, pace.scale()));
        CHECK(pace.scale() == second);
    }
}

TEST_CASE("a slowly moving scene leaves less time for the picture, and an unreachable rate is reported") {
    const auto settled = [](double full_s, double beside_s) {
        FramePace pace(0.12);
        for (int i = 0; i < 60; ++i) pace.took(pace.scale(), frame_time(full_s, pace.scale()), beside_s);
        return pace;
    };
    CHECK(settled(0.5, 0.06).keeps_rate());
    CHECK(settled(0.5, 0.06).scale() < settled(0.5, 0).scale());
    CHECK(settled(20, 0).keeps_rate());
    CHECK(settled(60, 0).keeps_rate());
    CHECK_FALSE(settled(600, 0).keeps_rate()); // at a 32nd of each side
    const FramePace moves_slowly = settled(0.5, 0.3);
    CHECK_FALSE(moves_slowly.keeps_rate());
    CHECK(moves_slowly.scale() > 0.15f); // a smaller picture would not be faster
}

TEST_CASE("a changed frame rate changes the size in both directions") {
    FramePace pace(1.0 / 60);
    const auto settled = [&] {
        for (int i = 0; i < 20; ++i) pace.took(pace.scale(), frame_time(0.012, pace.scale()));
        return pace.scale();
    };
    CHECK(settled() == 1);
    pace.keep(1.0 / 144);
    CHECK(settled() == 0.75f);
    CHECK(pace.frame_s() == 1.0 / 144);
    pace.keep(1.0 / 60);
    CHECK(settled() == 1);
}

TEST_CASE("an expensive view makes pictures smaller within a few frames") {
    FramePace pace(0.1);
    for (int i = 0; i < 40; ++i) pace.took(pace.scale(), frame_time(0.07, pace.scale()));
    CHECK(pace.scale() == 1);
    for (int i = 0; i < 6; ++i) pace.took(pace.scale(), frame_time(1.5, pace.scale()));
    CHECK(frame_time(1.5, pace.scale()) < 0.2);
    CHECK(scaled_side(1, 0.0625f) == 1);
    CHECK(scaled_side(1280, 0.375f) == 480);
}

TEST_CASE("a picture at rest replaces a reconstruction once its error is smaller") {
    // Grey pictures with a true value of 100. `blur` is the reconstruction's error, `noise` the standard deviation of a
    // half.
    const auto picture = [](uint32_t size, auto value) {
        Rgba8Image made = {size, size, std::vector<uint8_t>(std::size_t(4) * size * size, 255)};
        for (std::size_t i = 0; i < std::size_t(size) * size; ++i) {
            const auto grey = static_cast<uint8_t>(std::clamp(100.5 + value(i), 0.0, 255.0));
            made.pixels[4 * i] = made.pixels[4 * i + 1] = made.pixels[4 * i + 2] = grey;
        }
        return made;
    };
    test::Random random(3);
    const auto better = [&](double noise, double blur) {
        std::vector<double> a(64 * 64), b(64 * 64);
        for (std::size_t i = 0; i < a.size(); ++i) {
            a[i] = noise * 1.732 * (random.below(2001) / 1000.0 - 1); // uniform noise with this standard deviation
            b[i] = noise * 1.732 * (random.below(2001) / 1000.0 - 1);
        }
        const Rgba8Image half = picture(64, [&](std::size_t i) { return a[i]; });
        const Rgba8Image whole = picture(64, [&](std::size_t i) { return 0.5 * (a[i] + b[i]); });
        return reference_is_better(whole, half, picture(16, [&](std::size_t i) { return i % 2 == 0 ? blur : -blur; }));
    };
    CHECK_FALSE(better(20, 0));  // no picture is better than the truth
    CHECK_FALSE(better(20, 10)); // 14 against the rest of 10 after stretching
    CHECK(better(20, 40));
    CHECK(better(4, 10));
}

TEST_CASE("at most two pictures are in flight to a client, and acknowledging one covers earlier ones") {
    LinkPace pace;
    pace.sent(1, 1000, 0);
    CHECK(pace.may_send(0.01));
    pace.sent(2, 1000, 0.01);
    CHECK_FALSE(pace.may_send(0.02));
    CHECK_FALSE(pace.acknowledged(7, 0.02, 0.001));
    CHECK(pace.acknowledged(2, 0.03, 0.001));
    CHECK(pace.is_idle());
    CHECK_FALSE(pace.acknowledged(1, 0.04, 0.001));
}

namespace {

/// Simulates a client that decodes `at_once` pictures in parallel, each in `decode_s`, with a new picture every 8 ms
/// and a latency of 2 ms. Returns the median seconds from sending to drawing, and the pictures drawn per second.
struct Shown {
    double wait_s, rate;
};
Shown pictures_shown(double decode_s, std::size_t at_once) {
    LinkPace pace;
    std::vector<double> free_s(at_once, 0.0), waits;
    struct Drawn {
        uint32_t frame;
        double at_s, began_s;
    };
    std::deque<Drawn> drawing;
    uint32_t frame = 0;
    constexpr double kStep = 0.0005, kEnd = 10;
    double published_s = 0, sent_s = -1;
    for (double now = 0; now < kEnd; now += kStep) {
        while (!drawing.empty() && drawing.front().at_s <= now) {
            const Drawn& done = drawing.front();
            pace.acknowledged(done.frame, now, done.at_s - done.began_s);
            drawing.pop_front();
        }
        if (now - published_s >= 0.008) published_s = now;
        if (published_s <= sent_s || !pace.may_send(now)) continue;
        sent_s = now;
        pace.sent(++frame, 200000, now);
        double& free = *std::ranges::min_element(free_s);
        const double began = std::max(free, now + 0.002);
        free = began + decode_s;
        drawing.push_back({frame, free, began});
        if (now > 1) waits.push_back(free - now);
    }
    std::ranges::sort(waits);
    return {waits[waits.size() / 2], static_cast<double>(waits.size()) / (kEnd - 1)};
}

} // namespace

TEST_CASE("pictures do not queue for a client slower than the renderer, and a faster one gets all") {
    const Shown slow = pictures_shown(0.02, 1);
    CHECK(slow.wait_s < 0.029); // 22 ms are the client's; a second picture sent at once would wait for up to 20 ms
    CHECK(slow.rate > 40);      // out of 50
    const Shown parallel = pictures_shown(0.012, 2);
    CHECK(parallel.wait_s < 0.016);
    CHECK(parallel.rate > 105); // out of 125
    const Shown fast = pictures_shown(0.004, 1);
    CHECK(fast.wait_s < 0.008);
    CHECK(fast.rate > 115);
}

TEST_CASE("a slow link gets smaller pictures and a fast one good ones") {
    LinkPace slow, fast;
    double slow_now = 0, fast_now = 0;
    for (uint32_t i = 1; i < 200; ++i) {
        // The link has 100 kB/s and a latency of 20 ms. The size of a picture depends on its quality and resolution.
        const auto bytes_of = [](const LinkPace& pace) {
            return static_cast<std::size_t>(4000.0 * pace.quality() * static_cast<double>(pace.scale() * pace.scale()));
        };
        const std::size_t bytes = bytes_of(slow);
        slow.sent(i, bytes, slow_now);
        slow_now += 0.02 + static_cast<double>(bytes) / 1e5;
        slow.acknowledged(i, slow_now, 0.001);
        fast.sent(i, bytes_of(fast), fast_now);
        fast_now += 0.005;
        fast.acknowledged(i, fast_now, 0.001);
    }
    CHECK(slow.quality() <= 40);
    CHECK(slow.scale() < 1);
    CHECK(fast.quality() == 92);
    CHECK(fast.scale() == 1);
    CHECK(slow.bytes_per_second() < 2e5);
    CHECK(slow.piece_bytes(0.2) < fast.piece_bytes(0.2));
}

TEST_CASE("a link with high latency is not treated as slow") {
    LinkPace pace;
    double now = 0;
    for (uint32_t i = 1; i < 300; ++i) { // a latency of 0.25 s and 10 MB/s
        const auto bytes =
            static_cast<std::size_t>(1000.0 * pace.quality() * static_cast<double>(pace.scale() * pace.scale()));
        pace.sent(i, bytes, now);
        pace.acknowledged(i, now += 0.25 + static_cast<double>(bytes) / 1e7, 0.001);
    }
    CHECK(pace.quality() >= 80);
    CHECK(pace.scale() == 1);
}

TEST_CASE("the first client steers, can hand over, and keeps control after a reconnect") {
    ControlHolder control;
    control.join(1, "a", 0);
    control.join(2, "b", 0);
    CHECK(control.steers(1));
    CHECK_FALSE(control.hand(2, 2));
    CHECK_FALSE(control.hand(1, 9));
    control.request_control(2);
    CHECK(control.seats()[1].wants_control);
    CHECK(control.hand(1, 2));
    CHECK(control.steers(2));
    CHECK_FALSE(control.seats()[1].wants_control);
    control.leave(2, 10);
    CHECK(control.holder() == 0); // the client waits
    control.join(3, "b", 12);
    CHECK(control.steers(3));
    control.leave(3, 20);
    control.tick(25);
    CHECK(control.holder() == 0);
    control.tick(31);
    CHECK(control.steers(1));
    control.leave(1, 40);
    CHECK_FALSE(control.steers(0));
    control.join(4, "d", 60);
    CHECK(control.steers(4));
}

TEST_CASE("a page that reconnects before its timeout regains control, and no other page does") {
    ControlHolder control;
    control.join(1, "a", 0);
    control.join(2, "b", 0);
    CHECK(control.steers(1));
    control.join(3, "a", 1);
    CHECK(control.steers(3));
    control.leave(1, 2);
    CHECK(control.steers(3));
    ControlHolder nameless;
    nameless.join(1, "", 0);
    nameless.join(2, "", 0);
    CHECK(nameless.steers(1));
}

TEST_CASE("pieces of a still picture do not affect the estimate for moving ones") {
    LinkPace pace;
    double now = 0;
    for (uint32_t i = 1; i < 30; ++i) {
        pace.sent(i, 1000, now);
        pace.acknowledged(i, now += 0.01, 0.001);
    }
    const int quality = pace.quality();
    for (uint32_t i = 30; i < 40; ++i) {
        pace.sent(i, 1 << 20, now, true);
        pace.acknowledged(i, now += 1, 0.001);
    }
    CHECK(pace.quality() == quality);
}

TEST_CASE("free control goes to the first client that requests it") {
    ControlHolder control;
    control.join(1, "a", 0);
    control.join(2, "b", 0);
    control.leave(1, 1);
    control.request_control(2);
    CHECK(control.steers(2));
}

TEST_CASE("a client gets nothing before its hello, then the welcome, then pictures as it acknowledges them") {
    Inbox inbox;
    Audience audience(inbox, "welcome");
    CHECK(audience.open(1, 0));
    audience.publish(small_frame(), 0);
    CHECK(next(audience).client == 0);
    CHECK_FALSE(audience.is_anyone_there());
    CHECK(audience.received(1, kHello, 0).empty());
    CHECK(audience.is_anyone_there());
    CHECK(next(audience).text == "welcome");
    const SendJob picture = next(audience); // no second text is sent before the first
    REQUIRE(picture.picture != nullptr);
    const uint32_t first = audience.picture_leaves(picture, 100, 100, 0);
    CHECK(next(audience).client == 0);
    audience.publish(small_frame(), 0);
    audience.picture_leaves(next(audience), 100, 100, 0);
    for (int i = 0; i < 5; ++i) audience.publish(small_frame(), 0);
    CHECK(next(audience).client == 0); // two pictures are in transit
    CHECK_FALSE(audience.is_behind(0.2));
    CHECK(audience.received(1, R"({"type":"ack","frame":)" + std::to_string(first) + R"(,"ms":1})", 0.1).empty());
    CHECK(audience.is_behind(0.2));
    CHECK(next(audience).picture->number == 7); // the newest picture is sent and the earlier ones are not
}

TEST_CASE("the last picture is sent losslessly in pieces until a newer one exists") {
    Inbox inbox;
    Audience audience(inbox, "welcome");
    audience.open(1, 0);
    audience.received(1, kHello, 0);
    audience.publish(small_frame(true), 0);
    const auto acknowledge = [&](uint32_t frame) {
        audience.received(1, R"({"type":"ack","frame":)" + std::to_string(frame) + R"(,"ms":1})", 0.1);
    };
    SendJob job = next_picture(audience);
    CHECK_FALSE(job.is_piece);
    acknowledge(audience.picture_leaves(job, 100, 100, 0));
    job = next_picture(audience);
    CHECK(job.is_piece);
    CHECK(job.offset == 0);
    acknowledge(audience.picture_leaves(job, 600, 1000, 0));
    job = next_picture(audience);
    CHECK(job.is_piece);
    CHECK(job.offset == 600);
    audience.publish(small_frame(false), 0);
    acknowledge(audience.picture_leaves(job, 200, 1000, 0));
    job = next_picture(audience);
    CHECK_FALSE(job.is_piece); // the rest is dropped
    acknowledge(audience.picture_leaves(job, 100, 100, 0));
    CHECK(next_picture(audience).client == 0);
}

TEST_CASE("only the steering client's messages reach the renderer, and floods and nonsense drop their sender") {
    Inbox inbox;
    Audience audience(inbox, "welcome");
    audience.open(1, 0);
    audience.open(2, 0);
    CHECK_FALSE(audience.received(2, R"({"type":"home","n":1})", 0).empty()); // the client sent no hello
    audience.received(1, kHello, 0);
    audience.received(2, R"({"type":"hello","key":"b"})", 0);
    CHECK_FALSE(audience.received(2, kHello, 0).empty());
    inbox.take(std::chrono::milliseconds(0));
    CHECK(audience.received(2, R"({"type":"home","n":1})", 0).empty());
    CHECK(inbox.take(std::chrono::milliseconds(0)).empty());
    CHECK(audience.received(1, R"({"type":"home","n":1})", 0).empty());
    CHECK(inbox.take(std::chrono::milliseconds(0)).size() == 1);
    CHECK_FALSE(audience.received(1, "nonsense", 0).empty());
    std::string why;
    for (int i = 0; i < 2000 && why.empty(); ++i) why = audience.received(1, R"({"type":"home","n":1})", 0.1);
    CHECK(why == "too many messages");
    CHECK(inbox.take(std::chrono::milliseconds(0)).size() <= 1000);
}

TEST_CASE("a client that sends a message while the viewer ends is not blamed for a flood") {
    Inbox inbox;
    Audience audience(inbox, "welcome");
    audience.open(1, 0);
    audience.received(1, kHello, 0);
    inbox.close();
    CHECK(audience.received(1, R"({"type":"home","n":1})", 0).empty());
}

TEST_CASE("if the renderer is stuck, the steering client is dropped before its messages fill the memory") {
    Inbox inbox;
    Audience audience(inbox, "welcome");
    audience.open(1, 0);
    audience.received(1, kHello, 0);
    std::string why;
    for (int i = 0; i < 10000 && why.empty(); ++i) why = audience.received(1, R"({"type":"home","n":1})", i);
    CHECK(why == "too many messages wait");
}

TEST_CASE("clients over the limit and those without a hello are dropped") {
    Inbox inbox;
    Audience audience(inbox, "welcome");
    for (uint32_t i = 1; i <= Audience::kMaxClients; ++i) CHECK(audience.open(i, 0));
    CHECK_FALSE(audience.open(99, 0));
    audience.received(3, kHello, 0);
    CHECK(audience.tick(5).empty());
    CHECK(audience.tick(11).size() == Audience::kMaxClients - 1);
    audience.close(1, 11);
    CHECK(audience.open(99, 11));
}

TEST_CASE("the queue of a client that does not read stays small") {
    Inbox inbox;
    Audience audience(inbox, "welcome");
    audience.open(1, 0);
    audience.received(1, kHello, 0);
    CHECK(next(audience).text == "welcome"); // the text was never reported as sent
    for (int i = 0; i < 1000; ++i) {
        audience.notify(0, "note " + std::to_string(i));
        audience.report_state("state");
    }
    CHECK(next(audience).client == 0);
    audience.text_was_sent(1);
    int texts = 0;
    while (next(audience).client != 0) {
        audience.text_was_sent(1);
        ++texts;
    }
    CHECK(texts <= 10);
}
