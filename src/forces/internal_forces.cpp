#include "forces/internal_forces.h"

#include <algorithm>

#include "forces/mean_dilatation.h"
#include "forces/point_kernels.h"

namespace phyxel {
namespace {

constexpr std::size_t node_chunk = 1024;

/// Points that are gathered, evaluated and scattered together: their matrices stay in the first-level cache.
constexpr std::uint32_t batch = 32;

/// Copies nodal vectors into the block's slots, relative to the first, so that the sums below do not depend on where in
/// space the body is.
void load_slots(const Stencils& st, const Stencils::Block& block, std::span<const Vec3> nodal, Double4* slots) {
    const Vec3 origin = nodal[st.slot_node[block.slot_begin]];
    for (std::uint32_t s = block.slot_begin; s < block.slot_end; ++s)
        store(slots[s - block.slot_begin], nodal[st.slot_node[s]] - origin);
}

Vec3 slot_rest(const Model& m, const Stencils::Block& block, std::uint32_t k) {
    return m.rest[m.stencils.slot_node[block.slot_begin + m.stencils.local[k]]];
}

/// Energy of one point's nodal stabilization, kappa/2 sum_j w_j |x_qj - F X_qj|^2.
double nodal_energy(const Model& m, const Stencils::Block& block, std::uint32_t q, const Mat3& F, const Double4* x) {
    const Stencils& st = m.stencils;
    const Vec3 own = load(x[m.nodal.self[q]]), own_rest = m.rest[m.sampling.point_node[q]];
    double U = 0;
    for (std::uint32_t k = st.offset[q]; k < st.offset[q + 1]; ++k)
        U += m.nodal.weight[k] * norm_squared(load(x[st.local[k]]) - own - F * (slot_rest(m, block, k) - own_rest));
    return 0.5 * m.nodal.kappa[q] * U;
}

/// Slots of x + beta v; v may be absent.
struct SlotMotion {
    const Double4* x;
    const Double4* v;
    double beta;
    Vec3 operator[](std::size_t slot) const { return v ? load(x[slot]) + beta * load(v[slot]) : load(x[slot]); }
};

/// Adds `sign` times its exact force at the positions y: with r_j = y_qj - F X_qj and T = sum_k w_k r_k (x) X_qk,
/// f_j = -kappa (w_j r_j - T g_j), and the node itself takes + kappa sum_k w_k r_k besides. Quadratic in y, so that its
/// viscous force is its force at beta v and its stiffness action minus its force at d.
void nodal_forces(const Model& m, const Stencils::Block& block, std::uint32_t q, const Mat3& F, const SlotMotion& y,
                  double sign, Double4* f) {
    const Stencils& st = m.stencils;
    const double kappa = sign * m.nodal.kappa[q];
    const Vec3 own = y[m.nodal.self[q]], own_rest = m.rest[m.sampling.point_node[q]];
    Mat3 T;
    Vec3 sum{};
    for (std::uint32_t k = st.offset[q]; k < st.offset[q + 1]; ++k) {
        const Vec3 X = slot_rest(m, block, k) - own_rest;
        const Vec3 wr = m.nodal.weight[k] * (y[st.local[k]] - own - F * X);
        T += outer(wr, X);
        sum += wr;
        add(f[st.local[k]], -kappa * wr);
    }
    add(f[m.nodal.self[q]], kappa * sum);
    Columns A;
    A = -kappa * T;
    scatter_stresses(st, q, q + 1, &A, f);
}

bool has_nodal(const Model& m) { return !m.nodal.kappa.empty(); }
bool has_filter(const Model& m) { return !m.filter.rows.offset.empty(); }

/// A point as the loops below hand it out: its deformation gradient, that of v (when given), and the block's slots.
struct PointState {
    const Stencils::Block& block;
    std::uint32_t q;
    Mat3 F, F_rate;
    const Double4 *x, *v;  ///< v: null when not given
};

/// Points of a block, gathered together.
struct Batch {
    const Stencils::Block& block;
    std::uint32_t begin, end;
    const Columns *F, *F_rate;
    const Double4 *x, *v;  ///< v: null when not given

