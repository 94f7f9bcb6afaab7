// No include guard and no includes: each source file of the cell kernel includes this once, in the target region of its
// instructions, after the headers that it needs.

namespace phyxel {
namespace {

#define PHYXEL_INLINE [[gnu::always_inline]] static inline

/// The kernel for the lanes `S` of base/float_lanes.h. For the points q of all groups of a chunk at once:
///     H_q = sum_i u_i (x) g_qi,  F_q = I + H_q,  f_i -= V_q P(F_q) g_qi
/// with displacements u from a rigidly moved rest shape. The laws are written in H, so that they keep their digits
/// where it is small. All lengths are in spacings, all V lambda and V mu over the unit of stiffness.
template <class S>
struct CellKernelBody {
    using Float = typename S::Float;
    static constexpr std::size_t lanes = S::count;

    PHYXEL_INLINE Float load(const float* from) { return *reinterpret_cast<const typename S::Unaligned*>(from); }
    PHYXEL_INLINE void store(float* to, const Float& value) { *reinterpret_cast<typename S::Unaligned*>(to) = value; }
    PHYXEL_INLINE Float splat(float value) { return value - Float{}; }
    PHYXEL_INLINE Float fma(const Float& a, const Float& b, const Float& c) { return S::fma(a, b, c); }

    struct Matrix {
        Float m[9];
    };

    // --- Nodes to lanes and back -------------------------------------------------------------------------------

    PHYXEL_INLINE const Float4Lanes& at(const Float4* u, const std::uint16_t* slot, std::size_t lane) {
        return reinterpret_cast<const Float4Lanes&>(u[slot[lane]]);
    }

    /// Components of eight slots: transposes pairs of four.
    PHYXEL_INLINE void gather8(const Float4* u, const std::uint16_t* slot, float* out) {
        const Float8Lanes a = __builtin_shufflevector(at(u, slot, 0), at(u, slot, 4), 0, 1, 2, 3, 4, 5, 6, 7);
        const Float8Lanes b = __builtin_shufflevector(at(u, slot, 1), at(u, slot, 5), 0, 1, 2, 3, 4, 5, 6, 7);
        const Float8Lanes c = __builtin_shufflevector(at(u, slot, 2), at(u, slot, 6), 0, 1, 2, 3, 4, 5, 6, 7);
        const Float8Lanes d = __builtin_shufflevector(at(u, slot, 3), at(u, slot, 7), 0, 1, 2, 3, 4, 5, 6, 7);
        const Float8Lanes ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
        const Float8Lanes cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
        const Float8Lanes ab_z = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
        const Float8Lanes cd_z = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
        store8(out, __builtin_shufflevector(ab, cd, 0, 1, 8, 9, 4, 5, 12, 13));
        store8(out + lanes, __builtin_shufflevector(ab, cd, 2, 3, 10, 11, 6, 7, 14, 15));
        store8(out + 2 * lanes, __builtin_shufflevector(ab_z, cd_z, 0, 1, 8, 9, 4, 5, 12, 13));
    }

    /// Adds the components of eight lanes to their slots, lane by lane: two lanes may share a node.
    PHYXEL_INLINE void scatter8(const float* from, const std::uint16_t* slot, Float4* f) {
        const Float8Lanes x = load8(from), y = load8(from + lanes), z = load8(from + 2 * lanes), zero{};
        const Float8Lanes xy = __builtin_shufflevector(x, y, 0, 8, 1, 9, 4, 12, 5, 13);
        const Float8Lanes xy_high = __builtin_shufflevector(x, y, 2, 10, 3, 11, 6, 14, 7, 15);
        const Float8Lanes z0 = __builtin_shufflevector(z, zero, 0, 8, 1, 9, 4, 12, 5, 13);
        const Float8Lanes z0_high = __builtin_shufflevector(z, zero, 2, 10, 3, 11, 6, 14, 7, 15);
        const Float8Lanes v[4] = {__builtin_shufflevector(xy, z0, 0, 1, 8, 9, 4, 5, 12, 13),
                                  __builtin_shufflevector(xy, z0, 2, 3, 10, 11, 6, 7, 14, 15),
                                  __builtin_shufflevector(xy_high, z0_high, 0, 1, 8, 9, 4, 5, 12, 13),
                                  __builtin_shufflevector(xy_high, z0_high, 2, 3, 10, 11, 6, 7, 14, 15)};
        for (std::size_t l = 0; l < 4; ++l)
            reinterpret_cast<Float4Lanes&>(f[slot[l]]) += __builtin_shufflevector(v[l], v[l], 0, 1, 2, 3);
        for (std::size_t l = 0; l < 4; ++l)
            reinterpret_cast<Float4Lanes&>(f[slot[4 + l]]) += __builtin_shufflevector(v[l], v[l], 4, 5, 6, 7);
    }

    PHYXEL_INLINE void store8(float* to, const Float8Lanes& value) {
        *reinterpret_cast<EightFloats::Unaligned*>(to) = value;
    }
    PHYXEL_INLINE Float8Lanes load8(const float* from) {
        return *reinterpret_cast<const EightFloats::Unaligned*>(from);
    }

