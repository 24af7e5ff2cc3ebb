#pragma once

// Eight floats or truth values at once, on the host only (sixteen: math/lanes16.h). Every function gives in each lane
// the bits that its scalar namesake gives (math/scalar.h), so code that is written for a number type T gives the same
// picture for float and for Floats8. Such code has no branch that a lane decides; it computes both results and takes
// one by select().

#include <immintrin.h>

#include <array>
#include <concepts>

#include "math/scalar.h"
#include "math/words8.h"

namespace pertev {

/// Eight truth values. Unlike bool, && and || evaluate both sides.
struct Mask8 {
    using Bits = int32_t __attribute__((vector_size(32)));
    Bits bits; // all ones or all zeros in each lane

    Mask8() = default;
    Mask8(Bits b) : bits(b) {}
    Mask8(bool all) : bits(Bits{} - (all ? 1 : 0)) {}
    /// The mask with these bits, one for each lane, that of lane 0 first.
    static Mask8 of_bits(unsigned b) { return (Bits{1, 2, 4, 8, 16, 32, 64, 128} & static_cast<int>(b)) != 0; }

    friend Mask8 operator&&(Mask8 a, Mask8 b) { return a.bits & b.bits; }
    friend Mask8 operator||(Mask8 a, Mask8 b) { return a.bits | b.bits; }
    friend Mask8 operator!(Mask8 a) { return ~a.bits; }
    friend Mask8 operator==(Mask8 a, Mask8 b) { return ~(a.bits ^ b.bits); }
    friend Mask8 operator!=(Mask8 a, Mask8 b) { return a.bits ^ b.bits; }

    /// Bits of the lanes, that of lane 0 first.
    friend unsigned bit_mask(Mask8 a) {
        return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(a.bits)));
    }
    friend bool any(Mask8 a) { return bit_mask(a) != 0; }
    friend Words8 select(Mask8 condition, Words8 a, Words8 b) {
        const Words8 chosen = reinterpret_cast<Words8>(condition.bits);
        return (a & chosen) | (b & ~chosen);
    }
};

/// Functions that Floats8 and Floats16 (math/lanes16.h) share, by the operators of their vectors.
template <class F>
struct LaneArithmetic {
    friend F operator+(F a, F b) { return a.v + b.v; }
    friend F operator-(F a, F b) { return a.v - b.v; }
    friend F operator*(F a, F b) { return a.v * b.v; }
    friend F operator/(F a, F b) { return a.v / b.v; }
    friend F operator-(F a) { return -a.v; }
    friend F clamp(F x, F lo, F hi) { return select(x > lo, select(x < hi, x, hi), lo); }
    friend F safe_sqrt(F a) { return sqrt(select(a > 0.0f, a, F(0.0f))); }
    friend F square(F a) { return a * a; }
    template <class Of>
    friend F for_each_lane(F a, const Of& of) {
        alignas(64) float lanes[F::kLanes];
        a.store(lanes);
        for (float& lane : lanes) lane = of(lane);
        return F::load(lanes);
    }
    friend auto is_finite(F a) { return MaskOf<F>((bits_of(a) & 0x7f800000u) != 0x7f800000u); }
};

struct Floats8 : LaneArithmetic<Floats8> {
    static constexpr uint32_t kLanes = 8;
    __m256 v;

    Floats8() = default;
    Floats8(__m256 lanes) : v(lanes) {}
    Floats8(std::same_as<float> auto x) : v(_mm256_set1_ps(x)) {}
    Floats8(std::same_as<int> auto x) : v(_mm256_set1_ps(static_cast<float>(x))) {}

    float operator[](uint32_t lane) const { return v[lane]; }
    static Floats8 load(const float* p) { return _mm256_loadu_ps(p); }
    void store(float* p) const { _mm256_storeu_ps(p, v); }

    friend Mask8 operator<(Floats8 a, Floats8 b) { return Mask8::Bits(a.v < b.v); }
    friend Mask8 operator>(Floats8 a, Floats8 b) { return Mask8::Bits(a.v > b.v); }
    friend Mask8 operator<=(Floats8 a, Floats8 b) { return Mask8::Bits(a.v <= b.v); }
    friend Mask8 operator>=(Floats8 a, Floats8 b) { return Mask8::Bits(a.v >= b.v); }
    friend Mask8 operator==(Floats8 a, Floats8 b) { return Mask8::Bits(a.v == b.v); }
    friend Mask8 operator!=(Floats8 a, Floats8 b) { return Mask8::Bits(a.v != b.v); }

    friend Floats8 select(Mask8 condition, Floats8 a, Floats8 b) {
        return _mm256_blendv_ps(b.v, a.v, reinterpret_cast<__m256>(condition.bits));
    }
    // minps returns its second operand unless the first is less, NaN included, as min() does with exchanged operands.
    friend Floats8 min(Floats8 a, Floats8 b) { return _mm256_min_ps(b.v, a.v); }
    friend Floats8 max(Floats8 a, Floats8 b) { return _mm256_max_ps(b.v, a.v); }

