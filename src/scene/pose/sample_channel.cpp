#include "scene/pose/sample_channel.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "math/portable_math.h"

namespace pertev {
namespace {

float length(Vec4 q) { return sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w); }

/// Normalizes a quaternion; not finite for 0.
Vec4 unit(Vec4 q) {
    const auto squared = [](float x) { return static_cast<double>(x) * static_cast<double>(x); };
    const double size = std::sqrt(squared(q.x) + squared(q.y) + squared(q.z) + squared(q.w));
    const auto part = [&](float x) { return static_cast<float>(static_cast<double>(x) / size); };
    return {part(q.x), part(q.y), part(q.z), part(q.w)};
}

bool is_finite_rotation(Vec4 q) { return is_finite(q.x) && is_finite(q.y) && is_finite(q.z) && is_finite(q.w); }

Vec4 quaternion(std::span<const float> v) { return {v[0], v[1], v[2], v[3]}; }

void put(Vec4 q, std::span<float> value) { value[0] = q.x, value[1] = q.y, value[2] = q.z, value[3] = q.w; }

/// Evaluates the cubic of section C.5. `seconds` is the time between the two keys; tangents are per second.
double cubic(double before, double out, double in, double after, double t, double seconds) {
    const double t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * before + seconds * (t3 - 2 * t2 + t) * out + (3 * t2 - 2 * t3) * after +
           seconds * (t3 - t2) * in;
}

/// The keys of a channel, each with its one or three values.
struct Keys {
    const AnimationChannel& channel;
    std::size_t numbers; // components of a value

    std::span<const float> at(std::size_t key, std::size_t part) const {
        const std::size_t parts = channel.interpolation == Interpolation::CubicSpline ? 3 : 1;
        return std::span(channel.values).subspan((key * parts + part) * numbers, numbers);
    }
    std::span<const float> value(std::size_t key) const {
        return at(key, channel.interpolation == Interpolation::CubicSpline ? 1 : 0);
    }
};

} // namespace

Vec4 slerp(Vec4 a, Vec4 b, float t) {
    const float sign = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w < 0 ? -1.0f : 1.0f;
    b = sign * b;
    // Kahan's angle between two unit vectors, which is precise for small and large angles.
    const float angle = 2 * atan2(length(a + -1.0f * b), length(a + b));
    float of_a = 1 - t, of_b = t;
    if (angle > 0x1p-12f) { // otherwise the chord equals the arc
        const float inv = 1 / sin(angle);
        of_a = sin((1 - t) * angle) * inv;
        of_b = sin(t * angle) * inv;
    }
    return unit(of_a * a + of_b * b);
}

DoubleVec3 sample_translation(const AnimationChannel& channel, double time_s) {
    const std::vector<float>& times = channel.times;
    const Keys keys = {channel, 3};
    const auto at = [](std::span<const float> v) { return to_double(Vec3{v[0], v[1], v[2]}); };
    const auto above = std::ranges::upper_bound(times, time_s, {}, [](float t) { return static_cast<double>(t); });
    if (above == times.begin()) return at(keys.value(0));
    const auto after = static_cast<std::size_t>(above - times.begin()), before = after - 1;
    const DoubleVec3 a = at(keys.value(before));
    if (after == times.size() || channel.interpolation == Interpolation::Step) return a;

    const DoubleVec3 b = at(keys.value(after));
    const double start = static_cast<double>(times[before]);
    const double seconds = static_cast<double>(times[after]) - start, t = (time_s - start) / seconds;
    if (channel.interpolation == Interpolation::Linear) {
        const auto between = [t](double from, double to) { return (1 - t) * from + t * to; };
        return {between(a.x, b.x), between(a.y, b.y), between(a.z, b.z)};
    }
    const DoubleVec3 out = at(keys.at(before, 2)), in = at(keys.at(after, 0));
    return {cubic(a.x, out.x, in.x, b.x, t, seconds), cubic(a.y, out.y, in.y, b.y, t, seconds),
            cubic(a.z, out.z, in.z, b.z, t, seconds)};
}

void sample_channel(const AnimationChannel& channel, double time_s, std::span<float> value) {
    const std::vector<float>& times = channel.times;
    const Keys keys = {channel, value.size()};
    const bool is_rotation = channel.part == AnimatedPart::Rotation;
    const auto hold = [&](std::size_t key) {
        std::ranges::copy(keys.value(key), value.begin());
        if (is_rotation) put(unit(quaternion(value)), value);
    };
    const auto above = std::ranges::upper_bound(times, time_s, {}, [](float t) { return static_cast<double>(t); });
    if (above == times.begin()) return hold(0);
    const auto after = static_cast<std::size_t>(above - times.begin()), before = after - 1;
    if (after == times.size() || channel.interpolation == Interpolation::Step) return hold(before);

    const double start = static_cast<double>(times[before]);
    const double seconds = static_cast<double>(times[after]) - start, share = (time_s - start) / seconds;
    const std::span<const float> a = keys.value(before), b = keys.value(after);
    if (channel.interpolation == Interpolation::CubicSpline) {
        const std::span<const float> out = keys.at(before, 2), in = keys.at(after, 0);
        for (std::size_t i = 0; i < value.size(); ++i) {
            value[i] = static_cast<float>(cubic(static_cast<double>(a[i]), static_cast<double>(out[i]),
                                                static_cast<double>(in[i]), static_cast<double>(b[i]), share, seconds));
        }
        if (!is_rotation) return;
        const Vec4 rotation = unit(quaternion(value));
        put(is_finite_rotation(rotation) ? rotation : unit(quaternion(a)), value);
        return;
    }
    const float t = static_cast<float>(share);
    if (is_rotation) return put(slerp(unit(quaternion(a)), unit(quaternion(b)), t), value);
    for (std::size_t i = 0; i < value.size(); ++i) value[i] = (1 - t) * a[i] + t * b[i];
}

} // namespace pertev
