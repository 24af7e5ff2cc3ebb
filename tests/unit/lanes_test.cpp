// Functions of eight lanes give in each lane the bits of the scalar functions.

#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "device_scene/ray_origin.h"
#include "math/frame.h"
#include "math/lanes.h"
#include "math/sampling.h"
#include "math/transform.h"
#include "shading/environment_light.h"
#include "shading/power_heuristic.h"
#include "shading/shading_frame.h"
#include "shading/shadow_terminator.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

constexpr uint32_t kRounds = 2000;

/// Returns whether both have the same bits, or are NaN, whose bits say nothing.
bool is_same(float a, float b) { return bits_of(a) == bits_of(b) || (a != a && b != b); }
bool is_same(Vec3 a, Vec3 b) { return is_same(a.x, b.x) && is_same(a.y, b.y) && is_same(a.z, b.z); }

template <class Of>
Floats8 lanes_of(const std::vector<float>& values, const Of& index) {
    float all[8];
    for (uint32_t lane = 0; lane < 8; ++lane) all[lane] = values[index(lane) % values.size()];
    return Floats8::load(all);
}

/// Eight vectors, and each of them.
struct Vectors {
    Vec3 one[8];
    template <class Draw>
    explicit Vectors(const Draw& draw) {
        for (Vec3& v : one) v = draw();
    }
    Vec3Of<Floats8> all() const {
        float x[8], y[8], z[8];
        for (int lane = 0; lane < 8; ++lane) x[lane] = one[lane].x, y[lane] = one[lane].y, z[lane] = one[lane].z;
        return {Floats8::load(x), Floats8::load(y), Floats8::load(z)};
    }
};
struct Numbers {
    float one[8];
    template <class Draw>
    explicit Numbers(const Draw& draw) {
        for (float& x : one) x = draw();
    }
    Floats8 all() const { return Floats8::load(one); }
};

Vec3 lane_of(const Vec3Of<Floats8>& v, uint32_t lane) { return {v.x[lane], v.y[lane], v.z[lane]}; }

/// Checks a result of eight lanes against a function of the lane.
template <class One>
void check_lanes(const Vec3Of<Floats8>& all, const One& one) {
    for (uint32_t lane = 0; lane < 8; ++lane) CHECK(is_same(lane_of(all, lane), one(lane)));
}
template <class One>
void check_lanes(Floats8 all, const One& one) {
    for (uint32_t lane = 0; lane < 8; ++lane) CHECK(is_same(all[lane], one(lane)));
}
template <class One>
void check_lanes(Mask8 all, const One& one) {
    for (uint32_t lane = 0; lane < 8; ++lane) CHECK(((bit_mask(all) >> lane & 1) != 0) == one(lane));
}

} // namespace

