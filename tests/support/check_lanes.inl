// Compares functions of several lanes with the scalar functions in each lane, to the bit. The file that includes it
// names the number type: `Floats` is Floats8 or Floats16. It asserts nothing itself, so that a file for AVX-512 has no
// code that runs elsewhere.

#include "device_scene/ray_origin.h"
#include "device_scene/surface.h"
#include "math/frame.h"
#include "math/sampling.h"
#include "math/transform.h"
#include "shading/environment_light.h"
#include "shading/power_heuristic.h"
#include "shading/shading_frame.h"
#include "shading/shadow_terminator.h"
#include "tests/support/check_lanes_16.h"
#include "tests/support/random.h"

namespace pertev::test::lanes {
namespace {

constexpr uint32_t kLanes = Floats::kLanes;
constexpr uint32_t kRounds = 2000;
using Mask = MaskOf<Floats>;
using Words = WordOf<Floats>;
using Vec3s = Vec3Of<Floats>;

/// Returns whether both have the same bits, or are NaN, whose bits say nothing.
bool is_same(float a, float b) { return bits_of(a) == bits_of(b) || (a != a && b != b); }
bool is_same(uint32_t a, uint32_t b) { return a == b; }
bool is_same(bool a, bool b) { return a == b; }
bool is_same(Vec3 a, Vec3 b) { return is_same(a.x, b.x) && is_same(a.y, b.y) && is_same(a.z, b.z); }

float lane_of(Floats x, uint32_t lane) { return x[lane]; }
bool lane_of(Mask x, uint32_t lane) { return (bit_mask(x) >> lane & 1) != 0; }
uint32_t lane_of(Words x, uint32_t lane) { return x[lane]; }
Vec3 lane_of(const Vec3s& v, uint32_t lane) { return {v.x[lane], v.y[lane], v.z[lane]}; }

/// Compares results of all lanes with a function of the lane.
class LaneChecks {
public:
    template <class All, class One>
    void operator()(const All& all, const One& one, int line = __builtin_LINE()) {
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            if (!is_same(lane_of(all, lane), one(lane))) ++found.count, found.line = line;
        }
    }
    LaneDifferences found;
};

/// A number or vector of each lane.
struct Numbers {
    float one[kLanes];
    template <class Draw>
    explicit Numbers(const Draw& draw) {
        for (float& x : one) x = draw();
    }
    Floats all() const { return Floats::load(one); }
};
struct Vectors {
    Vec3 one[kLanes];
    template <class Draw>
    explicit Vectors(const Draw& draw) {
        for (Vec3& v : one) v = draw();
    }
    Vec3s all() const {
        float x[kLanes], y[kLanes], z[kLanes];
        for (uint32_t k = 0; k < kLanes; ++k) x[k] = one[k].x, y[k] = one[k].y, z[k] = one[k].z;
        return {Floats::load(x), Floats::load(y), Floats::load(z)};
    }
};
Words words_of(Random& random) {
    Words words;
    for (uint32_t k = 0; k < kLanes; ++k) words[k] = random.bits();
    return words;
}

void check_arithmetic(LaneChecks& same) {
    constexpr float kSpecial[] = {0.0f,  -0.0f, 1.0f,    -1.0f,     0x1p-149f,  -0x1p-127f, 0x1.fffffep127f,
                                  1e-3f, 3.25f, -7.125f, kInfinity, -kInfinity, kNaN};
    constexpr uint32_t kCount = sizeof kSpecial / sizeof kSpecial[0];
    for (uint32_t i = 0; i < kCount; ++i) {
        for (uint32_t j = 0; j < kCount; ++j) {
            uint32_t at_a = i, at_b = j;
            const Floats a = Numbers([&] { return kSpecial[at_a++ % kCount]; }).all();
            const Floats b = Numbers([&] { return kSpecial[(at_b += 3) % kCount]; }).all();
            same(a + b, [&](uint32_t k) { return a[k] + b[k]; });
            same(a - b, [&](uint32_t k) { return a[k] - b[k]; });
            same(a * b, [&](uint32_t k) { return a[k] * b[k]; });
            same(a / b, [&](uint32_t k) { return a[k] / b[k]; });
            same(-a, [&](uint32_t k) { return -a[k]; });
            same(min(a, b), [&](uint32_t k) { return min(a[k], b[k]); });
            same(max(a, b), [&](uint32_t k) { return max(a[k], b[k]); });
            same(clamp(a, b, Floats(2.0f)), [&](uint32_t k) { return clamp(a[k], b[k], 2.0f); });
            same(abs(a), [&](uint32_t k) { return pertev::abs(a[k]); });
            same(copysign(a, b), [&](uint32_t k) { return pertev::copysign(a[k], b[k]); });
            same(sqrt(a), [&](uint32_t k) { return pertev::sqrt(a[k]); });
            same(safe_sqrt(a), [&](uint32_t k) { return safe_sqrt(a[k]); });
            same(fma(a, b, a), [&](uint32_t k) { return pertev::fma(a[k], b[k], a[k]); });
            same(a < b, [&](uint32_t k) { return a[k] < b[k]; });
            same(a > b, [&](uint32_t k) { return a[k] > b[k]; });
            same(a <= b, [&](uint32_t k) { return a[k] <= b[k]; });
            same(a >= b, [&](uint32_t k) { return a[k] >= b[k]; });
            same(a == b, [&](uint32_t k) { return a[k] == b[k]; });
            same(a != b, [&](uint32_t k) { return a[k] != b[k]; });
            same((a < b) == (b > 0.0f), [&](uint32_t k) { return (a[k] < b[k]) == (b[k] > 0); });
            same((a < b) != (b > 0.0f), [&](uint32_t k) { return (a[k] < b[k]) != (b[k] > 0); });
            same(a < b && b > 0.0f, [&](uint32_t k) { return a[k] < b[k] && b[k] > 0; });
            same(a < b || b > 0.0f, [&](uint32_t k) { return a[k] < b[k] || b[k] > 0; });
            same(!(a < b), [&](uint32_t k) { return !(a[k] < b[k]); });
            same(is_finite(a), [&](uint32_t k) { return is_finite(a[k]); });
            same(select(a < b, a, b), [&](uint32_t k) { return a[k] < b[k] ? a[k] : b[k]; });
            same(select(a < b, bits_of(a), bits_of(b)), [&](uint32_t k) { return bits_of(a[k] < b[k] ? a[k] : b[k]); });
            float least = kInfinity, greatest = -kInfinity;
            for (uint32_t k = 0; k < kLanes; ++k) {
                if (a[k] != a[k]) continue;
                least = min(least, a[k]), greatest = max(greatest, a[k]);
            }
            same(least_of(select(a == a, a, kInfinity)) == least, [](uint32_t) { return true; });
            same(greatest_of(select(a == a, a, -kInfinity)) == greatest, [](uint32_t) { return true; });
            same(next_float(a, b), [&](uint32_t k) { return next_float(a[k], b[k]); });
        }
    }
}

void check_columns(LaneChecks& same) {
    float rows[kLanes][8], back[kLanes][8];
    std::array<const float*, kLanes> from;
    std::array<float*, kLanes> to;
    for (uint32_t i = 0; i < kLanes; ++i) {
        from[i] = rows[i], to[i] = back[i];
        for (uint32_t k = 0; k < 8; ++k) rows[i][k] = static_cast<float>(10 * i + k);
    }
    Floats columns[8];
    load_columns(from, columns);
    store_columns(columns, to);
    for (uint32_t k = 0; k < 8; ++k) {
        same(columns[k], [&](uint32_t i) { return rows[i][k]; });
        same(columns[k], [&](uint32_t i) { return back[i][k]; });
    }
}

void check_random_numbers(LaneChecks& same) {
    Random random(4);
    for (uint32_t round = 0; round < kRounds; ++round) {
        const Words x = words_of(random), group = words_of(random);
        const SampleKeyOf<Words> keys = {words_of(random), words_of(random) >> round % 32, words_of(random)};
        same(reverse_bits(x), [&](uint32_t k) { return reverse_bits(uint32_t{x[k]}); });
        same(unit_interval<Floats>(x), [&](uint32_t k) { return unit_interval(x[k]); });
        for (const SamplerKind kind : {SamplerKind::Sobol, SamplerKind::Independent}) {
            for (const Pair pair : {Pair::First, Pair::Last}) {
                const SampleBitsOf<Words> all = sample_bits<Words>(kind, keys, group, pair);
                const auto one = [&](uint32_t k) {
                    return sample_bits(kind, SampleKey{keys.stream[k], keys.sample[k], keys.seed[k]}, group[k], pair);
                };
                same(all.x, [&](uint32_t k) { return one(k).x; });
                same(all.y, [&](uint32_t k) { return one(k).y; });
            }
        }
    }
}

void check_sampling(LaneChecks& same) {
    Random random(1);
    for (uint32_t round = 0; round < kRounds; ++round) {
        // Some numbers lie on the diagonals, on the edges and in the centre of the square.
        const auto draw = [&] {
            return random.below(8) == 0 ? 0.25f * static_cast<float>(random.below(5)) : random.unit();
        };
        const Numbers x(draw), y(draw), other([&] { return random.within(0.0f, 4.0f); });
        const Vec2Of<Floats> u = {x.all(), y.all()};
        const auto one = [&](uint32_t k) { return Vec2{x.one[k], y.one[k]}; };
        const auto turn_one = [&](uint32_t k) {
            Vec2 turn;
            sin_cos_2pi(other.one[k] - 2.0f, turn.x, turn.y);
            return turn;
        };
        Vec2Of<Floats> turn;
        sin_cos_2pi(other.all() - 2.0f, turn.x, turn.y);
        same(turn.x, [&](uint32_t k) { return turn_one(k).x; });
        same(turn.y, [&](uint32_t k) { return turn_one(k).y; });
        same(sample_cosine_hemisphere(u), [&](uint32_t k) { return sample_cosine_hemisphere(one(k)); });
        same(sample_uniform_triangle(u).x, [&](uint32_t k) { return sample_uniform_triangle(one(k)).x; });
        same(sample_uniform_triangle(u).y, [&](uint32_t k) { return sample_uniform_triangle(one(k)).y; });
        same(sample_disk_polar(u).cosine, [&](uint32_t k) { return sample_disk_polar(one(k)).cosine; });
        same(sample_disk_polar(u).sine, [&](uint32_t k) { return sample_disk_polar(one(k)).sine; });
        const RegularPolygon triangle = {3, 1.0f / 3, 0.5f, 1.7320508f, 0.3f};
        same(sample_regular_polygon(triangle, u).x,
             [&](uint32_t k) { return sample_regular_polygon(triangle, one(k)).x; });
        same(sample_regular_polygon(triangle, u).y,
             [&](uint32_t k) { return sample_regular_polygon(triangle, one(k)).y; });
        same(sample_tent(x.all()), [&](uint32_t k) { return sample_tent(x.one[k]); });
        same(floor(other.all()), [&](uint32_t k) { return pertev::floor(other.one[k]); });
        same(gather<Floats>(y.one, truncate_to_word(other.all())),
             [&](uint32_t k) { return y.one[truncate_to_word(other.one[k])]; });
        same(lerp(x.all(), y.all(), other.all()),
             [&](uint32_t k) { return pertev::lerp(x.one[k], y.one[k], other.one[k]); });
        same(environment_direction<Floats>(x.all(), true, y.all()),
             [&](uint32_t k) { return environment_direction(x.one[k], true, y.one[k]); });
        same(rest_of<Floats>(other.all(), other.all() + 1.0f, bits_of(x.all())),
             [&](uint32_t k) { return rest_of(other.one[k], other.one[k] + 1.0f, bits_of(x.one[k])); });
        same(power_heuristic(x.all(), other.all()),
             [&](uint32_t k) { return power_heuristic(x.one[k], other.one[k]); });
        const PointOnTriangleOf<Floats> inside = inset_barycentrics(x.all(), y.all(), other.all() * 0.05f);
        const auto inside_one = [&](uint32_t k) {
            return inset_barycentrics(x.one[k], y.one[k], other.one[k] * 0.05f);
        };
        same(inside.u, [&](uint32_t k) { return inside_one(k).u; });
        same(inside.v, [&](uint32_t k) { return inside_one(k).v; });
    }
}

void check_frames(LaneChecks& same) {
    Random random(2);
    for (uint32_t round = 0; round < kRounds; ++round) {
        const Vectors normal([&] { return random.direction(); }), other([&] { return random.direction(); });
        const Vectors wo([&] { return random.direction(); });
        const Vectors near([&] { // a normal little bent, or none
            return random.below(6) == 0 ? Vec3{0, 0, 0} : random.point(-0.2f, 0.2f) + Vec3{0, 0, 1};
        });
        const Numbers tilt([&] { return random.below(3) == 0 ? 0.0f : random.within(0.0f, kLargestTilt); });
        const auto of = [](const Vectors& v) { return [&v](uint32_t k) { return v.one[k]; }; };
        const auto n = of(normal), m = of(other), w = of(wo), b = of(near);
        const FrameOf<Floats> frame = make_frame(normal.all());
        same(frame.tangent, [&](uint32_t k) { return make_frame(n(k)).tangent; });
        same(frame.bitangent, [&](uint32_t k) { return make_frame(n(k)).bitangent; });
        same(frame.to_local(wo.all()), [&](uint32_t k) { return make_frame(n(k)).to_local(w(k)); });
        same(frame.to_world(wo.all()), [&](uint32_t k) { return make_frame(n(k)).to_world(w(k)); });
        same(valid_normal(normal.all(), other.all(), wo.all()),
             [&](uint32_t k) { return valid_normal(n(k), m(k), w(k)); });
        same(normalize_or(near.all(), {0, 0, 1}), [&](uint32_t k) { return normalize_or(b(k), {0, 0, 1}); });
        const RaisedDirectionOf<Floats> raised = raise_direction(wo.all(), tilt.all());
        same(raised.direction, [&](uint32_t k) { return raise_direction(w(k), tilt.one[k]).direction; });
        same(raised.slope, [&](uint32_t k) { return raise_direction(w(k), tilt.one[k]).slope; });
        const RaisedDirectionOf<Floats> lowered = lower_direction(wo.all(), tilt.all());
        same(lowered.direction, [&](uint32_t k) { return lower_direction(w(k), tilt.one[k]).direction; });
        same(lowered.slope, [&](uint32_t k) { return lower_direction(w(k), tilt.one[k]).slope; });
        same(terminator_tilt(tilt.all(), sine_between(normal.all(), other.all())),
             [&](uint32_t k) { return terminator_tilt(tilt.one[k], sine_between(n(k), m(k))); });
        same(offset_ray_origin(near.all(), abs(other.all()), normal.all(), wo.all()),
             [&](uint32_t k) { return offset_ray_origin(b(k), abs(m(k)), n(k), w(k)); });
        const Transform placed = {n(0), m(0), w(0), b(0)};
        const TransformOf<Floats> all_placed = for_lanes<Floats>(placed);
        same(transform_point(all_placed, near.all()), [&](uint32_t k) { return transform_point(placed, b(k)); });
        same(transform_transposed(all_placed, near.all()),
             [&](uint32_t k) { return transform_transposed(placed, b(k)); });
        same(transform_sizes(all_placed, near.all()), [&](uint32_t k) { return transform_sizes(placed, b(k)); });
        same(triangle_pdf(near.all(), wo.all(), tilt.all()),
             [&](uint32_t k) { return triangle_pdf(b(k), w(k), tilt.one[k]); });
    }
}

LaneDifferences check_lanes() {
    LaneChecks same;
    for (const auto& check : {check_arithmetic, check_columns, check_random_numbers, check_sampling, check_frames}) {
        check(same);
    }
    return same.found;
}

} // namespace
} // namespace pertev::test::lanes
