#include "forces/point_kernels.h"

namespace phyxel {
namespace {

[[gnu::always_inline]] inline void gather(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Double4* x,
                                          Mat3* F) {
    for (std::uint32_t q = begin; q < end; ++q, ++F) {
        const std::uint32_t first = st.offset[q], count = st.offset[q + 1] - first;
        const std::uint16_t* local = &st.local[first];
        const Vec3* g = &st.gradient[st.gradient_begin[q]];
        // Columns of F, in two sums each: one would wait for the latency of its own additions.
        Lanes a[3] = {}, b[3] = {};
        std::uint32_t k = 0;
        for (; k + 1 < count; k += 2) {
            const Lanes &xa = lanes(x[local[k]]), &xb = lanes(x[local[k + 1]]);
            a[0] += xa * g[k].x, a[1] += xa * g[k].y, a[2] += xa * g[k].z;
            b[0] += xb * g[k + 1].x, b[1] += xb * g[k + 1].y, b[2] += xb * g[k + 1].z;
        }
        if (k < count) {
            const Lanes& xa = lanes(x[local[k]]);
            a[0] += xa * g[k].x, a[1] += xa * g[k].y, a[2] += xa * g[k].z;
        }
        for (int c = 0; c < 3; ++c) a[c] += b[c];
        for (int r = 0; r < 3; ++r) F->rows[r] = {a[0][r], a[1][r], a[2][r]};
    }
}

[[gnu::always_inline]] inline void scatter(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Mat3* A,
                                           Double4* f) {
    for (std::uint32_t q = begin; q < end; ++q, ++A) {
        const std::uint32_t first = st.offset[q], count = st.offset[q + 1] - first;
        const std::uint16_t* local = &st.local[first];
        const Vec3* g = &st.gradient[st.gradient_begin[q]];
        Lanes column[3] = {};
        for (int c = 0; c < 3; ++c) column[c] = Lanes{A->rows[0][c], A->rows[1][c], A->rows[2][c], 0};
        for (std::uint32_t k = 0; k < count; ++k)
            lanes(f[local[k]]) -= column[0] * g[k].x + column[1] * g[k].y + column[2] * g[k].z;
    }
}

void gather_plain(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Double4* x, Mat3* F) {
    gather(st, begin, end, x, F);
}
PHYXEL_AVX2 void gather_avx2(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Double4* x, Mat3* F) {
    gather(st, begin, end, x, F);
}
void scatter_plain(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Mat3* A, Double4* f) {
    scatter(st, begin, end, A, f);
}
PHYXEL_AVX2 void scatter_avx2(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Mat3* A, Double4* f) {
    scatter(st, begin, end, A, f);
}

}  // namespace

void gather_gradients(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Double4* x, Mat3* F) {
    (has_avx2() ? gather_avx2 : gather_plain)(st, begin, end, x, F);
}

void scatter_stresses(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Mat3* A, Double4* f) {
    (has_avx2() ? scatter_avx2 : scatter_plain)(st, begin, end, A, f);
}

}  // namespace phyxel
