#include "reference/fem/system.h"

#include <algorithm>
#include <cmath>

namespace phyxel::fem {
namespace {

/// [nodes] the nodes, ascending, that share an element with each node.
std::vector<std::vector<std::size_t>> neighbors(const Mesh& mesh) {
    const std::size_t count = nodes_per_element(mesh.type);
    std::vector<std::vector<std::size_t>> found(mesh.X.size());
    for (std::size_t first = 0; first < mesh.elements.size(); first += count)
        for (std::size_t a = 0; a < count; ++a)
            for (std::size_t b = 0; b < count; ++b) found[mesh.elements[first + a]].push_back(mesh.elements[first + b]);
    for (auto& nodes : found) {
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    }
    return found;
}

/// dP/dF as nine matrices: the change of P when one entry (row, column) of F grows, at 3 row + column.
struct StressDerivative {
    Mat3 by[9];

    StressDerivative(const MaterialPoint& material, const Mat3& F) {
        for (std::size_t entry = 0; entry < 9; ++entry) {
            Mat3 dF;
            dF(entry / 3, entry % 3) = 1;
            by[entry] = stress_action(material, F, dF);
        }
    }

    /// Column by column, the change of P when a node of shape gradient g moves along x, y, z.
    void along(const Vec3& g, Mat3 (&change)[3]) const {
        for (std::size_t axis = 0; axis < 3; ++axis)
            change[axis] = g.x * by[3 * axis] + g.y * by[3 * axis + 1] + g.z * by[3 * axis + 2];
    }
};

}  // namespace

System::System(const Solid& of, const Conditions& under)
    : solid(of), conditions(under), free_(3 * of.mesh.X.size(), -1) {
    for (std::size_t k = 0; k < free_.size(); ++k)
        if (!conditions.fixed[k]) free_[k] = size_++;
    pattern_ = pattern();
    mass_ = consistent_mass();
    solver_.analyzePattern(pattern_);
}

Eigen::VectorXd System::gather(const std::vector<Vec3>& nodal) const {
    Eigen::VectorXd values(size_);
    for (std::size_t k = 0; k < free_.size(); ++k)
        if (free_[k] >= 0) values[free_[k]] = nodal[k / 3][k % 3];
    return values;
}

void System::add(const Eigen::VectorXd& step, std::vector<Vec3>& x) const {
    for (std::size_t k = 0; k < free_.size(); ++k)
        if (free_[k] >= 0) x[k / 3][k % 3] += step[free_[k]];
}

SparseMatrix System::pattern() const {
    const auto adjacent = neighbors(solid.mesh);
    SparseMatrix zeros(size_, size_);
    std::size_t widest = 0;
    for (const auto& nodes : adjacent) widest = std::max(widest, nodes.size());
    zeros.reserve(Eigen::VectorXi::Constant(size_, static_cast<int>(3 * widest)));
    for (std::size_t column = 0; column < free_.size(); ++column)
        for (const std::size_t j : adjacent[column / 3])
            for (std::size_t row = 3 * j; row < 3 * j + 3; ++row)
                if (free_[column] >= 0 && free_[row] >= free_[column]) zeros.insert(free_[row], free_[column]) = 0;
    zeros.makeCompressed();
    return zeros;
}

void System::add_block(std::size_t i, std::size_t j, const Mat3& block, SparseMatrix& A) const {
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t r = 0; r < 3; ++r) {
            const Eigen::Index row = free_[3 * i + r], column = free_[3 * j + c];
            if (column >= 0 && row >= column) A.coeffRef(row, column) += block(r, c);
        }
}

SparseMatrix System::stiffness(const std::vector<Vec3>& x) const {
    const std::size_t count = nodes_per_element(solid.mesh.type), n = solid.points_per_element;
    SparseMatrix K = pattern_;
    for (std::size_t element = 0; element < element_count(solid.mesh); ++element) {
        std::vector<Mat3> blocks(count * count);
        for (std::size_t q = element * n; q < element * n + n; ++q) {
            const StressDerivative derivative(solid.material, deformation_gradient(solid, x, element, q % n));
            const Vec3* g = &solid.g[q * count];
            for (std::size_t b = 0; b < count; ++b) {
                // The force on node a is -V P g_a; node b changes P.
                Mat3 change[3];
                derivative.along(solid.V[q] * g[b], change);
                for (std::size_t a = 0; a < count; ++a)
                    blocks[a * count + b] += Mat3::from_columns(change[0] * g[a], change[1] * g[a], change[2] * g[a]);
            }
        }
        const std::size_t* nodes = &solid.mesh.elements[element * count];
        for (std::size_t a = 0; a < count; ++a)
            for (std::size_t b = 0; b < count; ++b) add_block(nodes[a], nodes[b], blocks[a * count + b], K);
    }
    return K;
}

SparseMatrix System::consistent_mass() const {
    const Mesh& mesh = solid.mesh;
    const std::size_t count = nodes_per_element(mesh.type);
    SparseMatrix M = pattern_;
    for (const ReferencePoint& at : mass_quadrature(mesh.type)) {
        const Shape shape = shape_at(mesh.type, at.xi);
        for (std::size_t first = 0; first < mesh.elements.size(); first += count) {
            Mat3 map;
            for (std::size_t a = 0; a < count; ++a) map += outer(mesh.X[mesh.elements[first + a]], shape.slope[a]);
            const double mass = solid.density * at.weight * std::abs(determinant(map));
            for (std::size_t a = 0; a < count; ++a)
                for (std::size_t b = 0; b < count; ++b)
                    add_block(mesh.elements[first + a], mesh.elements[first + b],
                              mass * shape.phi[a] * shape.phi[b] * Mat3::identity(), M);
        }
    }
    return M;
}

}  // namespace phyxel::fem
