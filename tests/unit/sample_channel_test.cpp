// The three interpolations of glTF 2.0 (appendix C), against values worked out by hand.

#include "scene/pose/sample_channel.h"

#include <array>
#include <cmath>

#include <doctest/doctest.h>

using namespace pertev;

namespace {

AnimationChannel channel(AnimatedPart part, Interpolation interpolation, std::vector<float> times,
                         std::vector<float> values) {
    AnimationChannel channel;
    channel.part = part;
    channel.interpolation = interpolation;
    channel.times = std::move(times);
    channel.values = std::move(values);
    return channel;
}

template <std::size_t count>
std::array<float, count> at(const AnimationChannel& channel, double time_s) {
    std::array<float, count> value{};
    sample_channel(channel, time_s, value);
    return value;
}

using Three = std::array<float, 3>;

/// A rotation about z.
Vec4 about_z(double radians) {
    return {0, 0, static_cast<float>(std::sin(radians / 2)), static_cast<float>(std::cos(radians / 2))};
}

bool close(Vec4 a, Vec4 b) {
    return std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z) + std::abs(a.w - b.w) < 1e-6f;
}

Vec4 rotation_at(const AnimationChannel& channel, double time_s) {
    const auto q = at<4>(channel, time_s);
    return {q[0], q[1], q[2], q[3]};
}

constexpr double kQuarter = 1.5707963267948966;

} // namespace

TEST_CASE("steps hold until the next key, and the first and the last value hold beyond the ends") {
    const auto steps = channel(AnimatedPart::Translation, Interpolation::Step, {1, 2, 4}, {1, 2, 3, 4, 5, 6, 7, 8, 9});
    CHECK(at<3>(steps, -5) == Three{1, 2, 3});
    CHECK(at<3>(steps, 1) == Three{1, 2, 3});
    CHECK(at<3>(steps, std::nextafter(2.0, 0.0)) == Three{1, 2, 3});
    CHECK(at<3>(steps, 2) == Three{4, 5, 6});
    CHECK(at<3>(steps, 3.9) == Three{4, 5, 6});
    CHECK(at<3>(steps, 4) == Three{7, 8, 9});
    CHECK(at<3>(steps, 1e300) == Three{7, 8, 9});
}

TEST_CASE("linear interpolation goes from key to key") {
    const auto lines = channel(AnimatedPart::Scale, Interpolation::Linear, {1, 2, 4}, {0, 0, 0, 8, 4, -8, 0, 0, 1});
    CHECK(at<3>(lines, 0) == Three{0, 0, 0});
    CHECK(at<3>(lines, 1.25) == Three{2, 1, -2});
    CHECK(at<3>(lines, 2) == Three{8, 4, -8});
    CHECK(at<3>(lines, 3) == Three{4, 2, -3.5f});
    CHECK(at<3>(lines, 9) == Three{0, 0, 1});
    // One key is a constant.
    const auto point = channel(AnimatedPart::Scale, Interpolation::Linear, {1}, {1, 2, 3});
    for (const double time : {0.0, 1.0, 2.0}) CHECK(at<3>(point, time) == Three{1, 2, 3});
}

TEST_CASE("cubic splines pass through their keys with their tangents, which are per second") {
    // The value 0 with tangent 1 per second and, 4 s later, the value 2 with tangent 0 give by Hermite's basis halfway
    // 0.5 * 0 + 4 * 0.125 * 1 + 0.5 * 2 - 4 * 0.125 * 0 = 1.5; at a quarter 4 * 0.140625 + 0.15625 * 2 = 0.875.
    const auto spline =
        channel(AnimatedPart::CameraFov, Interpolation::CubicSpline, {2, 6}, {99, 0, 1, /*second key*/ 0, 2, 99});
    CHECK(at<1>(spline, 0)[0] == 0);
    CHECK(at<1>(spline, 2)[0] == 0);
    CHECK(at<1>(spline, 4)[0] == 1.5f);
    CHECK(at<1>(spline, 3)[0] == 0.875f);
    CHECK(at<1>(spline, 6)[0] == 2);
    CHECK(at<1>(spline, 7)[0] == 2);
    // The slope at a key is that key's tangent.
    CHECK(at<1>(spline, 2.001)[0] == doctest::Approx(0.001).epsilon(0.01));
    // Values have several numbers, and each key has three such values.
    const auto weights = channel(AnimatedPart::Weights, Interpolation::CubicSpline, {0, 1},
                                 {0, 0, /**/ 1, 2, /**/ 0, 0, /*second key*/ 0, 0, /**/ 3, 6, /**/ 0, 0});
    CHECK(at<2>(weights, 0.5) == std::array<float, 2>{2, 4});
}