    PointState state(std::uint32_t q) const {
        return {block, q, Mat3(F[q - begin]), v ? Mat3(F_rate[q - begin]) : Mat3{}, x, v};
    }
};

/// Calls `batch_done(Batch)` for all points of a block, `batch` at a time.
template <class BatchDone>
void for_batches(const Stencils& st, const Stencils::Block& block, const Double4* x, const Double4* v,
                 BatchDone&& batch_done) {
    Columns F[batch], F_rate[batch];
    for (std::uint32_t begin = block.point_begin; begin < block.point_end; begin += batch) {
        const std::uint32_t end = std::min(begin + batch, block.point_end);
        gather_gradients(st, begin, end, x, F);
        if (v) gather_gradients(st, begin, end, v, F_rate);
        batch_done(Batch{block, begin, end, F, F_rate, x, v});
    }
}

/// Slots of x and of v (null when not given) of a block, filled.
std::pair<Double4*, Double4*> fill_slots(const Stencils& st, const Stencils::Block& block, std::span<const Vec3> x,
                                         std::span<const Vec3> v, ForceWorkspace& work) {
    Double4* slot_x = &work.slot_x[block.slot_begin];
    load_slots(st, block, x, slot_x);
    if (v.empty()) return {slot_x, nullptr};
    Double4* slot_v = &work.slot_v[block.slot_begin];
    load_slots(st, block, v, slot_v);
    return {slot_x, slot_v};
}

/// Writes the nodal forces of the stresses A that `stresses(batch, A, slots of f)` fills in, f_i = -sum_q A_q g_qi, and
/// of what it adds to the slots itself: block by block, then the slots of each node in order.
template <class Stresses>
void scatter_batches(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, ForceWorkspace& work,
                     const Threads& threads, std::span<Vec3> f, Stresses&& stresses) {
    const Stencils& st = m.stencils;
    work.slot_x.resize(st.slot_node.size());
    work.slot_f.resize(st.slot_node.size());
    if (!v.empty()) work.slot_v.resize(st.slot_node.size());
    threads.for_each(st.blocks.size(), 1, [&](std::size_t b) {
        const Stencils::Block& block = st.blocks[b];
        const auto [slot_x, slot_v] = fill_slots(st, block, x, v, work);
        Double4* slot_f = &work.slot_f[block.slot_begin];
        std::fill(slot_f, slot_f + (block.slot_end - block.slot_begin), Double4{});
        Columns A[batch];
        for_batches(st, block, slot_x, slot_v, [&](const Batch& points) {
            stresses(points, A, slot_f);
            scatter_stresses(st, points.begin, points.end, A, slot_f);
        });
    });
    threads.for_each(f.size(), node_chunk, [&](std::size_t i) {
        Vec3 sum{};
        for (std::uint32_t k = st.node_slot_offset[i]; k < st.node_slot_offset[i + 1]; ++k)
            sum += load(work.slot_f[st.node_slots[k]]);
        f[i] = sum;
    });
}

/// The same for stresses A = `point(state, slots of f)`.
template <class Point>
void scatter_points(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, ForceWorkspace& work,
                    const Threads& threads, std::span<Vec3> f, Point&& point) {
    scatter_batches(m, x, v, work, threads, f, [&](const Batch& points, Columns* A, Double4* f_slots) {
        for (std::uint32_t q = points.begin; q < points.end; ++q) A[q - points.begin] = point(points.state(q), f_slots);
    });
}

/// Sum of `term(state)` over all points.
template <class Term>
double sum_points(const Model& m, std::span<const Vec3> x, ForceWorkspace& work, const Threads& threads, Term&& term) {
    const Stencils& st = m.stencils;
    work.slot_x.resize(st.slot_node.size());
    return threads.sum(st.blocks.size(), 1, [&](std::size_t b) {
        const Stencils::Block& block = st.blocks[b];
        const Double4* slot_x = fill_slots(st, block, x, {}, work).first;
        double sum = 0;
        for_batches(st, block, slot_x, nullptr, [&](const Batch& points) {
            for (std::uint32_t q = points.begin; q < points.end; ++q) sum += term(points.state(q));
        });
        return sum;
    });
}

/// Fills `work.pressure` with lambda times the cells' mean dilatation at x and, when v is given, `work.pressure_rate`
/// with that of `rate(law, F, F_rate)`. Nothing to do where every point is by itself.
template <class Rate>
void find_pressures(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, ForceWorkspace& work,
                    const Threads& threads, Rate&& rate) {
    if (m.dilatation.empty()) return;
    const Stencils& st = m.stencils;
    work.slot_x.resize(st.slot_node.size());
    work.dilatation.resize(st.points());
    if (!v.empty()) {
        work.slot_v.resize(st.slot_node.size());
        work.dilatation_rate.resize(st.points());
    }
    threads.for_each(st.blocks.size(), 1, [&](std::size_t b) {
        const Stencils::Block& block = st.blocks[b];
        const auto [slot_x, slot_v] = fill_slots(st, block, x, v, work);
        for_batches(st, block, slot_x, slot_v, [&](const Batch& points) {
            for (std::uint32_t q = points.begin; q < points.end; ++q) {
                if (!shares_dilatation(m, q)) continue;
                const PointState p = points.state(q);
                const Law law = m.point_material(q).law;
                work.dilatation[q] = dilatation(law, p.F);
                if (p.v) work.dilatation_rate[q] = rate(law, p.F, p.F_rate);
            }
        });
    });
    cell_means_times_lambda(m, work.dilatation, threads, work.pressure);
    if (!v.empty()) cell_means_times_lambda(m, work.dilatation_rate, threads, work.pressure_rate);
}

Vec3 row_product(const SparseRows& rows, std::size_t i, std::span<const Vec3> in) {
    Vec3 sum{};
    for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) sum += rows.value[k] * in[rows.column[k]];
    return sum;
}

/// (I - Phi)^2 (x + beta v), in `work.twice_filtered`; v may be empty. Positions count from the first node's.
void filter_twice(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, double beta, ForceWorkspace& work,
                  const Threads& threads) {
    work.moved.resize(x.size());
    work.filtered.resize(x.size());
    work.twice_filtered.resize(x.size());
    threads.for_each(x.size(), node_chunk,
                     [&](std::size_t i) { work.moved[i] = v.empty() ? x[i] - x[0] : x[i] - x[0] + beta * v[i]; });
    threads.for_each(x.size(), node_chunk,
                     [&](std::size_t i) { work.filtered[i] = row_product(m.filter.rows, i, work.moved); });
    threads.for_each(x.size(), node_chunk,
                     [&](std::size_t i) { work.twice_filtered[i] = row_product(m.filter.rows, i, work.filtered); });
}

/// f += sign H (x + beta v), H the constant Hessian of the filter energy.
void add_filter_forces(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, double beta, double sign,
                       ForceWorkspace& work, const Threads& threads, std::span<Vec3> f) {
    filter_twice(m, x, v, beta, work, threads);
    threads.for_each(x.size(), node_chunk,
                     [&](std::size_t i) { work.twice_filtered[i] *= sign * m.filter_stiffness[i]; });
    threads.for_each(x.size(), node_chunk,
                     [&](std::size_t i) { work.filtered[i] = row_product(m.filter.columns, i, work.twice_filtered); });
    threads.for_each(x.size(), node_chunk,
                     [&](std::size_t i) { f[i] += row_product(m.filter.columns, i, work.filtered); });
}

/// Rate of the trace of Green's strain, which is what damping sees of a change of volume.
double green_dilatation_rate(Law, const Mat3& F, const Mat3& F_rate) { return contract(F, F_rate); }

/// F S_v; `pressure_rate` [cells] lambda times the mean rate of the points that share their dilatation.
Mat3 viscous_stress(const Model& m, std::size_t q, const Mat3& F, const Mat3& F_rate, double beta,
                    std::span<const double> pressure_rate) {
    const Lame& lame = m.point_material(q).lame;
    const Mat3 L = transpose(F) * F_rate;
    const Mat3 E_rate = 0.5 * (L + transpose(L));
    const double pressure = shares_dilatation(m, q) ? pressure_rate[m.dilatation.cell[q]] : lame.lambda * trace(E_rate);
    return F * (beta * (pressure * Mat3::identity() + 2 * lame.mu * E_rate));
}

}  // namespace

