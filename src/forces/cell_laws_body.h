// No include guard and no includes: cell_kernel_body.h includes this once, in the target region of its instructions.

namespace phyxel {
namespace {

/// The constitutive laws for the lanes `S` of base/float_lanes.h, written in H = F - I, so that they keep their digits
/// where it is small.
///
/// Each energy is that of lambda = 0 and lambda/2 theta^2 with the law's own dilatation theta, which the points of a
/// nearly incompressible cell share. `measure` returns theta and keeps what stress and energy need of it; `stress` is V
/// P with V lambda theta given, `energy` V Psi of lambda = 0. Sources: the laws' own files in material/.
template <class S>
struct CellLaws {
    using Float = typename S::Float;
    static constexpr std::size_t lanes = S::count;

    PHYXEL_INLINE Float load(const float* from) { return *reinterpret_cast<const typename S::Unaligned*>(from); }
    PHYXEL_INLINE void store(float* to, const Float& value) { *reinterpret_cast<typename S::Unaligned*>(to) = value; }
    PHYXEL_INLINE Float splat(float value) { return value - Float{}; }
    PHYXEL_INLINE Float fma(const Float& a, const Float& b, const Float& c) { return S::fma(a, b, c); }

    struct Matrix {
        Float m[9];
    };

    PHYXEL_INLINE Float trace(const Matrix& A) { return A.m[0] + A.m[4] + A.m[8]; }
    PHYXEL_INLINE Float contract(const Matrix& A, const Matrix& B) {
        Float sum = A.m[0] * B.m[0];
        for (int k = 1; k < 9; ++k) sum = fma(A.m[k], B.m[k], sum);
        return sum;
    }
    PHYXEL_INLINE void add_identity(const Float& times, Matrix& A) {
        for (int d = 0; d < 9; d += 4) A.m[d] += times;
    }
    PHYXEL_INLINE void cofactor(const Matrix& A, Matrix& C) {
        const Float* a = A.m;
        C.m[0] = a[4] * a[8] - a[5] * a[7], C.m[1] = a[5] * a[6] - a[3] * a[8], C.m[2] = a[3] * a[7] - a[4] * a[6];
        C.m[3] = a[7] * a[2] - a[8] * a[1], C.m[4] = a[8] * a[0] - a[6] * a[2], C.m[5] = a[6] * a[1] - a[7] * a[0];
        C.m[6] = a[1] * a[5] - a[2] * a[4], C.m[7] = a[2] * a[3] - a[0] * a[5], C.m[8] = a[0] * a[4] - a[1] * a[3];
    }
    /// Cofactor matrix of F = I + H less I, tr(H) I - H^T + cof H; returns J - 1. Both keep their digits at small H.
    PHYXEL_INLINE Float cofactor_change(const Matrix& H, Matrix& change) {
        Matrix cof;
        cofactor(H, cof);
        const Float t = trace(H);
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) change.m[3 * r + c] = cof.m[3 * r + c] - H.m[3 * c + r];
        add_identity(t, change);
        return t + trace(cof) + fma(H.m[0], cof.m[0], fma(H.m[1], cof.m[1], H.m[2] * cof.m[2]));
    }

    struct Moduli {
        Float lambda, mu, volume_stiffness;  ///< each times V
    };

