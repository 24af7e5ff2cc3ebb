// Rigid motions while a shutter is open: keys fitted to transforms, interpolation between them, and boxes of the whole
// motion.

#include "math/motion_keys.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "tests/support/random.h"

using namespace pertev;

namespace {

Transform turned_about(Vec3 axis, float angle) {
    const Vec3 half = std::sin(0.5f * angle) * normalize(axis);
    return make_rotation(half.x, half.y, half.z, std::cos(0.5f * angle));
}

/// A box of one metre, with a random position, scale and shear.
PlacedBox skewed_box() {
    Transform skew = make_scale({2, 0.5f, 1});
    skew.row0.y = 0.4f;
    const Transform place = compose(make_translation({3, -1, 2}), compose(turned_about({1, 2, 3}, 0.7f), skew));
    return {place, {{-0.5f, -0.2f, -0.4f}, {0.6f, 0.3f, 0.4f}}};
}

MotionKeys keys_of(const FittedMotions& fitted) {
    const Motion& motion = fitted.motions.front();
    return {fitted.segments, motion.keys, {motion.pivot}, {0}};
}

double distance(Vec3 a, Vec3 b) { return static_cast<double>(length(a - b)); }

} // namespace

TEST_CASE("a motion maps an object to its position at any time, and back") {
    const PlacedBox box = skewed_box();
    struct Case {
        float turn, way;
        uint32_t max_segments;
    };
    for (const Case c : {Case{0.05f, 0.1f, 8}, Case{1.2f, 2.0f, 16}, Case{6.2831853f, 0.0f, 64}}) {
        CAPTURE(c.turn);
        const auto place_at = [&](double time) {
            const auto t = static_cast<float>(time);
            const Transform about =
                compose(make_translation({c.way * t, 0.5f * c.way * t, 0}),
                        compose(make_translation({3, -1, 2}), turned_about({0, 1, 0.3f}, c.turn * t)));
            return compose(about, compose(make_translation({-3, 1, -2}), box.world_from_local));
        };
        const FittedMotions fitted =
            fit_motions({&box, 1}, [&](double time) { return std::vector{std::optional(place_at(time))}; });
        CHECK(fitted.segments <= c.max_segments);
        const MotionKeys keys = keys_of(fitted);
        for (int i = 0; i <= 100; ++i) {
            const float time = 0.01f * static_cast<float>(i);
            const RigidMotion motion = keys.view().at(0, time);
            const Transform wanted = place_at(static_cast<double>(time));
            for (const Vec3 local : {box.box.lo, box.box.hi, Vec3{0.6f, -0.2f, 0.4f}}) {
                const Vec3 rest = transform_point(box.world_from_local, local), now = motion.move(rest);
                CHECK(distance(now, transform_point(wanted, local)) < 0.002);
                CHECK(distance(motion.move_back(now), rest) < static_cast<double>(2 * motion.error(rest)));
            }
            const Vec3 along = {0.3f, -0.2f, 0.9f};
            CHECK(distance(motion.rotate_back(motion.rotate(along)), along) < 1e-6);
            CHECK(length(motion.rotate(along)) == doctest::Approx(length(along)).epsilon(1e-6));
        }
        const RigidMotion at_rest = keys.view().at(0, kAtRest);
        CHECK(at_rest.move({1, 2, 3}) == Vec3{1, 2, 3});
    }
}