std::vector<Mat3> deformation_gradients(const Model& m, std::span<const Vec3> x, const Threads& threads) {
    ForceWorkspace work;
    std::vector<Mat3> F(m.stencils.points());
    sum_points(m, x, work, threads, [&](const PointState& p) {
        F[p.q] = p.F;
        return 0.0;
    });
    return F;
}

double elastic_energy(const Model& m, std::span<const Vec3> x, ForceWorkspace& work, const Threads& threads) {
    const double own =
        sum_points(m, x, work, threads, [&](const PointState& p) { return m.volumes[p.q] * own_energy(m, p.q, p.F); });
    if (m.dilatation.empty()) return own;
    find_pressures(m, x, {}, work, threads, green_dilatation_rate);
    return own + shared_dilatation_energy(m, work.pressure);
}

double stabilization_energy(const Model& m, std::span<const Vec3> x, ForceWorkspace& work, const Threads& threads) {
    double U = 0;
    if (has_filter(m)) {
        filter_twice(m, x, {}, 0, work, threads);
        U += 0.5 * threads.sum(x.size(), node_chunk, [&](std::size_t i) {
            return m.filter_stiffness[i] * norm_squared(work.twice_filtered[i]);
        });
    }
    if (has_nodal(m))
        U += sum_points(m, x, work, threads, [&](const PointState& p) {
            return m.nodal.kappa[p.q] > 0 ? nodal_energy(m, p.block, p.q, p.F, p.x) : 0.0;
        });
    return U;
}

