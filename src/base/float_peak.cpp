#include "base/float_peak.h"

namespace phyxel {
namespace {

// One function for each set of instructions, of the same text. What it returns depends on every product.
#define PHYXEL_MULTIPLY_ADD(name, S)                                                               \
    float name(std::size_t rounds) {                                                               \
        const S::Float one = 1.0f - S::Float{}, slope = 0.999f * one, shift = 0.001f * one;        \
        S::Float a = one, b = 2.0f * one, c = 3.0f * one, d = 4.0f * one, e = 5.0f * one;          \
        S::Float f = 6.0f * one, g = 7.0f * one, h = 8.0f * one, i = 9.0f * one, j = 10.0f * one;  \
        for (std::size_t r = 0; r < rounds; ++r) {                                                 \
            a = S::fma(a, slope, shift), b = S::fma(b, slope, shift), c = S::fma(c, slope, shift); \
            d = S::fma(d, slope, shift), e = S::fma(e, slope, shift), f = S::fma(f, slope, shift); \
            g = S::fma(g, slope, shift), h = S::fma(h, slope, shift), i = S::fma(i, slope, shift); \
            j = S::fma(j, slope, shift);                                                           \
        }                                                                                          \
        const S::Float sum = a + b + c + d + e + f + g + h + i + j;                                \
        float total = 0;                                                                           \
        for (std::size_t l = 0; l < S::count; ++l) total += sum[l];                                \
        return total;                                                                              \
    }

PHYXEL_MULTIPLY_ADD(multiply_add_plain, PlainLanes<EightFloats>)
#if defined(__x86_64__)
PHYXEL_BEGIN_TARGET(PHYXEL_AVX2_FMA)
PHYXEL_MULTIPLY_ADD(multiply_add_avx2, Avx2Lanes)
PHYXEL_END_TARGET
PHYXEL_BEGIN_TARGET(PHYXEL_AVX512)
PHYXEL_MULTIPLY_ADD(multiply_add_avx512, Avx512Lanes)
PHYXEL_END_TARGET
#endif

}  // namespace

double run_float_peak(Instructions instructions, std::size_t rounds) {
    const double operations = 20 * static_cast<double>(rounds);
#if defined(__x86_64__)
    if (instructions == Instructions::avx512) return multiply_add_avx512(rounds) > 0 ? 16 * operations : 0;
    if (instructions == Instructions::avx2) return multiply_add_avx2(rounds) > 0 ? 8 * operations : 0;
#endif
    return multiply_add_plain(rounds) > 0 ? 8 * operations : 0;
}

}  // namespace phyxel
