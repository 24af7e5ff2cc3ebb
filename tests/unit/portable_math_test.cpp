// The elementary functions keep their stated error bounds against libm's double precision, which is good to about
// 2^-29 of a float's ulp, and have the bits recorded here, which detects a compiler that rounds differently. With
// --long all 2^32 floats are tested.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "base/parallel_for.h"
#include "math/portable_math.h"
#include "math/random.h"
#include "math/sampler.h"
#include "tests/support/options.h"
#include "tests/support/portable_math_digest.h"

namespace pertev {

static_assert(sizeof(sin(1.0f)) ==
              sizeof(float)); // inside the namespace, name lookup finds these and not ::sin(double)
static_assert(sizeof(pow(1.0f, 2.0f)) == sizeof(float));

namespace {

double reference(int function, float x_float, float y_float, uint32_t input) {
    const double x = static_cast<double>(x_float), y = static_cast<double>(y_float);
    const double turn = static_cast<double>(static_cast<float>(input) * 0x1p-32f); // the argument of sin_cos_2pi
    switch (function) {
    case 0:
    case 10:
        return std::sin(x);
    case 1:
    case 11:
        return std::cos(x);
    case 2:
        return std::tan(x);
    case 3:
        return std::asin(x);
    case 4:
        return std::acos(x);
    case 5:
        return std::atan(x);
    case 6:
        return std::exp(x);
    case 7:
        return std::exp2(x);
    case 8:
        return std::log(x);
    case 9:
        return std::log2(x);
    case 12:
    case 13: { // libm's argument 2 pi u would be rounded, so whole quarters are removed first
        const double q = std::rint(4 * turn), angle = 2 * 3.14159265358979323846 * (turn - q / 4);
        const int k = static_cast<int>(q) + (function == 13 ? 1 : 0);
        const double value = (k & 1) != 0 ? std::cos(angle) : std::sin(angle);
        return (k & 2) != 0 ? -value : value;
    }
    case 14:
        return std::pow(x, y);
    case 15:
        return std::atan2(x, y);
    case 16:
        return test::has_reciprocal(x_float) ? 1 / x : 0.0;
    }
    return 0;
}

/// |ours - exact| in units of the last place of a float of the exact value's size; infinity where the two differ in
/// kind (NaN, overflow, sign of zero).
double error_in_ulp(float ours, double exact) {
    const double infinite = std::numeric_limits<double>::infinity();
    if (std::isnan(exact)) return std::isnan(ours) ? 0 : infinite;
    if (std::isnan(ours)) return infinite;
    const bool overflow = std::fabs(exact) >= 0x1.ffffffp127;
    if (overflow || std::isinf(ours)) { // near the overflow threshold either result is right
        if (overflow && std::isinf(ours)) return std::signbit(exact) == std::signbit(ours) ? 0 : infinite;
        const double finite_ours =
            std::isinf(ours) ? std::copysign(0x1p128, static_cast<double>(ours)) : static_cast<double>(ours);
        return std::isinf(exact) ? infinite : std::fabs(finite_ours - exact) / 0x1p104;
    }
    if (exact == 0 && (ours != 0 || std::signbit(ours) != std::signbit(exact))) return infinite;
    if (exact != 0 && ours != 0 && std::signbit(ours) != std::signbit(exact)) return infinite;
    const auto biased = static_cast<int64_t>(std::bit_cast<uint64_t>(exact) >> 52 & 0x7ff); // ilogb() would be slow
    const int64_t exponent = std::max<int64_t>(biased - 1023 - 23, -149);
    const double ulps = std::bit_cast<double>(static_cast<uint64_t>(1023 - exponent) << 52);
    return std::fabs(static_cast<double>(ours) - exact) * ulps;
}

double stated_bound(int function) {
    if (function == 16) return 0.5;                         // correctly rounded
    const bool within_two = function >= 2 && function <= 5; // tan, asin, acos, atan
    return within_two || function == 15 ? 2 : 1;
}

struct Worst {
    double error = 0;
    uint32_t input = 0;
};

void add_error(Worst& worst, int function, uint32_t input) {
    const uint32_t bits = test::portable_math_value(function, input);
    const bool of_both = function == 10 || function == 11; // sin_cos returns sin and cos, which are measured themselves
    if (of_both && bits == test::portable_math_value(function - 10, input)) return;
    const float x = float_of(input), y = test::portable_second_argument(input);
    const double error = error_in_ulp(float_of(bits), reference(function, x, y, input));
    if (error > worst.error) worst = {error, input};
}

/// Returns the largest error over every `step`th of the 2^32 inputs from `offset` on.
Worst worst_error(int function, uint64_t step, uint64_t offset) {
    constexpr uint32_t kChunks = 256;
    Worst worst[kChunks];
    parallel_for(kChunks, 1, [&](uint64_t chunk) {
        Worst& w = worst[chunk];
        for (uint64_t i = (chunk << 24) + offset; i < (chunk + 1) << 24; i += step) {
            const auto input = static_cast<uint32_t>(i);
            add_error(w, function, input);
        }
    });
    return *std::max_element(worst, worst + kChunks, [](const Worst& a, const Worst& b) { return a.error < b.error; });
}

} // namespace

TEST_CASE("elementary functions keep their stated error bounds") {
    const uint64_t step = test::effort(2039, 1);
    for (int function = 0; function < test::kPortableFunctionCount; function++) {
        const Worst worst = worst_error(function, step, 0);
        const std::string name = test::portable_function_name(function);
        MESSAGE(name << ": at most " << worst.error << " ulp off, at " << worst.input);
        CHECK_MESSAGE(worst.error <= stated_bound(function), name);
    }
}

TEST_CASE("elementary functions are correct at structured inputs") {
    std::vector<uint32_t> inputs = {bits_of(0x1.f37f4ap95f)}; // the float nearest to a multiple of pi/2
    for (uint32_t exponent = 0; exponent < 256; exponent++) {
        for (const uint32_t mantissa :
             {0u, 1u, 2u, 0x3504f2u, 0x3504f3u, 0x3504f4u, 0x3fffffu, 0x400000u, 0x7ffffeu, 0x7fffffu}) {
            for (const uint32_t sign : {0u, 1u}) inputs.push_back(sign << 31 | exponent << 23 | mantissa);
        }
    }
    for (int k = 1; k < 200'000;
         k += 1 + k / 1000) { // inputs next to multiples of pi/4, to halves and to logarithms of 2
        for (const double x : {k * 0.78539816339744831, k * 0.5, k * 0.34657359027997264}) {
            const uint32_t bits = bits_of(static_cast<float>(x));
            for (uint32_t step = 0; step < 5; step++) inputs.push_back(bits + step - 2);
        }
    }
    for (int function = 0; function < test::kPortableFunctionCount; function++) {
        Worst worst;
        for (const uint32_t input : inputs) {
            for (const uint32_t sign : {0u, 0x80000000u}) add_error(worst, function, input ^ sign);
        }
        const std::string name = test::portable_function_name(function);
        CHECK_MESSAGE(worst.error <= stated_bound(function), name << ": " << worst.error << " at " << worst.input);
    }
}

TEST_CASE("pow and atan2 treat zeros, infinities, integers and NaN as C does") {
    std::vector<float> values;
    for (const float x :
         {0.0f,   0x1p-149f,      0x1p-126f, 0x1p-24f,       0.5f,    0x1.fffffep-1f,  1.0f,      0x1.000002p0f,
          1.5f,   2.0f,           2.5f,      3.0f,           4.0f,    127.0f,          128.0f,    149.0f,
          150.0f, 0x1.fffffep23f, 0x1p24f,   0x1.000002p24f, 0x1p31f, 0x1.fffffep127f, kInfinity, kNaN}) {
        values.insert(values.end(), {x, -x});
    }
    for (const float x : values) {
        for (const float y : values) {
            const double a = static_cast<double>(x), b = static_cast<double>(y);
            CHECK_MESSAGE(error_in_ulp(pow(x, y), std::pow(a, b)) <= 1, "pow " << x << " " << y);
            CHECK_MESSAGE(error_in_ulp(atan2(x, y), std::atan2(a, b)) <= 2, "atan2 " << x << " " << y);
        }
    }
}

TEST_CASE("pow keeps its error bound where the result neither overflows nor vanishes, and atan2 at every angle") {
    constexpr uint32_t kChunks = 256;
    double pow_errors[kChunks] = {}, atan2_errors[kChunks] = {};
    const auto chunk_size = static_cast<uint32_t>(test::effort(2000, 1u << 20));
    parallel_for(kChunks, 1, [&](uint64_t chunk) {
        double& worst_pow = pow_errors[chunk];
        double& worst_atan2 = atan2_errors[chunk];
        for (uint32_t i = 0; i < chunk_size; i++) {
            const Hash4 random = hash_words(i, static_cast<uint32_t>(chunk), 2, 3);
            // The base is any float, or one next to 1. The exponent takes it into [2^-150, 2^128].
            const float x =
                (random.x & 1) != 0 ? float_of(random.y >> 1) : 1 + (unit_interval(random.y) - 0.5f) * 0x1p-6f;
            if (x == 1 || x == 0 || !is_finite(x)) continue;
            const double wide_x = static_cast<double>(x);
            const auto y =
                static_cast<float>((static_cast<double>(unit_interval(random.z)) * 278 - 150) / std::log2(wide_x));
            worst_pow = std::max(worst_pow, error_in_ulp(pow(x, y), std::pow(wide_x, static_cast<double>(y))));

            const float a = float_of(random.w), b = a * (0x1p-8f / unit_interval(random.z));
            const double wide_a = static_cast<double>(a), wide_b = static_cast<double>(b);
            worst_atan2 = std::max({worst_atan2, error_in_ulp(atan2(a, b), std::atan2(wide_a, wide_b)),
                                    error_in_ulp(atan2(b, a), std::atan2(wide_b, wide_a))});
        }
    });
    const double worst_pow = *std::ranges::max_element(pow_errors);
    const double worst_atan2 = *std::ranges::max_element(atan2_errors);
    MESSAGE("pow: at most " << worst_pow << " ulp off, atan2: " << worst_atan2);
    CHECK(worst_pow <= 1);
    CHECK(worst_atan2 <= 2);
}

TEST_CASE("elementary functions give the recorded bits") {
    constexpr uint64_t kRecorded[test::kPortableFunctionCount] = {
        11565014457536044660u, 5709893691581079480u, 9121272813130977225u, 3069567710282377022u,  17761287196637901388u,
        7302687037153846410u,  9314481345866123891u, 5167895523107141205u, 6838568821189206300u,  16369352005732446227u,
        11565014457536044660u, 5709893691581079480u, 7318184199271632635u, 11186434658400745954u, 14463278490676515255u,
        4131289334840734658u,  5280348417561125045u};
    for (int function = 0; function < test::kPortableFunctionCount; function++) {
        uint64_t sum = 0;
        for (uint64_t i = 0; i < (uint64_t{1} << 32); i += 8191) {
            const auto input = static_cast<uint32_t>(i);
            sum += test::portable_math_term(input, test::portable_math_value(function, input));
        }
        const std::string name = test::portable_function_name(function);
        CHECK_MESSAGE(sum == kRecorded[function], name);
    }
}

} // namespace pertev
