#include "forces/constraints.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace phyxel {
namespace {

/// A node plane of the lattice: coordinate `axis` equal to `coordinate` (lattice frame).
struct NodePlane {
    int axis;
    double coordinate;
};

/// Distance from a node plane within which a piece of surface counts as lying in it, in pitches.
constexpr double plane_tolerance = 1e-3;

/// Stiffness of a patch that is held by a penalty, over E A / a.
constexpr double penalty_factor = 1000;

bool in_plane(const Vec3& p, const NodePlane& plane, double pitch) {
    return std::abs(p[plane.axis] - plane.coordinate) <= plane_tolerance * pitch;
}

/// The node plane that holds 99 % of the selection, if there is one.
std::optional<NodePlane> find_plane(const SurfaceSelection& selection, const Sampling& sampling) {
    if (sampling.lattice != Lattice::cubic) return {};
    const double a = sampling.pitch;
    for (int axis = 0; axis < 3; ++axis) {
        const NodePlane plane{axis, a * std::round(selection.position[0][axis] / a)};
        double inside = 0;
        for (std::size_t s = 0; s < selection.position.size(); ++s)
            if (in_plane(selection.position[s], plane, a)) inside += norm(selection.area[s]);
        if (inside >= 0.99 * selection.total_area) return plane;
    }
    return {};
}

/// Nodes of a plane of whose cell's surface in that plane at least half is selected.
std::vector<std::uint32_t> nodes_of_plane(const Model& m, const SurfaceSelection& selection, const NodePlane& plane) {
    std::map<std::uint32_t, double> all, selected;
    for (std::size_t b = 0; b < m.sampling.boundary.size(); ++b)
        if (in_plane(m.sampling.boundary[b].position, plane, m.sampling.pitch))
            all[m.sampling.boundary_cell[b]] += std::abs(m.sampling.boundary[b].area[plane.axis]);
    for (std::size_t s = 0; s < selection.cell.size(); ++s)
        selected[selection.cell[s]] += std::abs(selection.area[s][plane.axis]);
    std::vector<std::uint32_t> nodes;
    for (const auto& [cell, area] : selected) {
        const std::uint32_t node = m.sampling.cell_nodes[cell][0];
        if (node == no_index || !in_plane(m.sampling.nodes[node], plane, m.sampling.pitch)) continue;
        if (area >= 0.499 * all[cell]) nodes.push_back(node);
    }
    return nodes;
}

}  // namespace

GripMotion::GripMotion(const Fix& fix) : axis_(normalized(fix.axis)), center_(fix.center), path_(fix.path) {}

Vec3 GripMotion::place(const Vec3& X, double time) const {
    if (path_.empty()) return X;
    GripKey key = path_.front();
    if (time >= path_.back().time) {
        key = path_.back();
    } else if (time > key.time) {
        const auto next = std::find_if(path_.begin(), path_.end(), [&](const GripKey& k) { return k.time > time; });
        const GripKey& last = *(next - 1);
        const double s = (time - last.time) / (next->time - last.time);
        key.displacement = last.displacement + s * (next->displacement - last.displacement);
        key.degrees = last.degrees + s * (next->degrees - last.degrees);
    }
    if (key.degrees == 0) return X + key.displacement;
    return rotation_about(axis_, key.degrees * std::numbers::pi / 180) * (X - center_) + center_ + key.displacement;
}

void GripMotion::add_to(Hasher& hasher) const {
    hasher.add_value(axis_);
    hasher.add_value(center_);
    hasher.add_values(std::span<const GripKey>(path_));
}

struct Constraints::Factor {
    std::vector<std::uint32_t> rows;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt;
};

Constraints::Constraints() = default;
Constraints::~Constraints() = default;
Constraints::Constraints(Constraints&&) noexcept = default;
Constraints& Constraints::operator=(Constraints&&) noexcept = default;

std::size_t Constraints::add(const Model& model, const TriangleMesh& mesh, const Fix& fix, const Threads& threads) {
    const SurfaceSelection selection = select_surface(model, mesh, fix.box);
    const auto number = static_cast<std::uint32_t>(fixes_.size());
    HeldFix held{GripMotion(fix), {fix.x, fix.y, fix.z}};
    for (std::size_t s = 0; s < selection.position.size(); ++s)
        held.rest_center +=
            norm(selection.area[s]) / selection.total_area * model.sampling.frame.to_rest(selection.position[s]);
    fixes_.push_back(std::move(held));

    const std::size_t before = rows_.size();
    if (const auto plane = find_plane(selection, model.sampling))
        for (std::uint32_t node : nodes_of_plane(model, selection, *plane))
            rows_.push_back({number, {node}, {1.0}, model.rest[node], 0});
    if (rows_.size() == before) {
        // No node plane: one average a cell.
        const EmbeddedPoints points =
            embed(model.sampling, model.approximation, selection.position, selection.cell, Gradients::no, threads);
        std::map<std::uint32_t, std::vector<std::size_t>> patches;
        for (std::size_t s = 0; s < points.size(); ++s) patches[selection.cell[s]].push_back(s);
        for (const auto& [cell, pieces] : patches) {
            double area = 0;
            for (std::size_t s : pieces) area += norm(selection.area[s]);
            if (area < 1e-6 * model.sampling.pitch * model.sampling.pitch && patches.size() > 1) continue;
            std::map<std::uint32_t, double> coefficients;
            Row row{number, {}, {}, {}, penalty_factor * model.largest_modulus * area / model.node_length};
            for (std::size_t s : pieces) {
                const double share = norm(selection.area[s]) / area;
                for (std::uint32_t k = points.offset[s]; k < points.offset[s + 1]; ++k)
                    coefficients[points.node[k]] += share * points.phi[k];
                row.rest += share * model.sampling.frame.to_rest(selection.position[s]);
            }
            for (const auto& [node, c] : coefficients) row.node.push_back(node), row.coefficient.push_back(c);
            rows_.push_back(std::move(row));
        }
    }
    inverse_mass_ = model.inverse_mass;
    factorize(model);
    return number;
}