TEST_CASE("rotations take the shorter way at constant speed") {
    CHECK(close(slerp(about_z(0), about_z(kQuarter), 1.0f / 3), about_z(kQuarter / 3)));
    CHECK(close(slerp(about_z(0), about_z(kQuarter), 0), about_z(0)));
    CHECK(close(slerp(about_z(0), about_z(kQuarter), 1), about_z(kQuarter)));
    const Vec4 other_sign = -1.0f * about_z(kQuarter); // an equal rotation
    CHECK(close(slerp(about_z(0), other_sign, 0.5f), about_z(kQuarter / 2)));
    // Small angles keep their digits, equal keys have no rotation, and half a turn takes some path.
    CHECK(close(slerp(about_z(0), about_z(1e-3), 0.25f), about_z(0.25e-3)));
    CHECK(slerp(about_z(1), about_z(1), 0.3f) == slerp(about_z(1), about_z(1), 0));
    const Vec4 half = slerp({0, 0, 0, 1}, {0, 0, 1, 0}, 0.5f);
    CHECK(close(half, about_z(kQuarter)));

    const auto turn = channel(AnimatedPart::Rotation, Interpolation::Linear, {0, 1},
                              {0, 0, 0, 2, /*not unit*/ 0, 0, static_cast<float>(std::sin(kQuarter / 2)),
                               static_cast<float>(std::cos(kQuarter / 2))});
    CHECK(close(rotation_at(turn, 0.5), about_z(kQuarter / 2)));
    CHECK(rotation_at(turn, -1) == Vec4{0, 0, 0, 1});
}

TEST_CASE("a rotation by cubic splines is unit, and equals the previous key's where the spline is 0") {
    const auto turn = channel(AnimatedPart::Rotation, Interpolation::CubicSpline, {0, 1},
                              {0, 0, 0, 0, /**/ 0, 0, 0, 1, /**/ 0, 0, 0, 0, //
                               0, 0, 0, 0, /**/ 0, 0, 1, 0, /**/ 0, 0, 0, 0});
    CHECK(close(rotation_at(turn, 0.5), about_z(kQuarter)));
    const auto through = channel(AnimatedPart::Rotation, Interpolation::CubicSpline, {0, 1},
                                 {0, 0, 0, 0, /**/ 0, 0, 0, 1,  /**/ 0, 0, 0, 0, //
                                  0, 0, 0, 0, /**/ 0, 0, 0, -1, /**/ 0, 0, 0, 0});
    CHECK(rotation_at(through, 0.5) == Vec4{0, 0, 0, 1});
}

TEST_CASE("many keys late in a long animation keep distinct times") {
    std::vector<float> times, values;
    for (int i = 0; i < 1000; ++i) {
        times.push_back(3600 + static_cast<float>(i) / 64);
        values.insert(values.end(), {static_cast<float>(i), 0, 0});
    }
    const auto lines = channel(AnimatedPart::Translation, Interpolation::Linear, times, values);
    for (int i = 0; i < 999; ++i) {
        CHECK(at<3>(lines, 3600 + (i + 0.25) / 64)[0] == doctest::Approx(i + 0.25));
    }
}