    PHYXEL_INLINE void gather_window(const CellChunk& chunk, const Float4* u, float* window) {
        const std::uint16_t* slot = chunk.slot;
        const std::uint16_t* end = slot + chunk.entries * lanes;
        for (; slot != end; slot += lanes, window += 3 * lanes)
            for (std::size_t l = 0; l < lanes; l += 8) gather8(u, slot + l, window + l);
    }

    PHYXEL_INLINE void scatter_window(const CellChunk& chunk, const float* window, Float4* f) {
        const std::uint16_t* slot = chunk.slot;
        const std::uint16_t* end = slot + chunk.entries * lanes;
        for (; slot != end; slot += lanes, window += 3 * lanes)
            for (std::size_t l = 0; l < lanes; l += 8) scatter8(window + l, slot + l, f);
    }

    // --- Pairs ---------------------------------------------------------------------------------------------------

    /// Pairs of one point of a chunk. (By value: the compiler must not think that stores could change them.)
    struct Pairs {
        const std::uint16_t *entry, *end;
        const float* gradient;
    };

    template <bool uniform>
    PHYXEL_INLINE Pairs pairs_of(const CellChunk& chunk, std::size_t point) {
        const std::size_t begin = chunk.pair_begin[point];
        return {chunk.entry + begin, chunk.entry + chunk.pair_begin[point + 1],
                chunk.gradient + 3 * begin * (uniform ? 1 : lanes)};
    }

    template <bool uniform>
    PHYXEL_INLINE Float gradient(const float* g, std::size_t axis) {
        if constexpr (uniform) return splat(g[axis]);
        else return load(g + axis * lanes);
    }

    /// H = sum u (x) g over the pairs of a point.
    template <bool uniform>
    PHYXEL_INLINE void displacement_gradient(const Pairs& pairs, const float* window, Matrix& H) {
        Float h[9] = {};
        const float* g = pairs.gradient;
        for (const std::uint16_t* e = pairs.entry; e != pairs.end; ++e, g += uniform ? 3 : 3 * lanes) {
            const float* u = window + 3 * lanes * *e;
            const Float x = load(u), y = load(u + lanes), z = load(u + 2 * lanes);
            const Float gx = gradient<uniform>(g, 0);
            h[0] = fma(x, gx, h[0]), h[3] = fma(y, gx, h[3]), h[6] = fma(z, gx, h[6]);
            const Float gy = gradient<uniform>(g, 1);
            h[1] = fma(x, gy, h[1]), h[4] = fma(y, gy, h[4]), h[7] = fma(z, gy, h[7]);
            const Float gz = gradient<uniform>(g, 2);
            h[2] = fma(x, gz, h[2]), h[5] = fma(y, gz, h[5]), h[8] = fma(z, gz, h[8]);
        }
        for (int k = 0; k < 9; ++k) H.m[k] = h[k];
    }

    /// f += A g over the pairs of a point.
    template <bool uniform>
    PHYXEL_INLINE void scatter_stress(const Pairs& pairs, const Matrix& A, float* window) {
        const Float a[9] = {A.m[0], A.m[1], A.m[2], A.m[3], A.m[4], A.m[5], A.m[6], A.m[7], A.m[8]};
        const float* g = pairs.gradient;
        for (const std::uint16_t* e = pairs.entry; e != pairs.end; ++e, g += uniform ? 3 : 3 * lanes) {
            float* f = window + 3 * lanes * *e;
            Float x = load(f), y = load(f + lanes), z = load(f + 2 * lanes);
            const Float gx = gradient<uniform>(g, 0);
            x = fma(a[0], gx, x), y = fma(a[3], gx, y), z = fma(a[6], gx, z);
            const Float gy = gradient<uniform>(g, 1);
            x = fma(a[1], gy, x), y = fma(a[4], gy, y), z = fma(a[7], gy, z);
            const Float gz = gradient<uniform>(g, 2);
            x = fma(a[2], gz, x), y = fma(a[5], gz, y), z = fma(a[8], gz, z);
            store(f, x), store(f + lanes, y), store(f + 2 * lanes, z);
        }
    }

    // --- Laws --------------------------------------------------------------------------------------------------------
    // Each energy is that of lambda = 0 and lambda/2 theta^2 with the law's own dilatation theta, which the points of a
    // nearly incompressible cell share. `measure` returns theta and keeps what stress and energy need of it; `stress`
    // is V P with V lambda theta given, `energy` V Psi of lambda = 0.

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

    // --- Chunks ------------------------------------------------------------------------------------------------------

    PHYXEL_INLINE Moduli moduli_of(const CellChunk& chunk, std::size_t point) {
        return {load(chunk.lame + 2 * point * lanes), load(chunk.lame + (2 * point + 1) * lanes),
                chunk.volume_stiffness ? load(chunk.volume_stiffness + point * lanes) : Float{}};
    }
    PHYXEL_INLINE bool has_point(const CellChunk& chunk, std::size_t point) {
        return chunk.pair_begin[point] < chunk.pair_begin[point + 1];
    }

