#include "forces/internal_forces.h"

#include <algorithm>

namespace phyxel {
namespace {

constexpr std::size_t node_chunk = 1024;

/// Copies nodal vectors into the block's slots, relative to the first, so that the sums below do not depend on where in
/// space the body is.
void gather(const Stencils& st, const Stencils::Block& block, std::span<const Vec3> nodal, Vec3* slots) {
    const Vec3 origin = nodal[st.slot_node[block.slot_begin]];
    for (std::uint32_t s = block.slot_begin; s < block.slot_end; ++s)
        slots[s - block.slot_begin] = nodal[st.slot_node[s]] - origin;
}

/// sum_i x_i (x) g_qi over the pairs of point q.
Mat3 gradient_at(const Stencils& st, std::uint32_t q, const Vec3* x) {
    const std::uint32_t begin = st.offset[q], count = st.offset[q + 1] - begin;
    const std::uint16_t* local = &st.local[begin];
    const Vec3* g = &st.gradient[st.gradient_begin[q]];
    Mat3 F;
    for (std::uint32_t k = 0; k < count; ++k) F += outer(x[local[k]], g[k]);
    return F;
}

/// f_i -= A g_qi over the pairs of point q.
void scatter(const Stencils& st, std::uint32_t q, const Mat3& A, Vec3* f) {
    const std::uint32_t begin = st.offset[q], count = st.offset[q + 1] - begin;
    const std::uint16_t* local = &st.local[begin];
    const Vec3* g = &st.gradient[st.gradient_begin[q]];
    for (std::uint32_t k = 0; k < count; ++k) f[local[k]] -= A * g[k];
}

Vec3 slot_rest(const Model& m, const Stencils::Block& block, std::uint32_t k) {
    return m.rest[m.stencils.slot_node[block.slot_begin + m.stencils.local[k]]];
}

/// Energy of one point's nodal stabilization, kappa/2 sum_j w_j |x_qj - F X_qj|^2.
double nodal_energy(const Model& m, const Stencils::Block& block, std::uint32_t q, const Mat3& F, const Vec3* x) {
    const Stencils& st = m.stencils;
    const Vec3 own = x[m.nodal.self[q]], own_rest = m.rest[m.sampling.point_node[q]];
    double U = 0;
    for (std::uint32_t k = st.offset[q]; k < st.offset[q + 1]; ++k)
        U += m.nodal.weight[k] * norm_squared(x[st.local[k]] - own - F * (slot_rest(m, block, k) - own_rest));
    return 0.5 * m.nodal.kappa[q] * U;
}

/// Slots of x + beta v; v may be absent.
struct SlotMotion {
    const Vec3* x;
    const Vec3* v;
    double beta;
    Vec3 operator[](std::size_t slot) const { return v ? x[slot] + beta * v[slot] : x[slot]; }
};

/// Adds `sign` times its exact force at the positions y: with r_j = y_qj - F X_qj and T = sum_k w_k r_k (x) X_qk,
/// f_j = -kappa (w_j r_j - T g_j), and the node itself takes + kappa sum_k w_k r_k besides. Quadratic in y, so that its
/// viscous force is its force at beta v and its stiffness action minus its force at d.
void nodal_forces(const Model& m, const Stencils::Block& block, std::uint32_t q, const Mat3& F, const SlotMotion& y,
                  double sign, Vec3* f) {
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
        f[st.local[k]] -= kappa * wr;
    }
    f[m.nodal.self[q]] += kappa * sum;
    scatter(st, q, -kappa * T, f);
}

bool has_nodal(const Model& m) { return !m.nodal.kappa.empty(); }
bool has_filter(const Model& m) { return !m.filter.rows.offset.empty(); }

/// Runs `point(q, x, v, f)` over all points, block by block, with the block's slots of x, of v (when given) and of f,
/// and adds up the slots of f at the nodes.
template <class Point>
void scatter_points(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, ForceWorkspace& work,
                    const Threads& threads, std::span<Vec3> f, Point&& point) {
    const Stencils& st = m.stencils;
    work.slot_x.resize(st.slot_node.size());
    work.slot_f.resize(st.slot_node.size());
    if (!v.empty()) work.slot_v.resize(st.slot_node.size());
    threads.for_each(st.blocks.size(), 1, [&](std::size_t b) {
        const Stencils::Block& block = st.blocks[b];
        Vec3 *slot_x = &work.slot_x[block.slot_begin], *slot_f = &work.slot_f[block.slot_begin];
        Vec3* slot_v = v.empty() ? nullptr : &work.slot_v[block.slot_begin];
        gather(st, block, x, slot_x);
        if (slot_v) gather(st, block, v, slot_v);
        std::fill(slot_f, slot_f + (block.slot_end - block.slot_begin), Vec3{});
        for (std::uint32_t q = block.point_begin; q < block.point_end; ++q) point(block, q, slot_x, slot_v, slot_f);
    });
    threads.for_each(f.size(), node_chunk, [&](std::size_t i) {
        Vec3 sum{};
        for (std::uint32_t k = st.node_slot_offset[i]; k < st.node_slot_offset[i + 1]; ++k)
            sum += work.slot_f[st.node_slots[k]];
        f[i] = sum;
    });
}

/// Sum over all points of `term(block, q, x, v)`.
template <class Term>
double sum_points(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, ForceWorkspace& work,
                  const Threads& threads, Term&& term) {
    const Stencils& st = m.stencils;
    work.slot_x.resize(st.slot_node.size());
    if (!v.empty()) work.slot_v.resize(st.slot_node.size());
    return threads.sum(st.blocks.size(), 1, [&](std::size_t b) {
        const Stencils::Block& block = st.blocks[b];
        Vec3* slot_x = &work.slot_x[block.slot_begin];
        Vec3* slot_v = v.empty() ? nullptr : &work.slot_v[block.slot_begin];
        gather(st, block, x, slot_x);
        if (slot_v) gather(st, block, v, slot_v);
        double sum = 0;
        for (std::uint32_t q = block.point_begin; q < block.point_end; ++q) sum += term(block, q, slot_x, slot_v);
        return sum;
    });
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
    const double E = sign * m.settings.youngs_modulus;
    threads.for_each(x.size(), node_chunk, [&](std::size_t i) { work.twice_filtered[i] *= E * m.filter_share[i]; });
    threads.for_each(x.size(), node_chunk,
                     [&](std::size_t i) { work.filtered[i] = row_product(m.filter.columns, i, work.twice_filtered); });
    threads.for_each(x.size(), node_chunk,
                     [&](std::size_t i) { f[i] += row_product(m.filter.columns, i, work.filtered); });
}

Mat3 viscous_stress(const Lame& lame, const Mat3& F, const Mat3& F_rate, double beta) {
    const Mat3 L = transpose(F) * F_rate;
    const Mat3 E_rate = 0.5 * (L + transpose(L));
    return F * (beta * (lame.lambda * trace(E_rate) * Mat3::identity() + 2 * lame.mu * E_rate));
}

}  // namespace

