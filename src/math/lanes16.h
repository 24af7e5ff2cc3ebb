#pragma once

// Sixteen floats or truth values at once, as math/lanes.h has eight, for processors with AVX-512. Only files that are
// compiled for such processors include it (src/CMakeLists.txt), behind a function that asks for one
// (has_sixteen_lanes).

#include "math/lanes.h"

#if defined(__AVX512F__)

namespace pertev {

using Words16 = uint32_t __attribute__((vector_size(64)));

template <>
inline Words16 reverse_bits(Words16 x) { // math/words8.h explains it
    const __m512i word = _mm512_broadcast_i32x4(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
    const __m512i table = _mm512_broadcast_i32x4(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
    const __m512i low = _mm512_set1_epi8(15);
    const __m512i bytes = _mm512_shuffle_epi8(reinterpret_cast<__m512i>(x), word);
    const __m512i first = _mm512_shuffle_epi8(table, _mm512_and_si512(bytes, low));
    const __m512i second = _mm512_shuffle_epi8(table, _mm512_and_si512(_mm512_srli_epi32(bytes, 4), low));
    return reinterpret_cast<Words16>(_mm512_or_si512(_mm512_slli_epi32(first, 4), second));
}

struct Mask16 {
    __mmask16 bits;

    Mask16() = default;
    explicit Mask16(__mmask16 b) : bits(b) {}
    Mask16(bool all) : bits(all ? 0xffff : 0) {}
    Mask16(int32_t __attribute__((vector_size(64))) all) : bits(_mm512_movepi32_mask(reinterpret_cast<__m512i>(all))) {}
    static Mask16 of_bits(unsigned b) { return Mask16(static_cast<__mmask16>(b)); }

    friend Mask16 operator&&(Mask16 a, Mask16 b) { return of_bits(a.bits & b.bits); }
    friend Mask16 operator||(Mask16 a, Mask16 b) { return of_bits(a.bits | b.bits); }
    friend Mask16 operator!(Mask16 a) { return of_bits(~unsigned{a.bits}); }
    friend Mask16 operator==(Mask16 a, Mask16 b) { return of_bits(~(unsigned{a.bits} ^ b.bits)); }
    friend Mask16 operator!=(Mask16 a, Mask16 b) { return of_bits(a.bits ^ b.bits); }

    friend unsigned bit_mask(Mask16 a) { return a.bits; }
    friend bool any(Mask16 a) { return a.bits != 0; }
    friend Words16 select(Mask16 condition, Words16 a, Words16 b) {
        return reinterpret_cast<Words16>(
            _mm512_mask_blend_epi32(condition.bits, reinterpret_cast<__m512i>(b), reinterpret_cast<__m512i>(a)));
    }
};

struct Floats16 : LaneArithmetic<Floats16> {
    static constexpr uint32_t kLanes = 16;
    __m512 v;

    Floats16() = default;
    Floats16(__m512 lanes) : v(lanes) {}
    Floats16(std::same_as<float> auto x) : v(_mm512_set1_ps(x)) {}
    Floats16(std::same_as<int> auto x) : v(_mm512_set1_ps(static_cast<float>(x))) {}
    Floats16(Floats8 first, Floats8 second) : v(_mm512_insertf32x8(_mm512_castps256_ps512(first.v), second.v, 1)) {}

    float operator[](uint32_t lane) const { return v[lane]; }
    static Floats16 load(const float* p) { return _mm512_loadu_ps(p); }
    void store(float* p) const { _mm512_storeu_ps(p, v); }

    friend Mask16 operator<(Floats16 a, Floats16 b) { return compare<_CMP_LT_OQ>(a, b); }
    friend Mask16 operator>(Floats16 a, Floats16 b) { return compare<_CMP_GT_OQ>(a, b); }
    friend Mask16 operator<=(Floats16 a, Floats16 b) { return compare<_CMP_LE_OQ>(a, b); }
    friend Mask16 operator>=(Floats16 a, Floats16 b) { return compare<_CMP_GE_OQ>(a, b); }
    friend Mask16 operator==(Floats16 a, Floats16 b) { return compare<_CMP_EQ_OQ>(a, b); }
    friend Mask16 operator!=(Floats16 a, Floats16 b) { return compare<_CMP_NEQ_UQ>(a, b); }

    friend Floats16 select(Mask16 condition, Floats16 a, Floats16 b) {
        return _mm512_mask_blend_ps(condition.bits, b.v, a.v);
    }
    friend Floats16 min(Floats16 a, Floats16 b) { return _mm512_min_ps(b.v, a.v); }
    friend Floats16 max(Floats16 a, Floats16 b) { return _mm512_max_ps(b.v, a.v); }

    friend Words16 bits_of(Floats16 a) { return reinterpret_cast<Words16>(a.v); }
    friend Floats16 abs(Floats16 a) { return _mm512_andnot_ps(_mm512_set1_ps(-0.0f), a.v); }
    friend Floats16 copysign(Floats16 magnitude, Floats16 sign) {
        const __m512 bit = _mm512_set1_ps(-0.0f);
        return _mm512_or_ps(_mm512_andnot_ps(bit, magnitude.v), _mm512_and_ps(bit, sign.v));
    }
    friend Floats16 sqrt(Floats16 a) { return _mm512_sqrt_ps(a.v); }
    friend Floats16 fma(Floats16 a, Floats16 b, Floats16 c) { return _mm512_fmadd_ps(a.v, b.v, c.v); }
    friend Floats16 floor(Floats16 a) { return _mm512_floor_ps(a.v); }
    friend float least_of(Floats16 a) { return _mm512_reduce_min_ps(a.v); }
    friend float greatest_of(Floats16 a) { return _mm512_reduce_max_ps(a.v); }
    friend Words16 truncate_to_word(Floats16 a) { return reinterpret_cast<Words16>(_mm512_cvttps_epi32(a.v)); }

private:
    template <int kPredicate>
    static Mask16 compare(Floats16 a, Floats16 b) {
        return Mask16(_mm512_cmp_ps_mask(a.v, b.v, kPredicate));
    }
};

template <>
struct NumberTraits<Floats16> {
    using Mask = Mask16;
    using Word = Words16;
};
template <>
inline Floats16 float_of<Floats16>(Words16 bits) {
    return reinterpret_cast<__m512>(bits);
}
template <>
inline Floats16 gather<Floats16>(const float* from, Words16 indices) {
    return _mm512_i32gather_ps(reinterpret_cast<__m512i>(indices), from, 4);
}

inline void load_columns(const std::array<const float*, 16>& rows, Floats16 (&columns)[8]) {
    Floats8 first[8], second[8];
    load_columns({rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7]}, first);
    load_columns({rows[8], rows[9], rows[10], rows[11], rows[12], rows[13], rows[14], rows[15]}, second);
    for (int k = 0; k < 8; ++k) columns[k] = {first[k], second[k]};
}

inline void load_quads(const std::array<const float*, 4>& rows, Floats16& quads) {
    const auto row = [&](int k) { return _mm_loadu_ps(rows[k]); };
    const __m512 two = _mm512_insertf32x4(_mm512_castps128_ps512(row(0)), row(1), 1);
    quads = _mm512_insertf32x4(_mm512_insertf32x4(two, row(2), 2), row(3), 3);
}
inline Floats16 permute_quads(Floats16 a, Words16 order) {
    return _mm512_permutevar_ps(a.v, reinterpret_cast<__m512i>(order));
}
template <int k>
inline Floats16 broadcast_in_quads(Floats16 a) {
    return _mm512_permute_ps(a.v, k * 0x55);
}
inline void transpose_quads(const Floats16 (&rows)[4], Floats16 (&columns)[3]) {
    const __m512 low_01 = _mm512_unpacklo_ps(rows[0].v, rows[1].v), low_23 = _mm512_unpacklo_ps(rows[2].v, rows[3].v);
    const __m512 high_01 = _mm512_unpackhi_ps(rows[0].v, rows[1].v), high_23 = _mm512_unpackhi_ps(rows[2].v, rows[3].v);
    columns[0] = _mm512_shuffle_ps(low_01, low_23, 0x44);
    columns[1] = _mm512_shuffle_ps(low_01, low_23, 0xee);
    columns[2] = _mm512_shuffle_ps(high_01, high_23, 0x44);
}

inline void store_columns(const Floats16 (&columns)[8], const std::array<float*, 16>& rows) {
    Floats8 first[8], second[8];
    for (int k = 0; k < 8; ++k) {
        first[k] = _mm512_castps512_ps256(columns[k].v);
        second[k] = _mm512_extractf32x8_ps(columns[k].v, 1);
    }
    store_columns(first, {rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7]});
    store_columns(second, {rows[8], rows[9], rows[10], rows[11], rows[12], rows[13], rows[14], rows[15]});
}

} // namespace pertev

#endif
