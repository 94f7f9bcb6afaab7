// No include guard and no includes but its laws: each source file of the cell kernel includes this once, in the target
// region of its instructions, after the headers that it needs.

#define PHYXEL_INLINE [[gnu::always_inline]] static inline

#include "forces/cell_laws_body.h"

namespace phyxel {
namespace {

/// The kernel for the lanes `S` of base/float_lanes.h. For the points q of all groups of a chunk at once:
///     H_q = sum_i u_i (x) g_qi,  F_q = I + H_q,  f_i -= V_q P(F_q) g_qi
/// with displacements u from a rigidly moved rest shape. All lengths are in spacings, all V lambda and V mu over the
/// unit of stiffness.
template <class S>
struct CellKernelBody : CellLaws<S> {
    using Laws = CellLaws<S>;
    using Laws::fma, Laws::lanes, Laws::load, Laws::splat, Laws::store;
    using typename Laws::CorotatedLaw, typename Laws::LinearLaw, typename Laws::NeoHookeanLaw,
        typename Laws::SaintVenantKirchhoffLaw;
    using typename Laws::Float, typename Laws::Matrix, typename Laws::Moduli;

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
    template <ChunkKind kind>
    struct Pairs {
        const std::uint16_t *entry, *end;
        const float* shared;
        const std::int16_t* difference;

        PHYXEL_INLINE Pairs of(const CellChunk& chunk, std::size_t point) {
            const std::size_t begin = chunk.pair_begin[point];
            constexpr std::size_t width = kind == ChunkKind::mixed ? 3 * lanes : 3;
            return {chunk.entry + begin, chunk.entry + chunk.pair_begin[point + 1], chunk.gradient + width * begin,
                    chunk.difference + (kind == ChunkKind::similar ? 3 * lanes * begin : 0)};
        }
        [[gnu::always_inline]] inline Float gradient(std::size_t axis) const {
            if constexpr (kind == ChunkKind::mixed) return load(shared + axis * lanes);
            else if constexpr (kind == ChunkKind::uniform) return splat(shared[axis]);
            else return splat(shared[axis]) + S::widen(difference + axis * lanes);
        }
        [[gnu::always_inline]] inline void next() {
            ++entry;
            shared += kind == ChunkKind::mixed ? 3 * lanes : 3;
            if constexpr (kind == ChunkKind::similar) difference += 3 * lanes;
        }
    };

    /// H = sum u (x) g over the pairs of a point.
    template <ChunkKind kind>
    PHYXEL_INLINE void displacement_gradient(Pairs<kind> pairs, const float* window, Matrix& H) {
        Float h[9] = {};
        for (; pairs.entry != pairs.end; pairs.next()) {
            const float* u = window + 3 * lanes * *pairs.entry;
            const Float x = load(u), y = load(u + lanes), z = load(u + 2 * lanes);
            const Float gx = pairs.gradient(0);
            h[0] = fma(x, gx, h[0]), h[3] = fma(y, gx, h[3]), h[6] = fma(z, gx, h[6]);
            const Float gy = pairs.gradient(1);
            h[1] = fma(x, gy, h[1]), h[4] = fma(y, gy, h[4]), h[7] = fma(z, gy, h[7]);
            const Float gz = pairs.gradient(2);
            h[2] = fma(x, gz, h[2]), h[5] = fma(y, gz, h[5]), h[8] = fma(z, gz, h[8]);
        }
        for (int k = 0; k < 9; ++k) H.m[k] = gradient_unit(kind) * h[k];
    }

