// The elementary functions keep their stated error bounds against libm's double precision, which is good to about
// 2^-29 of a float's ulp, and give the very bits recorded here: a compiler that rounds otherwise shows at once.
// The long setting (--long) goes through all 2^32 floats.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include "base/parallel_for.h"
#include "math/portable_math.h"
#include "tests/support/options.h"
#include "tests/support/portable_math_digest.h"

namespace pertev {

static_assert(sizeof(sin(1.0f)) == sizeof(float)); // inside the namespace, ours are found and not ::sin(double)
static_assert(sizeof(pow(1.0f, 2.0f)) == sizeof(float));

namespace {

double reference(int function, float x_float, float y_float, uint32_t input) {
    const double x = static_cast<double>(x_float), y = static_cast<double>(y_float);
    const double turn = static_cast<double>(static_cast<float>(input) * 0x1p-32f); // what sin_cos_2pi is given
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
    case 13: { // libm's argument 2 pi u would be rounded: take the quarters off first
        const double q = std::rint(4 * turn), angle = 2 * 3.14159265358979323846 * (turn - q / 4);
        const int k = static_cast<int>(q) + (function == 13 ? 1 : 0);
        const double value = (k & 1) != 0 ? std::cos(angle) : std::sin(angle);
        return (k & 2) != 0 ? -value : value;
    }
    case 14:
        return std::pow(x, y);
    case 15:
        return std::atan2(x, y);
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
    if (overflow || std::isinf(ours)) { // within the bound of overflow either is right
        if (overflow && std::isinf(ours)) return std::signbit(exact) == std::signbit(ours) ? 0 : infinite;
        const double finite_ours =
            std::isinf(ours) ? std::copysign(0x1p128, static_cast<double>(ours)) : static_cast<double>(ours);
        return std::isinf(exact) ? infinite : std::fabs(finite_ours - exact) / 0x1p104;
    }
    if (exact == 0 && (ours != 0 || std::signbit(ours) != std::signbit(exact))) return infinite;
    if (exact != 0 && ours != 0 && std::signbit(ours) != std::signbit(exact)) return infinite;
    const int exponent = std::max(exact == 0 ? -149 : std::ilogb(exact) - 23, -149);
    return std::ldexp(std::fabs(static_cast<double>(ours) - exact), -exponent);
}

double stated_bound(int function) {
    switch (function) {
    case 6:
    case 7:
    case 8:
    case 9:
    case 12:
    case 13:
    case 14:
        return 1;
    }
    return 2;
}

struct Worst {
    double error = 0;
    uint32_t input = 0;
};

/// Greatest error over every `step`th of the 2^32 inputs from `offset` on.
Worst worst_error(int function, uint64_t step, uint64_t offset) {
    constexpr uint32_t kChunks = 256;
    Worst worst[kChunks];
    parallel_for(kChunks, 1, [&](uint64_t chunk) {
        Worst& w = worst[chunk];
        for (uint64_t i = (chunk << 24) + offset; i < (chunk + 1) << 24; i += step) {
            const auto input = static_cast<uint32_t>(i);
            const float x = float_of(input), y = test::portable_second_argument(input);
            const float ours = float_of(test::portable_math_value(function, input));
            const double error = error_in_ulp(ours, reference(function, x, y, input));
            if (error > w.error) w = {error, input};
        }
    });
    return *std::max_element(worst, worst + kChunks, [](const Worst& a, const Worst& b) { return a.error < b.error; });
}

} // namespace

TEST_CASE("elementary functions keep their stated error bounds") {
    const uint64_t step = test::effort(251, 1);
    for (int function = 0; function < test::kPortableFunctionCount; function++) {
        const Worst worst = worst_error(function, step, 0);
        const std::string name = test::portable_function_name(function);
        MESSAGE(name << ": at most " << worst.error << " ulp off, at " << worst.input);
        CHECK_MESSAGE(worst.error <= stated_bound(function), name);
    }
}

} // namespace pertev
