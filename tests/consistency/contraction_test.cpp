// The compiler keeps a * b + c as two roundings. Fusing would give different bits on different machines and compilers.
// The values come from a hash, so that nothing is folded at compile time, and pass through the renderer's inline
// functions, where contraction would happen.

#include <cstdint>

#include <doctest/doctest.h>

#include "base/parallel_for.h"
#include "math/difference_of_products.h"
#include "math/random.h"
#include "math/sampler.h"
#include "math/vec3.h"

using namespace pertev;

namespace {

float value(uint32_t i) { return unit_interval(hash_word(i)) + 0.5f; }

// Is not inlined, so that product and sum are in different functions.
[[gnu::noinline]] float product_of(float a, float b) { return a * b; }
[[gnu::noinline]] float sum_of(float a, float b) { return a + b; }

/// a * b + c with two roundings, independent of compiler flags.
float two_roundings(float a, float b, float c) { return sum_of(product_of(a, b), c); }

struct Contractions {
    uint32_t differ_from_two = 0, fused_differ_from_two = 0;
};

template <class Expression>
Contractions compare(const Expression& expression) {
    Contractions counts;
    for (uint32_t i = 0; i < 10'000; i++) {
        const float a = value(3 * i), b = value(3 * i + 1), c = -value(3 * i + 2);
        const float two = two_roundings(a, b, c);
        counts.differ_from_two += expression(a, b, c) != two;
        counts.fused_differ_from_two += fma(a, b, c) != two;
    }
    return counts;
}

} // namespace

TEST_CASE("a product and a sum are two roundings") {
    const Contractions counts = compare([](float a, float b, float c) { return a * b + c; });
    CHECK(counts.differ_from_two == 0);
    CHECK(counts.fused_differ_from_two > 1000); // the values distinguish both
}

TEST_CASE("a product and a difference are two roundings") {
    CHECK(compare([](float a, float b, float c) { return a * b - (-c); }).differ_from_two == 0);
    CHECK(compare([](float a, float b, float c) { return c - (-a) * b; }).differ_from_two == 0);
}

TEST_CASE("the dot product of vectors is not contracted") {
    const auto dot_of = [](float a, float b, float c) { return dot(Vec3{a, c, 0}, Vec3{b, 1, 0}); };
    CHECK(compare(dot_of).differ_from_two == 0);
}

TEST_CASE("products and sums round twice on parallel_for's threads and in vectorised loops") {
    constexpr uint32_t count = 4096;
    float a[count], b[count], c[count], got[count];
    for (uint32_t i = 0; i < count; i++) a[i] = value(i), b[i] = value(i + count), c[i] = -value(i + 2 * count);
    parallel_for_ranges(count, 256, [&](uint64_t begin, uint64_t end) {
        for (uint64_t i = begin; i < end; i++) got[i] = a[i] * b[i] + c[i];
    });
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < count; i++) wrong += got[i] != two_roundings(a[i], b[i], c[i]);
    CHECK(wrong == 0);
}

TEST_CASE("a difference of products has the right sign however close the products are") {
    uint32_t wrong = 0, naive_wrong = 0;
    for (uint32_t i = 0; i < 100'000; i++) {
        const float a = value(4 * i), b = value(4 * i + 1), c = value(4 * i + 2);
        const float d = float_of(bits_of(a * b / c) + (hash_word(i) & 3) - 1); // c d differs from a b by a few ulp
        const double exact =
            static_cast<double>(a) * static_cast<double>(b) - static_cast<double>(c) * static_cast<double>(d);
        const auto has_sign = [&](auto x) { return (x > 0) == (exact > 0) && (x < 0) == (exact < 0); };
        wrong += !has_sign(difference_of_products(a, b, c, d));
        wrong += !has_sign(difference_of_products_in_double(a, b, c, d));
        naive_wrong += !has_sign(a * b - c * d);
        // The error is at most 1.5 ulp; the double is exact to 2^-53 here.
        const double error = static_cast<double>(difference_of_products(a, b, c, d)) - exact;
        wrong += !(error * error <= 4e-14 * exact * exact);
        // Swapping the products changes only the sign of the result in double precision.
        wrong += difference_of_products_in_double(a, b, c, d) != -difference_of_products_in_double(c, d, a, b);
    }
    CHECK(wrong == 0);
    CHECK(naive_wrong > 100);
}

TEST_CASE("a difference of products keeps its sign where float products vanish, in double") {
    const float tiny = 0x1p-80f, next = float_of(bits_of(tiny) + 1);
    CHECK(difference_of_products_in_double(next, 0x1p-80f, tiny, 0x1p-80f) == 0x1p-183);
    CHECK(difference_of_products_in_double(tiny, 0x1p-80f, next, 0x1p-80f) == -0x1p-183);
    CHECK(difference_of_products(next, 0x1p-80f, tiny, 0x1p-80f) == 0); // so double precision is needed
}