TEST_CASE("arithmetic and comparisons of eight lanes have the bits of one") {
    const std::vector<float> special = {0.0f,  -0.0f, 1.0f,    -1.0f,     0x1p-149f,  -0x1p-127f, 0x1.fffffep127f,
                                        1e-3f, 3.25f, -7.125f, kInfinity, -kInfinity, kNaN};
    for (uint32_t i = 0; i < special.size(); ++i) {
        for (uint32_t j = 0; j < special.size(); ++j) {
            const auto at_a = [&](uint32_t lane) { return i + lane; };
            const auto at_b = [&](uint32_t lane) { return j + 3 * lane; };
            const Floats8 a = lanes_of(special, at_a), b = lanes_of(special, at_b);
            check_lanes(a + b, [&](uint32_t k) { return a[k] + b[k]; });
            check_lanes(a - b, [&](uint32_t k) { return a[k] - b[k]; });
            check_lanes(a * b, [&](uint32_t k) { return a[k] * b[k]; });
            check_lanes(a / b, [&](uint32_t k) { return a[k] / b[k]; });
            check_lanes(-a, [&](uint32_t k) { return -a[k]; });
            check_lanes(min(a, b), [&](uint32_t k) { return min(a[k], b[k]); });
            check_lanes(max(a, b), [&](uint32_t k) { return max(a[k], b[k]); });
            check_lanes(clamp(a, b, Floats8(2.0f)), [&](uint32_t k) { return clamp(a[k], b[k], 2.0f); });
            check_lanes(abs(a), [&](uint32_t k) { return pertev::abs(a[k]); });
            check_lanes(copysign(a, b), [&](uint32_t k) { return pertev::copysign(a[k], b[k]); });
            check_lanes(sqrt(a), [&](uint32_t k) { return pertev::sqrt(a[k]); });
            check_lanes(safe_sqrt(a), [&](uint32_t k) { return safe_sqrt(a[k]); });
            check_lanes(fma(a, b, a), [&](uint32_t k) { return pertev::fma(a[k], b[k], a[k]); });
            check_lanes(a < b, [&](uint32_t k) { return a[k] < b[k]; });
            check_lanes(a > b, [&](uint32_t k) { return a[k] > b[k]; });
            check_lanes(a <= b, [&](uint32_t k) { return a[k] <= b[k]; });
            check_lanes(a >= b, [&](uint32_t k) { return a[k] >= b[k]; });
            check_lanes(a == b, [&](uint32_t k) { return a[k] == b[k]; });
            check_lanes(a != b, [&](uint32_t k) { return a[k] != b[k]; });
            check_lanes((a < b) == (b > 0.0f), [&](uint32_t k) { return (a[k] < b[k]) == (b[k] > 0); });
            check_lanes(a < b && b > 0.0f, [&](uint32_t k) { return a[k] < b[k] && b[k] > 0; });
            check_lanes(a < b || b > 0.0f, [&](uint32_t k) { return a[k] < b[k] || b[k] > 0; });
            check_lanes(!(a < b), [&](uint32_t k) { return !(a[k] < b[k]); });
            check_lanes(is_finite(a), [&](uint32_t k) { return is_finite(a[k]); });
            check_lanes(select(a < b, a, b), [&](uint32_t k) { return a[k] < b[k] ? a[k] : b[k]; });
            check_lanes(next_float(a, b), [&](uint32_t k) { return next_float(a[k], b[k]); });
        }
    }
}

TEST_CASE("rows that are loaded as columns and stored back are the same rows") {
    float rows[8][8], back[8][8];
    for (int i = 0; i < 8; ++i) {
        for (int k = 0; k < 8; ++k) rows[i][k] = static_cast<float>(10 * i + k);
    }
    Floats8 columns[8];
    load_columns({rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7]}, columns);
    for (uint32_t k = 0; k < 8; ++k) {
        for (uint32_t i = 0; i < 8; ++i) CHECK(columns[k][i] == rows[i][k]);
    }
    store_columns(columns, {back[0], back[1], back[2], back[3], back[4], back[5], back[6], back[7]});
    for (int i = 0; i < 8; ++i) {
        for (int k = 0; k < 8; ++k) CHECK(back[i][k] == rows[i][k]);
    }
}

TEST_CASE("sampling of eight lanes has the bits of one") {
    test::Random random(1);
    for (uint32_t round = 0; round < kRounds; ++round) {
        // Some numbers lie on the diagonals and in the centre of the square.
        const auto draw = [&] {
            return random.below(8) == 0 ? 0.25f * static_cast<float>(random.below(5)) : random.unit();
        };
        const Numbers x(draw), y(draw), other([&] { return random.within(0.0f, 4.0f); });
        const Vec2Of<Floats8> u = {x.all(), y.all()};
        const auto one = [&](uint32_t k) { return Vec2{x.one[k], y.one[k]}; };
        check_lanes(sample_cosine_hemisphere(u), [&](uint32_t k) { return sample_cosine_hemisphere(one(k)); });
        check_lanes(sample_uniform_triangle(u).x, [&](uint32_t k) { return sample_uniform_triangle(one(k)).x; });
        check_lanes(sample_uniform_triangle(u).y, [&](uint32_t k) { return sample_uniform_triangle(one(k)).y; });
        check_lanes(sample_disk_polar(u).cosine, [&](uint32_t k) { return sample_disk_polar(one(k)).cosine; });
        check_lanes(sample_disk_polar(u).sine, [&](uint32_t k) { return sample_disk_polar(one(k)).sine; });
        check_lanes(sample_tent(x.all()), [&](uint32_t k) { return sample_tent(x.one[k]); });
        check_lanes(floor(other.all()), [&](uint32_t k) { return pertev::floor(other.one[k]); });
        check_lanes(lerp(x.all(), y.all(), other.all()),
                    [&](uint32_t k) { return pertev::lerp(x.one[k], y.one[k], other.one[k]); });
        check_lanes(environment_direction<Floats8>(x.all(), true, y.all()),
                    [&](uint32_t k) { return environment_direction(x.one[k], true, y.one[k]); });
        check_lanes(rest_of<Floats8>(other.all(), other.all() + 1.0f, bits_of(x.all())),
                    [&](uint32_t k) { return rest_of(other.one[k], other.one[k] + 1.0f, bits_of(x.one[k])); });
        check_lanes(power_heuristic(x.all(), other.all()),
                    [&](uint32_t k) { return power_heuristic(x.one[k], other.one[k]); });
        const PointOnTriangleOf<Floats8> inside = inset_barycentrics(x.all(), y.all(), other.all() * 0.05f);
        const auto inside_one = [&](uint32_t k) {
            return inset_barycentrics(x.one[k], y.one[k], other.one[k] * 0.05f);
        };
        check_lanes(inside.u, [&](uint32_t k) { return inside_one(k).u; });
        check_lanes(inside.v, [&](uint32_t k) { return inside_one(k).v; });
    }
}