    /// f += A g over the pairs of a point.
    template <ChunkKind kind>
    PHYXEL_INLINE void scatter_stress(Pairs<kind> pairs, const Matrix& A, float* window) {
        Float a[9];
        for (int k = 0; k < 9; ++k) a[k] = gradient_unit(kind) * A.m[k];
        for (; pairs.entry != pairs.end; pairs.next()) {
            float* f = window + 3 * lanes * *pairs.entry;
            Float x = load(f), y = load(f + lanes), z = load(f + 2 * lanes);
            const Float gx = pairs.gradient(0);
            x = fma(a[0], gx, x), y = fma(a[3], gx, y), z = fma(a[6], gx, z);
            const Float gy = pairs.gradient(1);
            x = fma(a[1], gy, x), y = fma(a[4], gy, y), z = fma(a[7], gy, z);
            const Float gz = pairs.gradient(2);
            x = fma(a[2], gz, x), y = fma(a[5], gz, y), z = fma(a[8], gz, z);
            store(f, x), store(f + lanes, y), store(f + 2 * lanes, z);
        }
    }

    // --- Chunks ------------------------------------------------------------------------------------------------------

    PHYXEL_INLINE Moduli moduli_of(const CellChunk& chunk, std::size_t point) {
        return {load(chunk.lame + 2 * point * lanes), load(chunk.lame + (2 * point + 1) * lanes),
                chunk.volume_stiffness ? load(chunk.volume_stiffness + point * lanes) : Float{}};
    }
    PHYXEL_INLINE bool has_point(const CellChunk& chunk, std::size_t point) {
        return chunk.pair_begin[point] < chunk.pair_begin[point + 1];
    }