    friend Words8 bits_of(Floats8 a) { return reinterpret_cast<Words8>(a.v); }
    friend Floats8 abs(Floats8 a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v); }
    friend Floats8 copysign(Floats8 magnitude, Floats8 sign) {
        const __m256 bit = _mm256_set1_ps(-0.0f);
        return _mm256_or_ps(_mm256_andnot_ps(bit, magnitude.v), _mm256_and_ps(bit, sign.v));
    }
    friend Floats8 sqrt(Floats8 a) { return _mm256_sqrt_ps(a.v); }
    friend Floats8 fma(Floats8 a, Floats8 b, Floats8 c) { return _mm256_fmadd_ps(a.v, b.v, c.v); }
    friend Floats8 floor(Floats8 a) { return _mm256_floor_ps(a.v); }
    /// The least and the greatest of all lanes, of which none is NaN.
    friend float least_of(Floats8 a) {
        const __m128 four = _mm_min_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
        const __m128 two = _mm_min_ps(four, _mm_movehl_ps(four, four));
        return _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps(two, two, 1)));
    }
    friend float greatest_of(Floats8 a) {
        const __m128 four = _mm_max_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
        const __m128 two = _mm_max_ps(four, _mm_movehl_ps(four, four));
        return _mm_cvtss_f32(_mm_max_ss(two, _mm_shuffle_ps(two, two, 1)));
    }
    /// Truncates to integers, whose bits are words; |a| < 2^31.
    friend Words8 truncate_to_word(Floats8 a) { return reinterpret_cast<Words8>(_mm256_cvttps_epi32(a.v)); }
};

template <>
struct NumberTraits<Floats8> {
    using Mask = Mask8;
    using Word = Words8;
};
template <>
inline Floats8 float_of<Floats8>(Words8 bits) {
    return reinterpret_cast<__m256>(bits);
}
template <>
inline Floats8 gather<Floats8>(const float* from, Words8 indices) {
    return _mm256_i32gather_ps(from, reinterpret_cast<__m256i>(indices), 4);
}

/// Loads eight rows of eight floats and stores them transposed: columns[i] has element i of each row.
inline void load_columns(const std::array<const float*, 8>& rows, Floats8 (&columns)[8]) {
    __m256 r[8];
    for (int k = 0; k < 8; ++k) r[k] = _mm256_loadu_ps(rows[k]);
    __m256 pairs[8], fours[8];
    for (int k = 0; k < 8; k += 2) {
        pairs[k] = _mm256_unpacklo_ps(r[k], r[k + 1]), pairs[k + 1] = _mm256_unpackhi_ps(r[k], r[k + 1]);
    }
    for (int k = 0; k < 8; k += 4) {
        fours[k] = _mm256_shuffle_ps(pairs[k], pairs[k + 2], 0x44);
        fours[k + 1] = _mm256_shuffle_ps(pairs[k], pairs[k + 2], 0xee);
        fours[k + 2] = _mm256_shuffle_ps(pairs[k + 1], pairs[k + 3], 0x44);
        fours[k + 3] = _mm256_shuffle_ps(pairs[k + 1], pairs[k + 3], 0xee);
    }
    for (int k = 0; k < 4; ++k) {
        columns[k].v = _mm256_permute2f128_ps(fours[k], fours[k + 4], 0x20);
        columns[k + 4].v = _mm256_permute2f128_ps(fours[k], fours[k + 4], 0x31);
    }
}

/// Loads two rows of four floats, one after the other.
inline void load_quads(const std::array<const float*, 2>& rows, Floats8& quads) {
    quads = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(rows[0])), _mm_loadu_ps(rows[1]), 1);
}
/// Orders each quad of lanes: lane k of a quad gets the lane that the lowest two bits of order's lane k name.
inline Floats8 permute_quads(Floats8 a, Words8 order) {
    return _mm256_permutevar_ps(a.v, reinterpret_cast<__m256i>(order));
}
/// Fills each quad of lanes with its lane k.
template <int k>
inline Floats8 broadcast_in_quads(Floats8 a) {
    return _mm256_permute_ps(a.v, k * 0x55);
}
/// Transposes quads and drops the last row: quad q of columns[i] has element i of quad q of each of `rows`.
inline void transpose_quads(const Floats8 (&rows)[4], Floats8 (&columns)[3]) {
    const __m256 low_01 = _mm256_unpacklo_ps(rows[0].v, rows[1].v), low_23 = _mm256_unpacklo_ps(rows[2].v, rows[3].v);
    const __m256 high_01 = _mm256_unpackhi_ps(rows[0].v, rows[1].v), high_23 = _mm256_unpackhi_ps(rows[2].v, rows[3].v);
    columns[0] = _mm256_shuffle_ps(low_01, low_23, 0x44);
    columns[1] = _mm256_shuffle_ps(low_01, low_23, 0xee);
    columns[2] = _mm256_shuffle_ps(high_01, high_23, 0x44);
}

/// Stores the transposed columns: rows[i] gets element i of each column.
inline void store_columns(const Floats8 (&columns)[8], const std::array<float*, 8>& rows) {
    alignas(32) float all[8][8];
    for (int k = 0; k < 8; ++k) columns[k].store(all[k]);
    Floats8 transposed[8];
    load_columns({all[0], all[1], all[2], all[3], all[4], all[5], all[6], all[7]}, transposed);
    for (int k = 0; k < 8; ++k) transposed[k].store(rows[k]);
}

} // namespace pertev
