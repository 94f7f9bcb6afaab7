#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

/// Eight or sixteen floats at a time, by the compiler's vector extension. A kernel is a template over one of the
/// structs below and is compiled once for each, in a source file of its own whose code stands between
/// PHYXEL_BEGIN_TARGET and PHYXEL_END_TARGET; `best_instructions` says which one this processor runs. AVX2 and AVX-512
/// fuse multiply and add, plain code does not: the last bits differ between processors, never between runs or numbers
/// of threads.

#pragma GCC diagnostic ignored "-Wpsabi"  // wide vectors as arguments: all that have them are inlined

namespace phyxel {

enum class Instructions { plain, avx2, avx512 };

/// The widest that this processor has.
inline Instructions best_instructions() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
        return Instructions::avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return Instructions::avx2;
#endif
    return Instructions::plain;
}

/// A vector of three and an unused fourth lane in single precision, as it lies in memory; zero only as `Float4{}`.
struct alignas(16) Float4 {
    float lane[4];
};

using Float4Lanes = float __attribute__((vector_size(16), may_alias));
using Float8Lanes = float __attribute__((vector_size(32), may_alias));
using Float16Lanes = float __attribute__((vector_size(64), may_alias));

/// The vectors themselves; `Unaligned` in memory.
struct EightFloats {
    using Float = Float8Lanes;
    using Unaligned = float __attribute__((vector_size(32), aligned(4), may_alias));
    static constexpr std::size_t count = 8;
};
struct SixteenFloats {
    using Float = Float16Lanes;
    using Unaligned = float __attribute__((vector_size(64), aligned(4), may_alias));
    static constexpr std::size_t count = 16;
};

#if defined(__x86_64__)
#define PHYXEL_PRAGMA(text) _Pragma(#text)
#if defined(__clang__)
#define PHYXEL_BEGIN_TARGET(features) \
    PHYXEL_PRAGMA(clang attribute push(__attribute__((target(features))), apply_to = function))
#define PHYXEL_END_TARGET PHYXEL_PRAGMA(clang attribute pop)
#else
#define PHYXEL_BEGIN_TARGET(features) PHYXEL_PRAGMA(GCC push_options) PHYXEL_PRAGMA(GCC target(features))
#define PHYXEL_END_TARGET PHYXEL_PRAGMA(GCC pop_options)
#endif
#define PHYXEL_AVX2_FMA "avx2,fma"
#define PHYXEL_AVX512 "avx2,fma,avx512f,avx512vl,avx512dq"
#endif

/// Without special instructions: as many operations as it takes.
template <class Vectors>
struct PlainLanes : Vectors {
    using Float = typename Vectors::Float;
    using Vectors::count;
    [[gnu::always_inline]] static inline Float fma(const Float& a, const Float& b, const Float& c) { return a * b + c; }
    [[gnu::always_inline]] static inline Float sqrt(const Float& a) {
        Float r{};
        for (std::size_t l = 0; l < count; ++l) r[l] = std::sqrt(a[l]);
        return r;
    }
    /// Numbers of 16 bits as floats.
    [[gnu::always_inline]] static inline Float widen(const std::int16_t* from) {
        Float r{};
        for (std::size_t l = 0; l < count; ++l) r[l] = static_cast<float>(from[l]);
        return r;
    }
    /// Whether a comparison holds in any lane.
    template <class Mask>
    [[gnu::always_inline]] static inline bool any(const Mask& mask) {
        bool found = false;
        for (std::size_t l = 0; l < count; ++l) found |= mask[l] != 0;
        return found;
    }
};

#if defined(__x86_64__)
struct Avx2Lanes : EightFloats {
    [[gnu::always_inline, gnu::target(PHYXEL_AVX2_FMA)]] static inline Float fma(const Float& a, const Float& b,
                                                                                 const Float& c) {
        return _mm256_fmadd_ps(a, b, c);
    }
    [[gnu::always_inline, gnu::target(PHYXEL_AVX2_FMA)]] static inline Float sqrt(const Float& a) {
        return _mm256_sqrt_ps(a);
    }
    [[gnu::always_inline, gnu::target(PHYXEL_AVX2_FMA)]] static inline Float widen(const std::int16_t* from) {
        return _mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from))));
    }
    template <class Mask>
    [[gnu::always_inline, gnu::target(PHYXEL_AVX2_FMA)]] static inline bool any(const Mask& mask) {
        return _mm256_movemask_ps(reinterpret_cast<const __m256&>(mask)) != 0;
    }
};

struct Avx512Lanes : SixteenFloats {
    [[gnu::always_inline, gnu::target(PHYXEL_AVX512)]] static inline Float fma(const Float& a, const Float& b,
                                                                               const Float& c) {
        return _mm512_fmadd_ps(a, b, c);
    }
    [[gnu::always_inline, gnu::target(PHYXEL_AVX512)]] static inline Float sqrt(const Float& a) {
        return _mm512_maskz_sqrt_ps(0xffff, a);
    }
    [[gnu::always_inline, gnu::target(PHYXEL_AVX512)]] static inline Float widen(const std::int16_t* from) {
        const __m256i numbers = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
        return _mm512_maskz_cvtepi32_ps(0xffff, _mm512_maskz_cvtepi16_epi32(0xffff, numbers));
    }
    template <class Mask>
    [[gnu::always_inline, gnu::target(PHYXEL_AVX512)]] static inline bool any(const Mask& mask) {
        const auto& bits = reinterpret_cast<const __m512i&>(mask);
        return _mm512_test_epi32_mask(bits, bits) != 0;
    }
};
#endif

}  // namespace phyxel