void Constraints::factorize(const Model& model) {
    for (int d = 0; d < 3; ++d) {
        auto factor = std::make_unique<Factor>();
        for (std::uint32_t r = 0; r < rows_.size(); ++r)
            if (fixes_[rows_[r].fix].directions[d]) factor->rows.push_back(r);
        if (factor->rows.empty()) {
            factors_[d].reset();
            continue;
        }
        std::vector<Eigen::Triplet<double>> entries;
        for (int k = 0; k < static_cast<int>(factor->rows.size()); ++k) {
            const Row& row = rows_[factor->rows[k]];
            for (std::size_t i = 0; i < row.node.size(); ++i)
                entries.emplace_back(k, static_cast<int>(row.node[i]),
                                     row.coefficient[i] * std::sqrt(inverse_mass_[row.node[i]]));
        }
        Eigen::SparseMatrix<double> C(static_cast<int>(factor->rows.size()), static_cast<int>(model.rest.size()));
        C.setFromTriplets(entries.begin(), entries.end());
        Eigen::SparseMatrix<double> G = C * C.transpose();
        // Rows of overlapping fixes may depend on each other: a shift keeps the factor alive, and whatever it leaves
        // open is closed by the next step, since the target is a place and not a velocity.
        const double shift = 1e-9 * G.diagonal().maxCoeff();
        for (int k = 0; k < G.rows(); ++k) G.coeffRef(k, k) += shift;
        factor->ldlt.compute(G);
        factors_[d] = std::move(factor);
    }
}

void Constraints::project(double time, double dt, std::span<const Vec3> x, std::span<Vec3> v, std::span<Vec3> impulse,
                          double left) {
    for (int d = 0; d < 3; ++d) {
        if (!factors_[d]) continue;
        const Factor& factor = *factors_[d];
        Eigen::VectorXd missing(factor.rows.size());
        for (std::size_t k = 0; k < factor.rows.size(); ++k) {
            const Row& row = rows_[factor.rows[k]];
            const GripMotion& motion = fixes_[row.fix].motion;
            double rate = 0, place = 0;
            for (std::size_t i = 0; i < row.node.size(); ++i) {
                rate += row.coefficient[i] * v[row.node[i]][d];
                place += row.coefficient[i] * x[row.node[i]][d];
            }
            double target = 0;
            if (dt > 0) {
                target = (motion.place(row.rest, time)[d] - place) / dt;
            } else if (motion.moves()) {
                constexpr double tick = 1e-6;  // [s] for the grip's velocity
                target = (motion.place(row.rest, time + tick)[d] - motion.place(row.rest, time - tick)[d]) / (2 * tick);
            }
            missing[static_cast<Eigen::Index>(k)] = target - rate;
        }
        const Eigen::VectorXd lambda = factor.ldlt.solve(missing);
        for (std::size_t k = 0; k < factor.rows.size(); ++k) {
            const Row& row = rows_[factor.rows[k]];
            const double force = lambda[static_cast<Eigen::Index>(k)];
            for (std::size_t i = 0; i < row.node.size(); ++i) {
                const double share = force * row.coefficient[i];
                v[row.node[i]][d] += share * inverse_mass_[row.node[i]];
                impulse[row.node[i]][d] += share / left;
            }
            Vec3 along{};
            along[d] = force / left;
            push(row, along, time);
        }
    }
}

void Constraints::push(const Row& row, const Vec3& impulse, double time) {
    HeldFix& fix = fixes_[row.fix];
    fix.force_impulse += impulse;
    fix.torque_impulse += cross(fix.motion.place(row.rest, time) - fix.motion.place(fix.rest_center, time), impulse);
}

void Constraints::add_to(Hasher& hasher) const {
    for (const HeldFix& fix : fixes_) {
        fix.motion.add_to(hasher);
        for (bool held : fix.directions) hasher.add_value(static_cast<std::uint64_t>(held));
    }
    for (const Row& row : rows_) {
        hasher.add_value(static_cast<std::uint64_t>(row.fix));
        hasher.add_values(std::span<const std::uint32_t>(row.node));
        hasher.add_values(std::span<const double>(row.coefficient));
    }
}

void Constraints::start_measuring() {
    for (HeldFix& fix : fixes_) fix.force_impulse = fix.torque_impulse = {};
}

Reaction Constraints::reaction(std::size_t fix, double seconds) const {
    if (seconds <= 0) return {};
    return {fixes_[fix].force_impulse / seconds, fixes_[fix].torque_impulse / seconds};
}

}  // namespace phyxel