std::vector<Mat3> deformation_gradients(const Model& m, std::span<const Vec3> x, const Threads& threads) {
    ForceWorkspace work;
    std::vector<Mat3> F(m.stencils.points());
    sum_points(m, x, {}, work, threads, [&](const Stencils::Block&, std::uint32_t q, const Vec3* slots, const Vec3*) {
        F[q] = gradient_at(m.stencils, q, slots);
        return 0.0;
    });
    return F;
}

double elastic_energy(const Model& m, std::span<const Vec3> x, ForceWorkspace& work, const Threads& threads) {
    return sum_points(m, x, {}, work, threads,
                      [&](const Stencils::Block&, std::uint32_t q, const Vec3* slots, const Vec3*) {
                          return m.volumes[q] * energy(m.material, gradient_at(m.stencils, q, slots));
                      });
}

double stabilization_energy(const Model& m, std::span<const Vec3> x, ForceWorkspace& work, const Threads& threads) {
    double U = 0;
    if (has_filter(m)) {
        filter_twice(m, x, {}, 0, work, threads);
        U += 0.5 * m.settings.youngs_modulus * threads.sum(x.size(), node_chunk, [&](std::size_t i) {
            return m.filter_share[i] * norm_squared(work.twice_filtered[i]);
        });
    }
    if (has_nodal(m))
        U += sum_points(
            m, x, {}, work, threads,
            [&](const Stencils::Block& block, std::uint32_t q, const Vec3* slots, const Vec3*) {
                return m.nodal.kappa[q] > 0 ? nodal_energy(m, block, q, gradient_at(m.stencils, q, slots), slots) : 0.0;
            });
    return U;
}

double internal_forces(const Model& m, std::span<const Vec3> x, std::span<const Vec3> v, double beta,
                       ForceWorkspace& work, const Threads& threads, std::span<Vec3> f) {
    if (beta <= 0) v = {};
    work.block_power.assign(m.stencils.blocks.size(), 0);
    const auto point = [&](const Stencils::Block& block, std::uint32_t q, const Vec3* sx, const Vec3* sv, Vec3* sf) {
        Mat3 F = gradient_at(m.stencils, q, sx);
        Mat3 P = stress(m.material, F);
        if (sv) {
            const Mat3 F_rate = gradient_at(m.stencils, q, sv);
            const Mat3 P_viscous = viscous_stress(m.material.lame, F, F_rate, beta);
            work.block_power[&block - m.stencils.blocks.data()] += m.volumes[q] * contract(P_viscous, F_rate);
            P += P_viscous;
            F += beta * F_rate;
        }
        scatter(m.stencils, q, m.volumes[q] * P, sf);
        if (has_nodal(m) && m.nodal.kappa[q] > 0) nodal_forces(m, block, q, F, {sx, sv, beta}, 1, sf);
    };
    scatter_points(m, x, v, work, threads, f, point);
    if (has_filter(m)) add_filter_forces(m, x, v, beta, -1, work, threads, f);

    double power = 0;
    if (!v.empty()) power = 2 * beta * stabilization_energy(m, v, work, threads);  // the same quadratic form, at v
    for (double p : work.block_power) power += p;
    return power;
}

void stiffness_action(const Model& m, std::span<const Vec3> x, std::span<const Vec3> d, ForceWorkspace& work,
                      const Threads& threads, std::span<Vec3> out) {
    const auto point = [&](const Stencils::Block& block, std::uint32_t q, const Vec3* sx, const Vec3* sd, Vec3* sf) {
        const Mat3 F = gradient_at(m.stencils, q, sx), dF = gradient_at(m.stencils, q, sd);
        scatter(m.stencils, q, -m.volumes[q] * stress_action(m.material, F, dF), sf);
        if (!has_nodal(m) || m.nodal.kappa[q] == 0) return;
        nodal_forces(m, block, q, dF, {sd, nullptr, 0}, -1, sf);
    };
    scatter_points(m, x, d, work, threads, out, point);
    if (has_filter(m)) add_filter_forces(m, d, {}, 0, 1, work, threads, out);
}

}  // namespace phyxel