double internal_forces(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, double beta,
                       ForceWorkspace& work, const Threads& threads, std::span<Vec3> f) {
    if (beta <= 0) v = {};
    work.block_power.assign(m.stencils.blocks.size(), 0);
    find_pressures(m, x, v, work, threads, green_dilatation_rate);
    const auto point = [&](const PointState& p, Double4* f_slots) {
        Mat3 F = p.F, P = point_stress(m, p.q, F, work.pressure);
        if (p.v) {
            const Mat3 P_viscous = viscous_stress(m, p.q, F, p.F_rate, beta, work.pressure_rate);
            work.block_power[&p.block - m.stencils.blocks.data()] += m.volumes[p.q] * contract(P_viscous, p.F_rate);
            P += P_viscous;
            F += beta * p.F_rate;
        }
        if (has_nodal(m) && m.nodal.kappa[p.q] > 0) nodal_forces(m, p.block, p.q, F, {p.x, p.v, beta}, 1, f_slots);
        return m.volumes[p.q] * P;
    };
    if (v.empty() && !has_nodal(m) && m.uniform() && m.dilatation.empty())
        scatter_batches(m, x, v, work, threads, f, [&](const Batch& points, Columns* A, Double4*) {
            evaluate_stresses(m.material, points.end - points.begin, &m.volumes[points.begin], points.F, A);
        });
    else scatter_points(m, x, v, work, threads, f, point);
    if (has_filter(m)) add_filter_forces(m, x, v, beta, -1, work, threads, f);

    double power = 0;
    if (!v.empty()) power = 2 * beta * stabilization_energy(m, v, work, threads);  // the same quadratic form, at v
    for (double p : work.block_power) power += p;
    return power;
}

void stiffness_action(const Model& m, std::span<const Vec3> x, std::span<const Vec3> d, ForceWorkspace& work,
                      const Threads& threads, std::span<Vec3> out, Tangent tangent) {
    find_pressures(m, x, d, work, threads,
                   [](Law law, const Mat3& F, const Mat3& dF) { return contract(dilatation_gradient(law, F), dF); });
    const auto point = [&](const PointState& p, Double4* f_slots) {
        if (has_nodal(m) && m.nodal.kappa[p.q] > 0)
            nodal_forces(m, p.block, p.q, p.F_rate, {p.v, nullptr, 0}, -1, f_slots);
        const Mat3 dP = tangent == Tangent::exact
                            ? point_stress_action(m, p.q, p.F, p.F_rate, work.pressure, work.pressure_rate)
                            : corotated_frozen_action(p.F, p.F_rate, m.point_material(p.q).lame);
        return -m.volumes[p.q] * dP;
    };
    scatter_points(m, x, d, work, threads, out, point);
    if (has_filter(m)) add_filter_forces(m, d, {}, 0, 1, work, threads, out);
}

}  // namespace phyxel
