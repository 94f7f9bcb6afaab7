#include "reference/fem/solid.h"

#include <cmath>
#include <utility>

namespace phyxel::fem {
namespace {

/// dX/dxi of an element at a reference point.
Mat3 element_map(const Mesh& mesh, const std::size_t* nodes, const Shape& shape) {
    Mat3 map;
    for (std::size_t a = 0; a < shape.phi.size(); ++a) map += outer(mesh.X[nodes[a]], shape.slope[a]);
    return map;
}

/// Integral of each shape function over the body [m^3].
std::vector<double> nodal_volumes(const Mesh& mesh) {
    const std::size_t count = nodes_per_element(mesh.type);
    std::vector<double> volumes(mesh.X.size());
    for (const ReferencePoint& at : mass_quadrature(mesh.type)) {
        const Shape shape = shape_at(mesh.type, at.xi);
        for (std::size_t first = 0; first < mesh.elements.size(); first += count) {
            const std::size_t* nodes = &mesh.elements[first];
            const double V = at.weight * std::abs(determinant(element_map(mesh, nodes, shape)));
            for (std::size_t a = 0; a < count; ++a) volumes[nodes[a]] += shape.phi[a] * V;
        }
    }
    return volumes;
}

}  // namespace

Solid::Solid(Mesh box, const Material& elastic)
    : mesh(std::move(box)), material(material_point(elastic)), density(elastic.density) {
    std::vector<Shape> shapes;
    std::vector<double> weights;
    for (const ReferencePoint& at : stiffness_quadrature(mesh.type)) {
        shapes.push_back(shape_at(mesh.type, at.xi));
        weights.push_back(at.weight);
    }
    points_per_element = shapes.size();
    for (std::size_t first = 0; first < mesh.elements.size(); first += nodes_per_element(mesh.type))
        for (std::size_t point = 0; point < shapes.size(); ++point) {
            const Mat3 map = element_map(mesh, &mesh.elements[first], shapes[point]);
            // Mirrored tetrahedra have their corners in the other order: |det|.
            V.push_back(weights[point] * std::abs(determinant(map)));
            const Mat3 to_gradient = transpose(inverse(map));
            for (const Vec3& slope : shapes[point].slope) g.push_back(to_gradient * slope);
        }
}

void clamp(Conditions& conditions, const Solid& solid, Face face) {
    const std::vector<bool> on = nodes_on(solid.mesh, face);
    for (std::size_t i = 0; i < on.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (on[i]) conditions.fixed[3 * i + axis] = 1;
}

void add_face_force(Conditions& conditions, const Solid& solid, Face face, const Vec3& total) {
    const std::vector<double> weights = face_weights(solid.mesh, face);
    double area = 0;
    for (const double weight : weights) area += weight;
    for (std::size_t i = 0; i < weights.size(); ++i) conditions.force[i] += weights[i] / area * total;
}

void add_gravity(Conditions& conditions, const Solid& solid, const Vec3& gravity) {
    const std::vector<double> volumes = nodal_volumes(solid.mesh);
    for (std::size_t i = 0; i < volumes.size(); ++i) conditions.force[i] += solid.density * volumes[i] * gravity;
}

Mat3 deformation_gradient(const Solid& solid, const std::vector<Vec3>& x, std::size_t element, std::size_t point) {
    const std::size_t count = nodes_per_element(solid.mesh.type);
    const std::size_t* nodes = &solid.mesh.elements[element * count];
    const Vec3* g = &solid.g[(element * solid.points_per_element + point) * count];
    Mat3 F;
    for (std::size_t a = 0; a < count; ++a) F += outer(x[nodes[a]], g[a]);
    return F;
}

double elastic_energy(const Solid& solid, const std::vector<Vec3>& x) {
    double U = 0;
    for (std::size_t q = 0; q < solid.V.size(); ++q) {
        const std::size_t n = solid.points_per_element;
        U += solid.V[q] * energy(solid.material, deformation_gradient(solid, x, q / n, q % n));
    }
    return U;
}

std::vector<Vec3> elastic_forces(const Solid& solid, const std::vector<Vec3>& x) {
    const std::size_t count = nodes_per_element(solid.mesh.type), n = solid.points_per_element;
    std::vector<Vec3> f(x.size());
    for (std::size_t q = 0; q < solid.V.size(); ++q) {
        const Mat3 P = stress(solid.material, deformation_gradient(solid, x, q / n, q % n));
        const std::size_t* nodes = &solid.mesh.elements[q / n * count];
        for (std::size_t a = 0; a < count; ++a) f[nodes[a]] -= solid.V[q] * (P * solid.g[q * count + a]);
    }
    return f;
}

}  // namespace phyxel::fem
