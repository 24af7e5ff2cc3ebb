// The numbers, times and files of frames.

#include "session/frame_range.h"

#include <doctest/doctest.h>

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
