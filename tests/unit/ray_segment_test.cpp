// Boxes tested against a segment: a box with a hit is entered at every size and in every direction, however often the
// segment was shortened and down to the hit itself; boxes behind or beyond are not.

#include "trace/intersect/ray_segment.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "accel/bvh/compressed_bvh.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "trace/intersect/compressed_boxes.h"
#include "trace/intersect/octant_boxes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Returns whether the ray enters the box. The code for the ray's own octant and that for any octant must agree.
bool enters_octant_box(const RayOctantBoxes& boxes, const Bounds3& box) {
    BvhNode node{};
    set_child(node, 1, box, 0);
    const int octant = octant_of(boxes.segment.inv);
    float entry = -1, same = -2;
    bool entered = false;
    [&]<int... kOctants>(std::integer_sequence<int, kOctants...>) {
        ((octant == kOctants ? void(entered = enters_child<kOctants>(boxes, node, 1, entry)) : void()), ...);
    }(std::make_integer_sequence<int, 8>{});
    CHECK(enters_child<kAnyOctant>(boxes, node, 1, same) == entered);
    CHECK(entry == same);
    return entered;
}

bool enters_compressed_box(const RaySegment& segment, Vec3 origin, const Bounds3& box, const Bounds3& beside) {
    Bounds3 slots[8];
    slots[5] = box;
    slots[2] = beside;
    CompressedBvhNode node{};
    set_boxes(node, slots);
    float entries[8];
    return (enters_slots(origin, segment, node, entries) >> 5 & 1) != 0;
}

/// Returns the smallest box that contains the point.
Bounds3 box_around(const double (&p)[3]) {
    const auto below = [](double x) {
        const float f = static_cast<float>(x);
        return static_cast<double>(f) > x ? std::nextafter(f, -kInfinity) : f;
    };
    const auto above = [](double x) {
        const float f = static_cast<float>(x);
        return static_cast<double>(f) < x ? std::nextafter(f, kInfinity) : f;
    };
    return {{below(p[0]), below(p[1]), below(p[2])}, {above(p[0]), above(p[1]), above(p[2])}};
}

float power(int exponent) { return static_cast<float>(std::ldexp(1.0, exponent)); }

} // namespace

TEST_CASE("a box that contains a hit is entered, however small, and however often the segment was shortened") {
    Random random(7);
    uint64_t missed = 0;
    for (uint32_t i = 0; i < static_cast<uint32_t>(effort(40'000, 1'000'000)); ++i) {
        const float size = power(std::array{-70, -40, -3, 0, 12, 36}[random.below(6)]);
        Ray ray;
        ray.origin = size * random.point(-1, 1);
        float d[3];
        for (float& x : d) x = random.within(-1, 1) * power(std::array{0, 0, 0, -12, -38, -100, -149}[random.below(7)]);
        d[random.below(3)] = random.below(2) == 0 ? 1.0f : -1.0f;
        ray.direction = power(static_cast<int>(random.below(30)) - 15) * Vec3{d[0], d[1], d[2]};
        const float t = 2 * random.unit() * size / max_component(abs(ray.direction));
        double p[3];
        for (int a = 0; a < 3; ++a) {
            p[a] = static_cast<double>(component(ray.origin, a)) +
                   static_cast<double>(t) * static_cast<double>(component(ray.direction, a));
        }
        const Bounds3 box = box_around(p);
        Bounds3 beside;
        beside.extend(box.lo);
        if (random.below(2) == 0) beside.extend(size * random.point(-2, 2));
        Bounds3 all = box;
        all.extend(beside);
        const float limit = random.below(3) == 0 ? kInfinity : t * (1 + 3 * random.unit());
        RayOctantBoxes boxes = make_ray_octant_boxes<ExactTests>(ray, all.max_abs(), random.below(3) == 0 ? t : limit);
        for (uint32_t times = random.below(6); times != 0; --times) {
            const float end = boxes.segment.end;
            boxes.segment.shorten(times == 1 ? t : t + (end - t) * random.unit());
            boxes.set_planes(ray.origin);
        }
        missed += enters_octant_box(boxes, box) ? 0 : 1;
        missed += enters_compressed_box(boxes.segment, ray.origin, box, beside) ? 0 : 1;
    }
    CHECK(missed == 0);
}

TEST_CASE("boxes before a segment's start or beyond its end are not entered") {
    const Ray ray = {{0, 0.25f, -0.5f}, 0, {-2, 0, 0}, kInfinity};
    const auto at = [](float from, float to) { return Bounds3{{-2 * to, -1, -1}, {-2 * from, 1, 1}}; };
    RayOctantBoxes boxes = make_ray_octant_boxes<ExactTests>(ray, 100, 10);
    const auto enters = [&](float from, float to) {
        const bool entered = enters_octant_box(boxes, at(from, to));
        CHECK(enters_compressed_box(boxes.segment, ray.origin, at(from, to), at(from, to)) == entered);
        return entered;
    };
    CHECK(enters(9, 11));
    CHECK(enters(-1, 1));
    CHECK(!enters(10.01f, 12));
    CHECK(!enters(-3, -0.01f));
    CHECK(enters(6, 7));
    boxes.segment.shorten(5);
    boxes.set_planes(ray.origin);
    CHECK(boxes.segment.end == 5);
    CHECK(!enters(6, 7));
    CHECK(enters(4, 4.5f));
    boxes.segment.shorten(8); // the segment does not get longer again
    CHECK(boxes.segment.end == 5);
}

TEST_CASE("a segment without a limit ends where the ray has left the scene") {
    const Ray ray = {{3, 0, 0}, 0, {0.5f, -0.25f, 0}, kInfinity};
    const RaySegment segment = make_ray_segment<ExactTests>(ray, 5, kInfinity);
    CHECK(segment.end >= 16);
    CHECK(segment.end < 16.1f);
}
