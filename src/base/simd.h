#pragma once

#include "phyxel/vector.h"

/// Four doubles at a time, by the compiler's vector extension: AVX2 where the processor has it, pairs elsewhere. Lanes
/// do not mix and nothing is fused, so both give the same bits.

namespace phyxel {

/// A vector of three and an unused fourth lane, as it lies in memory; zero only as `Double4{}`.
struct alignas(32) Double4 {
    double lane[4];
};

inline void store(Double4& to, const Vec3& v) { to = {{v.x, v.y, v.z, 0}}; }
inline Vec3 load(const Double4& from) { return {from.lane[0], from.lane[1], from.lane[2]}; }
inline void add(Double4& to, const Vec3& v) { to.lane[0] += v.x, to.lane[1] += v.y, to.lane[2] += v.z; }

/// The same in a register. (Only inside of kernels: its alignment depends on the instructions a function is compiled
/// for.)
using Lanes = double __attribute__((vector_size(32), may_alias));
inline const Lanes& lanes(const Double4& d) { return reinterpret_cast<const Lanes&>(d); }
inline Lanes& lanes(Double4& d) { return reinterpret_cast<Lanes&>(d); }

/// For the two versions of a kernel: one function marked with it, one not, both of a body that is always inlined.
#if defined(__x86_64__) || defined(__i386__)
#define PHYXEL_AVX2 __attribute__((target("avx2")))
inline bool has_avx2() {
    static const bool has = __builtin_cpu_supports("avx2");
    return has;
}
#else
#define PHYXEL_AVX2
inline bool has_avx2() { return false; }
#endif

}  // namespace phyxel
