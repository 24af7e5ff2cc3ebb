// The numbers, times and files of frames.

#include "session/frame_range.h"

#include <doctest/doctest.h>

#include "base/error.h"
#include "session/sample_range.h"

using namespace pertev;

TEST_CASE("each run of # in a file name becomes the frame number") {
    CHECK(frame_file("frame-####.png", 7) == "frame-0007.png");
    CHECK(frame_file("frame-##.png", 12345) == "frame-12345.png");
    CHECK(frame_file("a#b/c#d##.exr", 3) == "a#b/c3d03.exr");
    CHECK(frame_file("###", 1) == "001");
    CHECK(names_frames("x#.png"));
    const std::vector<std::string> names = {"left", "right #2"}; // two cameras
    CHECK(frame_file("a{name}/v-##-{name}.exr", 1, names) == "a{name}/v-01-right #2.exr");
    CHECK(frame_file("{name}.exr", 0) == "{name}.exr");
    CHECK(names_frames("x/{name}.png"));
    CHECK(!names_frames("{name}/x.png"));
    CHECK(!names_frames("x#/y.png"));
    CHECK(!names_frames("x.png"));
}

TEST_CASE("frame k is at time k / fps, and a turntable ends where it began") {
    const FrameRange moving = {.first = 3, .last = 5, .fps = 24.0};
    CHECK(moving.count() == 3);
    CHECK(moving.time_of(3) == 3 / 24.0);
    CHECK(moving.turn_of(4) == 0);
    const FrameRange turning = {.last = 7, .time_s = 1.5, .turntable = 8};
    CHECK(turning.time_of(6) == 1.5);
    CHECK(turning.turn_of(2) == 0.25);
    CHECK(turning.turn_of(8) == 0);
    CHECK(!FrameRange{}.time_of(9));
}

TEST_CASE("the previous frame is one step back in time and on the turntable, even for the first") {
    const FrameRange moving = {.first = 3, .last = 5, .fps = 24.0};
    CHECK(moving.time_before(5) == moving.time_of(4));
    CHECK(moving.time_before(0) == -1 / 24.0);
    const FrameRange turning = {.last = 7, .time_s = 1.5, .turntable = 8};
    CHECK(turning.time_before(0) == 1.5);
    CHECK(turning.turn_before(0) == 0.875);
    CHECK(turning.turn_before(3) == turning.turn_of(2));
    CHECK(turning.turn_before(8) == turning.turn_of(7));
    CHECK(moving.turn_before(0) == 0);
}

TEST_CASE("parts of a sequence are all frames once, in order, also if there are more parts than frames") {
    PictureOptions options;
    options.frames = "3-12";
    for (const uint32_t count : {1u, 3u, 10u, 13u}) {
        uint32_t next = 3;
        for (uint32_t i = 1; i <= count; ++i) {
            options.part = std::to_string(i) + '/' + std::to_string(count);
            const std::optional<FrameRange> range = frame_range(options);
            REQUIRE(range);
            CHECK(range->first == 3); // the whole stays known
            CHECK(range->count() == 10);
            const auto [first, end] = range->of_part();
            CHECK(first == next);
            CHECK(end >= first);
            CHECK(end - first <= 10 / count + 1);
            next = end;
            CHECK(sample_range(options).count() == options.render.samples); // parts of frames have all samples
        }
        CHECK(next == 13);
    }
    CHECK(FrameRange{.first = 0, .last = 1'000'000'000, .part = PartNumber{6, 7}}.of_part() ==
          std::pair(857'142'858u, 1'000'000'001u));
    options.part = "14/13";
    CHECK_THROWS_AS(frame_range(options), Error);
    options.part_base = 2;
    CHECK(frame_range(options)->part->index == 12);
}

TEST_CASE("a frame's history begins at the latest cut, or at the first frame") {
    PictureOptions options;
    options.frames = "3-12";
    options.cuts = "1,5,9,40";
    const FrameRange range = frame_range(options).value();
    const uint32_t expected[] = {3, 3, 5, 5, 5, 5, 9, 9, 9, 9};
    for (uint32_t frame = 3; frame <= 12; ++frame) {
        CHECK(range.cut_before(frame) == expected[frame - 3]);
        CHECK(range.is_cut(frame) == (frame == 3 || frame == 5 || frame == 9));
    }
    options.cuts = "";
    CHECK(frame_range(options)->cut_before(12) == 3);
    for (const char* wrong : {",", "1,", ",1", "5,5", "5,4", "a", "1.5", "-1", "1 ", "1000000001"}) {
        options.cuts = wrong;
        CHECK_THROWS_AS(frame_range(options), Error);
    }
}