    /// Calls `done(point, state, theta)` for each point, theta what `measure(point, state, theta)` writes or the mean
    /// of that over the points that share their dilatation.
    template <class State, class Measure, class Done>
    PHYXEL_INLINE void for_points(const CellChunk& chunk, Measure&& measure, Done&& done) {
        if (!chunk.share) {
            for (std::size_t point = 0; point < 8; ++point) {
                if (!has_point(chunk, point)) continue;
                State state;
                Float theta;
                measure(point, state, theta);
                done(point, state, theta);
            }
            return;
        }
        State state[8];
        Float mean{};
        for (std::size_t point = 0; point < 8; ++point) {
            if (!has_point(chunk, point)) continue;
            Float theta;
            measure(point, state[point], theta);
            mean = fma(load(chunk.share + point * lanes), theta, mean);
        }
        if (chunk.join) {
            Float joint{};
            for (std::size_t l = 0; l < lanes; ++l) joint[chunk.join[l]] += mean[l];
            for (std::size_t l = 0; l < lanes; ++l) mean[l] = joint[chunk.join[l]];
        }
        for (std::size_t point = 0; point < 8; ++point)
            if (has_point(chunk, point)) done(point, state[point], mean);
    }
    template <class Law, class Done>
    PHYXEL_INLINE void for_points_of(const CellChunk& chunk, const Matrix* H, Done&& done) {
        using State = typename Law::State;
        const auto measure = [&](std::size_t point, State& state, Float& theta) {
            theta = Law::measure(H[point], state);
        };
        for_points<State>(chunk, measure, done);
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
        for_points_of<Law>(chunk, H, [&](std::size_t point, const typename Law::State& state, const Float& theta) {
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
        for_points_of<Law>(chunk, H, [&](std::size_t point, const typename Law::State& state, const Float& theta) {
            const Moduli m = moduli_of(chunk, point);
            energy += Law::energy(H[point], state, m) + 0.5f * m.lambda * theta * theta;
        });
        return sum_of(energy);
    }

    /// A -= V F S_v of the rates W = beta F', S_v = lambda tr(D) I + 2 mu D, D = sym(F^T W).
    static void add_viscous_stresses(const CellChunk& chunk, const Matrix* H, const Matrix* W, Matrix* A) {
        const auto rate = [&](std::size_t point, Matrix& D, Float& theta) {
            const Matrix &h = H[point], &w = W[point];
            for (int r = 0; r < 3; ++r)
                for (int c = r; c < 3; ++c) {
                    Float sum = w.m[3 * r + c] + w.m[3 * c + r];
                    for (int k = 0; k < 3; ++k)
                        sum = fma(h.m[3 * k + r], w.m[3 * k + c], fma(h.m[3 * k + c], w.m[3 * k + r], sum));
                    D.m[3 * r + c] = D.m[3 * c + r] = 0.5f * sum;
                }
            theta = Laws::trace(D);
        };
        for_points<Matrix>(chunk, rate, [&](std::size_t point, const Matrix& D, const Float& theta) {
            const Moduli m = moduli_of(chunk, point);
            Matrix second;
            for (int k = 0; k < 9; ++k) second.m[k] = 2.0f * m.mu * D.m[k];
            Laws::add_identity(m.lambda * theta, second);
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) {
                    Float sum = second.m[3 * r + c];
                    for (int k = 0; k < 3; ++k) sum = fma(H[point].m[3 * r + k], second.m[3 * k + c], sum);
                    A[point].m[3 * r + c] -= sum;
                }
        });
    }

    static double energies_by_law(const CellChunk& chunk, const Matrix* H) {
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
    }
    static double stresses_by_law(const CellChunk& chunk, const Matrix* H, Matrix* A) {
        switch (chunk.law) {
            case Law::linear:
                return stresses<LinearLaw>(chunk, H, -1, A);
            case Law::saint_venant_kirchhoff:
                return stresses<SaintVenantKirchhoffLaw>(chunk, H, -1, A);
            case Law::corotated:
                return stresses<CorotatedLaw>(chunk, H, -1, A);
            case Law::neo_hookean:
                break;
        }
        return stresses<NeoHookeanLaw>(chunk, H, -1, A);
    }

    /// Gradients of a field of the slots at the points of a chunk.
    template <ChunkKind kind>
    PHYXEL_INLINE void gradients(const CellChunk& chunk, const Float4* field, float* window, Matrix* result) {
        gather_window(chunk, field, window);
        for (std::size_t point = 0; point < 8; ++point)
            if (has_point(chunk, point)) displacement_gradient(Pairs<kind>::of(chunk, point), window, result[point]);
    }

    template <ChunkKind kind>
    static double run_chunk(const CellChunk& chunk, CellTask task, const CellSlots& slots) {
        Matrix H[8], A[8];
        double energy = 0;
        gradients<kind>(chunk, slots.u, slots.scratch, H);
        if (task == CellTask::energy) return energies_by_law(chunk, H);
        if (task == CellTask::rest_action) stresses<LinearLaw>(chunk, H, 1, A);
        else energy = stresses_by_law(chunk, H, A);
        if (task == CellTask::damped_forces) {
            Matrix W[8];
            gradients<kind>(chunk, slots.rate, slots.scratch, W);
            add_viscous_stresses(chunk, H, W, A);
        }

        float* force = slots.scratch + 3 * lanes * chunk.entries;
        for (float *to = force, *end = force + 3 * lanes * chunk.entries; to != end; to += lanes) store(to, Float{});
        for (std::size_t point = 0; point < 8; ++point)
            if (has_point(chunk, point)) scatter_stress(Pairs<kind>::of(chunk, point), A[point], force);
        scatter_window(chunk, force, slots.f);
        return energy;
    }

    static double run(std::span<const CellChunk> chunks, CellTask task, const CellSlots& slots) {
        double energy = 0;
        for (const CellChunk& chunk : chunks) switch (chunk.kind) {
                case ChunkKind::uniform:
                    energy += run_chunk<ChunkKind::uniform>(chunk, task, slots);
                    break;
                case ChunkKind::similar:
                    energy += run_chunk<ChunkKind::similar>(chunk, task, slots);
                    break;
                case ChunkKind::mixed:
                    energy += run_chunk<ChunkKind::mixed>(chunk, task, slots);
                    break;
            }
        return energy;
    }
};

#undef PHYXEL_INLINE

}  // namespace
}  // namespace phyxel