    struct LinearLaw {
        struct State {};
        PHYXEL_INLINE Float measure(const Matrix& H, State&) { return trace(H); }
        PHYXEL_INLINE void stress(const Matrix& H, const State&, const Float& pressure, const Moduli& m, Matrix& P) {
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) P.m[3 * r + c] = m.mu * (H.m[3 * r + c] + H.m[3 * c + r]);
            add_identity(pressure, P);
        }
        PHYXEL_INLINE Float energy(const Matrix& H, const State&, const Moduli& m) {
            Float sum{};
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) sum = fma(H.m[3 * r + c], H.m[3 * r + c] + H.m[3 * c + r], sum);
            return 0.5f * m.mu * sum;
        }
    };

    struct SaintVenantKirchhoffLaw {
        struct State {
            Matrix E;  ///< (H + H^T + H^T H)/2
        };
        PHYXEL_INLINE Float measure(const Matrix& H, State& s) {
            for (int r = 0; r < 3; ++r)
                for (int c = r; c < 3; ++c) {
                    Float sum = H.m[3 * r + c] + H.m[3 * c + r];
                    for (int k = 0; k < 3; ++k) sum = fma(H.m[3 * k + r], H.m[3 * k + c], sum);
                    s.E.m[3 * r + c] = s.E.m[3 * c + r] = 0.5f * sum;
                }
            return trace(s.E);
        }
        PHYXEL_INLINE void stress(const Matrix& H, const State& s, const Float& pressure, const Moduli& m, Matrix& P) {
            Matrix second, change;
            for (int k = 0; k < 9; ++k) second.m[k] = 2.0f * m.mu * s.E.m[k];
            add_identity(pressure, second);
            const Float bulk = m.volume_stiffness * cofactor_change(H, change);
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) {
                    Float sum = fma(bulk, change.m[3 * r + c], second.m[3 * r + c]);
                    for (int k = 0; k < 3; ++k) sum = fma(H.m[3 * r + k], second.m[3 * k + c], sum);
                    P.m[3 * r + c] = sum;
                }
            add_identity(bulk, P);
        }
        PHYXEL_INLINE Float energy(const Matrix& H, const State& s, const Moduli& m) {
            Matrix change;
            const Float growth = cofactor_change(H, change);
            return m.mu * contract(s.E, s.E) + 0.5f * m.volume_stiffness * growth * growth;
        }
    };

    struct NeoHookeanLaw {
        struct State {
            Matrix change;  ///< cof F - I
            Float growth;   ///< J - 1
        };
        PHYXEL_INLINE Float measure(const Matrix& H, State& s) { return s.growth = cofactor_change(H, s.change); }
        PHYXEL_INLINE void stress(const Matrix& H, const State& s, const Float& pressure, const Moduli& m, Matrix& P) {
            const Float bulk = fma(m.mu, s.growth, pressure), slope = bulk - m.mu;
            for (int k = 0; k < 9; ++k) P.m[k] = fma(slope, s.change.m[k], m.mu * H.m[k]);
            add_identity(bulk, P);
        }
        PHYXEL_INLINE Float energy(const Matrix& H, const State& s, const Moduli& m) {
            const Float beyond = s.growth - trace(H);  // minors and determinant of H
            return m.mu * (0.5f * (contract(H, H) + s.growth * s.growth) - beyond);
        }
    };

    struct CorotatedLaw {
        struct State {
            Matrix stretch, turn;  ///< F - R and R - I
        };
        /// What is left of F without its rotation: F - R, and R - I. See base/polar.h for the derivation; here all is
        /// written in H, and lanes where float or the first column of the adjugate will not do are left to doubles.
        PHYXEL_INLINE void split(const Matrix& H, Matrix& stretch, Matrix& turn) {
            Matrix F = H, cof;
            for (int d = 0; d < 9; d += 4) F.m[d] += 1.0f;
            cofactor(F, cof);
            const Float squared = contract(F, F), cof_squared = contract(cof, cof);
            const Float det = fma(F.m[0], cof.m[0], fma(F.m[1], cof.m[1], F.m[2] * cof.m[2]));
            const Float constant = squared * squared - 4.0f * cof_squared;

            // Largest root of the quartic, from above.
            Float l = S::sqrt(3.0f * squared), slope{};
            for (int iteration = 0; iteration < 12; ++iteration) {
                const Float value = fma(fma(fma(l, l, -2.0f * squared), l, -8.0f * det), l, constant);
                slope = fma(4.0f * l, fma(l, l, -squared), -8.0f * det);
                const Float change = value / slope;
                l -= change;
                if (!S::any(change > 1e-4f * l)) break;
            }
            const Float gaps = fma(4.0f * l, fma(l, l, -squared), -8.0f * det);

            // First column (w, v) of the adjugate.
            Matrix B, cof_B;
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) B.m[3 * r + c] = H.m[3 * r + c] + H.m[3 * c + r];
            const Float diagonal = trace(H) + l + 1.0f;
            for (int d = 0; d < 9; d += 4) B.m[d] -= diagonal;
            cofactor(B, cof_B);
            const Float w = fma(B.m[0], cof_B.m[0], fma(B.m[1], cof_B.m[1], B.m[2] * cof_B.m[2]));
            const Float z[3] = {H.m[7] - H.m[5], H.m[2] - H.m[6], H.m[3] - H.m[1]};
            Float v[3];
            for (int r = 0; r < 3; ++r)
                v[r] = -fma(cof_B.m[3 * r], z[0], fma(cof_B.m[3 * r + 1], z[1], cof_B.m[3 * r + 2] * z[2]));

            // R - I = k (w [v]x + v v^T - |v|^2 I).
            const Float v_squared = fma(v[0], v[0], fma(v[1], v[1], v[2] * v[2]));
            const Float k = 2.0f / fma(w, w, v_squared), kw = k * w;
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) turn.m[3 * r + c] = k * v[r] * v[c];
            for (int d = 0; d < 9; d += 4) turn.m[d] -= k * v_squared;
            turn.m[1] -= kw * v[2], turn.m[2] += kw * v[1], turn.m[3] += kw * v[2];
            turn.m[5] -= kw * v[0], turn.m[6] -= kw * v[1], turn.m[7] += kw * v[0];

            const auto good = (gaps > squared * S::sqrt(squared)) & (squared > 1e-4f) & (squared < 1e4f) &
                              (w * w > 0.0625f * gaps * gaps);
            const auto bad = ~good;
            if (S::any(bad))
                for (std::size_t lane = 0; lane < lanes; ++lane)
                    if (bad[lane]) turn_slowly(H, lane, turn);
            for (int d = 0; d < 9; ++d) stretch.m[d] = H.m[d] - turn.m[d];
        }

        [[gnu::noinline]] static void turn_slowly(const Matrix& H, std::size_t lane, Matrix& turn) {
            Mat3 F;
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c)
                    F(r, c) = static_cast<double>(H.m[3 * r + c][lane]) + (r == c ? 1.0 : 0.0);
            const Mat3 R = polar_rotation(F);
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c)
                    turn.m[3 * r + c][lane] = static_cast<float>(R(r, c) - (r == c ? 1.0 : 0.0));
        }

        PHYXEL_INLINE Float measure(const Matrix& H, State& s) {
            split(H, s.stretch, s.turn);
            return trace(s.stretch) + contract(s.turn, s.stretch);
        }
        PHYXEL_INLINE void stress(const Matrix&, const State& s, const Float& pressure, const Moduli& m, Matrix& P) {
            for (int k = 0; k < 9; ++k) P.m[k] = fma(pressure, s.turn.m[k], 2.0f * m.mu * s.stretch.m[k]);
            add_identity(pressure, P);
        }
        PHYXEL_INLINE Float energy(const Matrix&, const State& s, const Moduli& m) {
            return m.mu * contract(s.stretch, s.stretch);
        }
    };
};

}  // namespace
}  // namespace phyxel
