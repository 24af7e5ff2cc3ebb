// Key times that files can have: equal, unsorted, negative, not finite.

#include <limits>

#include <doctest/doctest.h>

#include "formats/gltf/repair_keys.h"
#include "math/scalar.h"
#include "scene/pose/sample_channel.h"
#include "scene/scene.h"
#include "scene/validate/validate_parts.h"
#include "tests/support/gltf_builder.h"

using namespace pertev;

namespace mend_keys_test { // test files are compiled together

/// A channel with three numbers per key, of which the first is `x`.
AnimationChannel channel_of(std::vector<float> times, const std::vector<float>& x,
                            Interpolation interpolation = Interpolation::Linear) {
    AnimationChannel channel;
    channel.interpolation = interpolation;
    channel.times = std::move(times);
    for (const float value : x) channel.values.insert(channel.values.end(), {value, 0, 0});
    return channel;
}

float at(const AnimationChannel& channel, double time_s) {
    float value[3];
    sample_channel(channel, time_s, value);
    return value[0];
}

AnimationChannel mended(AnimationChannel channel, bool is_reported) {
    CHECK(!gltf::repair_keys(channel, 3).empty() == is_reported);
    Scene scene;
    scene.nodes.resize(1);
    CHECK(fault_of(channel, scene).empty());
    return channel;
}

TEST_CASE("keys in order are unchanged") {
    const AnimationChannel good = mended(channel_of({0, 1, 2}, {1, 2, 3}), false);
    CHECK(good.times == std::vector<float>{0, 1, 2});
    CHECK(good.values.size() == 9);
}

TEST_CASE("two keys at the same time are a jump") {
    const AnimationChannel jump = mended(channel_of({0, 1, 1, 2}, {-1, -0.5f, 0.5f, 1}), false);
    CHECK(at(jump, 0.5) == -0.75f);
    CHECK(at(jump, 0.999) == doctest::Approx(-0.5).epsilon(0.01));
    CHECK(at(jump, 1) == 0.5f);
    CHECK(at(jump, 1.5) == 0.75f);
    const AnimationChannel of_many = mended(channel_of({0, 1, 1, 1, 1, 2}, {-1, -0.5f, 7, 8, 0.5f, 1}), false);
    CHECK(of_many.times == jump.times);
    CHECK(of_many.values == jump.values);
}

TEST_CASE("keys at one time are merged at the ends of a channel") {
    const AnimationChannel channel = mended(channel_of({1, 1, 2, 2}, {-9, 0, 1, 9}), false);
    CHECK(channel.times == std::vector<float>{1, 2});
    CHECK(at(channel, 0) == 0);
    CHECK(at(channel, 1.5) == 0.5f);
    CHECK(at(channel, 3) == 1);
    CHECK(mended(channel_of({1, 1}, {2, 3}), false).times.size() == 1);
    const AnimationChannel steps = mended(channel_of({0, 1, 1, 2, 2}, {0, 1, 2, 3, 4}, Interpolation::Step), false);
    CHECK(at(steps, 1) == 2);
    CHECK(at(steps, 5) == 4);
}

TEST_CASE("unsorted keys are sorted, negative times are valid, and times that are not finite are left out") {
    const AnimationChannel sorted = mended(channel_of({2, 0, 1}, {20, 0, 10}), true);
    CHECK(sorted.times == std::vector<float>{0, 1, 2});
    CHECK(at(sorted, 1.5) == 15);
    const AnimationChannel negative = mended(channel_of({-1, 1}, {0, 4}), false);
    CHECK(at(negative, 0) == 2);
    const AnimationChannel finite =
        mended(channel_of({0, std::numeric_limits<float>::quiet_NaN(), 1, kInfinity}, {0, 5, 1, 6}), true);
    CHECK(finite.times == std::vector<float>{0, 1});
    CHECK(at(finite, 9) == 1);
}

TEST_CASE("a spline jumps between the values of its keys, with their own tangents") {
    AnimationChannel spline;
    spline.interpolation = Interpolation::CubicSpline;
    spline.times = {0, 1, 1, 2};
    for (const float value : {0.0f, 0.0f, 4.0f, 4.0f}) {
        for (const float number : {0.0f, value, 0.0f}) spline.values.insert(spline.values.end(), {number, 0, 0});
    }
    CHECK(gltf::repair_keys(spline, 9).empty());
    CHECK(at(spline, 0.5) == 0);
    CHECK(at(spline, 1) == 4);
    CHECK(at(spline, 1.5) == 4);
}

TEST_CASE("a glTF file's keys are repaired as it is read, with a warning that names the channel") {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("SCALAR", std::vector<float>{0, 2, 1});
    builder.add("VEC3", std::vector<float>{0, 0, 0, 2, 0, 0, 1, 0, 0});
    Messages messages;
    const Scene scene = test::read_gltf_text(
        builder.json(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"animations":[)"
                     R"({"samplers":[{"input":1,"output":2}],"channels":[{"sampler":0,"target":)"
                     R"({"node":0,"path":"translation"}}]}])"),
        messages);
    REQUIRE(scene.animations.at(0).channels.size() == 1);
    CHECK(at(scene.animations[0].channels[0], 1.5) == 1.5f);
    CHECK(test::has_warning(messages, {"/animations/0/channels/0", "sorted by time"}));
    CHECK(messages.left_out().empty());
}

} // namespace mend_keys_test