TEST_CASE("still objects have no keys, and motions that are not rigid are left out") {
    const PlacedBox box = skewed_box();
    const FittedMotions still =
        fit_motions({&box, 1}, [&](double) { return std::vector{std::optional(box.world_from_local)}; });
    CHECK(still.segments == kFewestMotionSegments);
    CHECK(still.motions.front().keys.empty());

    const auto grown = [&](double time) {
        const auto t = static_cast<float>(time);
        return std::optional(
            compose(make_translation({t, 0, 0}), compose(box.world_from_local, make_scale({1 + t, 1, 1}))));
    };
    const FittedMotions fitted = fit_motions({&box, 1}, [&](double time) { return std::vector{grown(time)}; });
    const RigidMotion end = keys_of(fitted).view().at(0, 1);
    const Vec3 middle = box.box.centre();
    CHECK(distance(end.move(transform_point(box.world_from_local, middle)), transform_point(*grown(1), middle)) < 1e-5);
    const Vec3 a = transform_point(box.world_from_local, box.box.lo),
               b = transform_point(box.world_from_local, box.box.hi);
    CHECK(distance(end.move(a), end.move(b)) == doctest::Approx(distance(a, b)).epsilon(1e-5)); // is not enlarged

    // A time without a transform repeats the previous one.
    const FittedMotions gone = fit_motions({&box, 1}, [&](double time) {
        return std::vector{time > 0.4 ? std::nullopt : std::optional(box.world_from_local)};
    });
    CHECK(gone.motions.front().keys.empty());
}

TEST_CASE("motion between equal poses at evenly spaced times is found") {
    const PlacedBox box = skewed_box();
    const auto segments_of = [&](const std::function<Transform(double)>& place_at, std::span<const double> looks = {}) {
        const FittedMotions fitted = fit_motions(
            {&box, 1}, [&](double time) { return std::vector{std::optional(place_at(time))}; }, looks);
        CHECK(!fitted.motions.front().keys.empty());
        return fitted.segments;
    };
    // A wheel turns eight times, so that it is in its initial pose at each of the first keys.
    CHECK(segments_of([&](double time) {
              return compose(box.world_from_local, turned_about({0, 0, 1}, 50.26548246f * static_cast<float>(time)));
          }) > kFewestMotionSegments);
    // A hop is so short that it is missed unless its time is among the given keys.
    const auto hop = [&](double time) {
        const double height = std::max(0.0, 1 - 100 * std::fabs(time - 0.29));
        return compose(make_translation({0, static_cast<float>(height), 0}), box.world_from_local);
    };
    const double key = 0.29;
    CHECK(segments_of(hop, {&key, 1}) == kMaxMotionSegments);
}

TEST_CASE("the swept box contains every position of an object") {
    const PlacedBox box = skewed_box();
    test::Random random(7);
    for (int round = 0; round < 40; ++round) {
        CAPTURE(round);
        const Vec3 axis = {random.within(-1, 1), random.within(-1, 1), random.within(-1, 1)};
        const float turn = random.within(0, 8);
        const Vec3 way = {random.within(-3, 3), random.within(-3, 3), random.within(-3, 3)};
        const FittedMotions fitted = fit_motions({&box, 1}, [&](double time) {
            const auto t = static_cast<float>(time);
            return std::vector{std::optional(
                compose(make_translation(t * way), compose(turned_about(axis, turn * t), box.world_from_local)))};
        });
        const MotionKeys keys = keys_of(fitted);
        Bounds3 rest;
        for (int corner = 0; corner < 8; ++corner) {
            rest.extend(transform_point(box.world_from_local, {corner & 1 ? box.box.hi.x : box.box.lo.x,
                                                               corner & 2 ? box.box.hi.y : box.box.lo.y,
                                                               corner & 4 ? box.box.hi.z : box.box.lo.z}));
        }
        const Bounds3 swept = swept_bounds(keys, 0, rest);
        MotionKeys with_another = keys; // data after the last key does not belong to it
        with_another.keys.push_back({{kInfinity, 0, 0, 0}, {kInfinity, 0, 0}});
        CHECK(swept_bounds(with_another, 0, rest) == swept);
        bool holds_all = true;
        for (int i = 0; i < 4000; ++i) {
            const int corner = i % 8; // the corners move farthest
            const Vec3 p = {corner & 1 ? rest.hi.x : rest.lo.x, corner & 2 ? rest.hi.y : rest.lo.y,
                            corner & 4 ? rest.hi.z : rest.lo.z};
            const Vec3 at = keys.view().at(0, random.within(0, 1)).move(p);
            Bounds3 with = swept;
            with.extend(at);
            holds_all = holds_all && with == swept;
        }
        CHECK(holds_all);
        CHECK(max_component(swept.size()) < 4 * (max_component(abs(way)) + 3 * max_component(rest.size()) + 10));
    }
}
