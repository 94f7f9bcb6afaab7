#include "forces/point_kernels.h"

namespace phyxel {
namespace {

[[gnu::always_inline]] inline void gather(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Double4* x,
                                          Columns* F) {
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
        for (int c = 0; c < 3; ++c) lanes(F->column[c]) = a[c] + b[c];
    }
}

[[gnu::always_inline]] inline void scatter(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Columns* A,
                                           Double4* f) {
    for (std::uint32_t q = begin; q < end; ++q, ++A) {
        const std::uint32_t first = st.offset[q], count = st.offset[q + 1] - first;
        const std::uint16_t* local = &st.local[first];
        const Vec3* g = &st.gradient[st.gradient_begin[q]];
        const Lanes a = lanes(A->column[0]), b = lanes(A->column[1]), c = lanes(A->column[2]);
        for (std::uint32_t k = 0; k < count; ++k) lanes(f[local[k]]) -= a * g[k].x + b * g[k].y + c * g[k].z;
    }
}

/// For one law, so that the choice is made once for all points.
template <Law law>
[[gnu::always_inline]] inline void evaluate(MaterialPoint m, std::size_t count, const double* V, const Columns* F,
                                            Columns* A) {
    m.law = law;
    for (std::size_t q = 0; q < count; ++q) A[q] = V[q] * stress(m, Mat3(F[q]));
}

/// Saint Venant-Kirchhoff without volume stiffness by columns: V P = F V S, V S = V mu (C - I) + V p I with C = F^T F
/// and p = lambda tr(E). Half the instructions of the law for single points: it is done between any two rows of pairs.
[[gnu::always_inline]] inline void evaluate_saint_venant_kirchhoff(const Lame& lame, std::size_t count, const double* V,
                                                                   const Columns* F, Columns* A) {
    for (std::size_t q = 0; q < count; ++q) {
        const Vec3 a = load(F[q].column[0]), b = load(F[q].column[1]), c = load(F[q].column[2]);
        const double growth_a = dot(a, a) - 1, growth_b = dot(b, b) - 1, growth_c = dot(c, c) - 1;
        const double mu = V[q] * lame.mu, p = 0.5 * V[q] * lame.lambda * (growth_a + growth_b + growth_c);
        const double ab = mu * dot(a, b), ac = mu * dot(a, c), bc = mu * dot(b, c);
        const Lanes fa = lanes(F[q].column[0]), fb = lanes(F[q].column[1]), fc = lanes(F[q].column[2]);
        lanes(A[q].column[0]) = fa * (mu * growth_a + p) + fb * ab + fc * ac;
        lanes(A[q].column[1]) = fa * ab + fb * (mu * growth_b + p) + fc * bc;
        lanes(A[q].column[2]) = fa * ac + fb * bc + fc * (mu * growth_c + p);
    }
}

[[gnu::always_inline]] inline void evaluate(const MaterialPoint& m, std::size_t count, const double* V,
                                            const Columns* F, Columns* A) {
    switch (m.law) {
        case Law::linear:
            return evaluate<Law::linear>(m, count, V, F, A);
        case Law::saint_venant_kirchhoff:
            if (m.volume_stiffness == 0) return evaluate_saint_venant_kirchhoff(m.lame, count, V, F, A);
            return evaluate<Law::saint_venant_kirchhoff>(m, count, V, F, A);
        case Law::corotated:
            return evaluate<Law::corotated>(m, count, V, F, A);
        case Law::neo_hookean:
            return evaluate<Law::neo_hookean>(m, count, V, F, A);
    }
}

void gather_plain(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Double4* x, Columns* F) {
    gather(st, begin, end, x, F);
}
PHYXEL_AVX2 void gather_avx2(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Double4* x, Columns* F) {
    gather(st, begin, end, x, F);
}
void scatter_plain(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Columns* A, Double4* f) {
    scatter(st, begin, end, A, f);
}
PHYXEL_AVX2 void scatter_avx2(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Columns* A,
                              Double4* f) {
    scatter(st, begin, end, A, f);
}

// Flattened: a call for each point would cost as much as the law.
[[gnu::flatten]] void evaluate_plain(const MaterialPoint& m, std::size_t count, const double* V, const Columns* F,
                                     Columns* A) {
    evaluate(m, count, V, F, A);
}
[[gnu::flatten]] PHYXEL_AVX2 void evaluate_avx2(const MaterialPoint& m, std::size_t count, const double* V,
                                                const Columns* F, Columns* A) {
    evaluate(m, count, V, F, A);
}

}  // namespace

void gather_gradients(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Double4* x, Columns* F) {
    (has_avx2() ? gather_avx2 : gather_plain)(st, begin, end, x, F);
}

void evaluate_stresses(const MaterialPoint& m, std::size_t count, const double* V, const Columns* F, Columns* A) {
    (has_avx2() ? evaluate_avx2 : evaluate_plain)(m, count, V, F, A);
}

void scatter_stresses(const Stencils& st, std::uint32_t begin, std::uint32_t end, const Columns* A, Double4* f) {
    (has_avx2() ? scatter_avx2 : scatter_plain)(st, begin, end, A, f);
}

}  // namespace phyxel