TEST_CASE("shading frames of eight lanes have the bits of one") {
    test::Random random(2);
    for (uint32_t round = 0; round < kRounds; ++round) {
        const Vectors normal([&] { return random.direction(); }), other([&] { return random.direction(); });
        const Vectors wo([&] { return random.direction(); });
        const Vectors near([&] { // a normal little bent, or none
            return random.below(6) == 0 ? Vec3{0, 0, 0} : random.point(-0.2f, 0.2f) + Vec3{0, 0, 1};
        });
        const Numbers tilt([&] { return random.below(3) == 0 ? 0.0f : random.within(0.0f, kLargestTilt); });
        const auto of = [](const Vectors& v) { return [&v](uint32_t k) { return v.one[k]; }; };
        const auto n = of(normal), m = of(other), w = of(wo), b = of(near);
        const FrameOf<Floats8> frame = make_frame(normal.all());
        check_lanes(frame.tangent, [&](uint32_t k) { return make_frame(n(k)).tangent; });
        check_lanes(frame.bitangent, [&](uint32_t k) { return make_frame(n(k)).bitangent; });
        check_lanes(frame.to_local(wo.all()), [&](uint32_t k) { return make_frame(n(k)).to_local(w(k)); });
        check_lanes(frame.to_world(wo.all()), [&](uint32_t k) { return make_frame(n(k)).to_world(w(k)); });
        check_lanes(valid_normal(normal.all(), other.all(), wo.all()),
                    [&](uint32_t k) { return valid_normal(n(k), m(k), w(k)); });
        check_lanes(normalize_or(near.all(), {0, 0, 1}), [&](uint32_t k) { return normalize_or(b(k), {0, 0, 1}); });
        const RaisedDirectionOf<Floats8> raised = raise_direction(wo.all(), tilt.all());
        check_lanes(raised.direction, [&](uint32_t k) { return raise_direction(w(k), tilt.one[k]).direction; });
        check_lanes(raised.slope, [&](uint32_t k) { return raise_direction(w(k), tilt.one[k]).slope; });
        const RaisedDirectionOf<Floats8> lowered = lower_direction(wo.all(), tilt.all());
        check_lanes(lowered.direction, [&](uint32_t k) { return lower_direction(w(k), tilt.one[k]).direction; });
        check_lanes(lowered.slope, [&](uint32_t k) { return lower_direction(w(k), tilt.one[k]).slope; });
        check_lanes(terminator_tilt(tilt.all(), sine_between(normal.all(), other.all())),
                    [&](uint32_t k) { return terminator_tilt(tilt.one[k], sine_between(n(k), m(k))); });
        check_lanes(offset_ray_origin(near.all(), abs(other.all()), normal.all(), wo.all()),
                    [&](uint32_t k) { return offset_ray_origin(b(k), abs(m(k)), n(k), w(k)); });
    }
}