    /// Calls `done(point, state, theta)` for each point, theta its own dilatation or the mean of its group.
    template <class Law, class Done>
    PHYXEL_INLINE void for_points(const CellChunk& chunk, const Matrix* H, Done&& done) {
        if (!chunk.share) {
            for (std::size_t point = 0; point < 8; ++point) {
                if (!has_point(chunk, point)) continue;
                typename Law::State state;
                const Float theta = Law::measure(H[point], state);
                done(point, state, theta);
            }
            return;
        }
        typename Law::State state[8];
        Float mean{};
        for (std::size_t point = 0; point < 8; ++point)
            if (has_point(chunk, point))
                mean = fma(load(chunk.share + point * lanes), Law::measure(H[point], state[point]), mean);
        if (chunk.join) {
            Float joint{};
            for (std::size_t l = 0; l < lanes; ++l) joint[chunk.join[l]] += mean[l];
            for (std::size_t l = 0; l < lanes; ++l) mean[l] = joint[chunk.join[l]];
        }
        for (std::size_t point = 0; point < 8; ++point)
            if (has_point(chunk, point)) done(point, state[point], mean);
    }

    PHYXEL_INLINE double sum_of(const Float& v) {
        double sum = 0;
        for (std::size_t l = 0; l < lanes; ++l) sum += static_cast<double>(v[l]);
        return sum;
    }

    /// A = sign V P; returns the energy.
    template <class Law>
    static double stresses(const CellChunk& chunk, const Matrix* H, float sign, Matrix* A) {
        Float energy{};
        for_points<Law>(chunk, H, [&](std::size_t point, const typename Law::State& state, const Float& theta) {
            const Moduli m = moduli_of(chunk, point);
            const Float pressure = m.lambda * theta;
            energy += Law::energy(H[point], state, m) + 0.5f * pressure * theta;
            Law::stress(H[point], state, pressure, m, A[point]);
            for (int k = 0; k < 9; ++k) A[point].m[k] *= sign;
        });
        return sum_of(energy);
    }

    template <class Law>
    static double energies(const CellChunk& chunk, const Matrix* H) {
        Float energy{};
        for_points<Law>(chunk, H, [&](std::size_t point, const typename Law::State& state, const Float& theta) {
            const Moduli m = moduli_of(chunk, point);
            energy += Law::energy(H[point], state, m) + 0.5f * m.lambda * theta * theta;
        });
        return sum_of(energy);
    }

    template <bool uniform>
    static double run_chunk(const CellChunk& chunk, CellTask task, const Float4* u, Float4* f, float* scratch) {
        Matrix H[8], A[8];
        double energy = 0;
        gather_window(chunk, u, scratch);
        for (std::size_t point = 0; point < 8; ++point)
            if (has_point(chunk, point))
                displacement_gradient<uniform>(pairs_of<uniform>(chunk, point), scratch, H[point]);

        switch (task) {
            case CellTask::energy:
                switch (chunk.law) {
                    case Law::linear:
                        return energies<LinearLaw>(chunk, H);
                    case Law::saint_venant_kirchhoff:
                        return energies<SaintVenantKirchhoffLaw>(chunk, H);
                    case Law::corotated:
                        return energies<CorotatedLaw>(chunk, H);
                    case Law::neo_hookean:
                        break;
                }
                return energies<NeoHookeanLaw>(chunk, H);
            case CellTask::rest_action:
                stresses<LinearLaw>(chunk, H, 1, A);
                break;
            case CellTask::forces:
                switch (chunk.law) {
                    case Law::linear:
                        energy = stresses<LinearLaw>(chunk, H, -1, A);
                        break;
                    case Law::saint_venant_kirchhoff:
                        energy = stresses<SaintVenantKirchhoffLaw>(chunk, H, -1, A);
                        break;
                    case Law::corotated:
                        energy = stresses<CorotatedLaw>(chunk, H, -1, A);
                        break;
                    case Law::neo_hookean:
                        energy = stresses<NeoHookeanLaw>(chunk, H, -1, A);
                        break;
                }
        }

        float* force = scratch + 3 * lanes * chunk.entries;
        for (float *to = force, *end = force + 3 * lanes * chunk.entries; to != end; to += lanes) store(to, Float{});
        for (std::size_t point = 0; point < 8; ++point)
            if (has_point(chunk, point)) scatter_stress<uniform>(pairs_of<uniform>(chunk, point), A[point], force);
        scatter_window(chunk, force, f);
        return energy;
    }

    static double run(std::span<const CellChunk> chunks, CellTask task, const Float4* u, Float4* f, float* scratch) {
        double energy = 0;
        for (const CellChunk& chunk : chunks)
            energy += chunk.uniform ? run_chunk<true>(chunk, task, u, f, scratch)
                                    : run_chunk<false>(chunk, task, u, f, scratch);
        return energy;
    }
};

#undef PHYXEL_INLINE

}  // namespace
}  // namespace phyxel
