#include "geometry/winding_number.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace phyxel {

namespace {

/// Half the solid angle of triangle abc seen from the origin, positive when the origin is on its inner side:
/// tan(Omega / 2) = a.(b x c) / (|a||b||c| + (a.b)|c| + (b.c)|a| + (c.a)|b|).
/// Van Oosterom and Strackee, "The solid angle of a plane triangle" (1983), equation 8.
double half_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double la = norm(a), lb = norm(b), lc = norm(c);
    return std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

Vec3 area_vector(const std::array<Vec3, 3>& t) { return 0.5 * cross(t[1] - t[0], t[2] - t[0]); }

Vec3 centroid(const std::array<Vec3, 3>& t) { return (t[0] + t[1] + t[2]) / 3.0; }

}  // namespace

WindingNumber::WindingNumber(const TriangleMesh& mesh, double far_ratio) {
    const Bvh bvh = build_bvh(mesh, 8);
    if (bvh.nodes.empty()) return;

    // Corners in the tree's order, in units of the mesh's own size
    const Vec3 size = bvh.nodes[0].box.size();
    const double longest = std::max({size.x, size.y, size.z});
    origin_ = bvh.nodes[0].box.center();
    inverse_size_ = longest > 0 ? 1 / longest : 1;
    triangles_.reserve(bvh.order.size());
    for (const std::uint32_t t : bvh.order) {
        std::array<Vec3, 3> corners;
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = (mesh.vertices[mesh.triangles[t][k]] - origin_) * inverse_size_;
        triangles_.push_back(corners);
    }

    nodes_.reserve(bvh.nodes.size());
    for (const Bvh::Node& node : bvh.nodes) nodes_.push_back(moments_of(node, far_ratio));
}

WindingNumber::Moments WindingNumber::moments_of(const Bvh::Node& node, double far_ratio) const {
    Moments m;
    m.begin = node.begin;
    m.end = node.end;
    m.right = node.right;

    // Centre and radius
    double total = 0;
    for (std::uint32_t i = m.begin; i < m.end; ++i) {
        const double area = norm(area_vector(triangles_[i]));
        m.center += area * centroid(triangles_[i]);
        total += area;
    }
    m.center = total > 0 ? m.center / total : triangles_[m.begin][0];
    double radius_squared = 0;
    for (std::uint32_t i = m.begin; i < m.end; ++i)
        for (const Vec3& corner : triangles_[i])
            radius_squared = std::max(radius_squared, norm_squared(corner - m.center));
    m.far_squared = far_ratio * far_ratio * radius_squared;

    // Moments; a quadratic function is integrated over a triangle by the rule (sum over corners + 9 centroid) / 12
    for (std::uint32_t i = m.begin; i < m.end; ++i) {
        const Vec3 area = area_vector(triangles_[i]), c = centroid(triangles_[i]) - m.center;
        m.A += area;
        m.M += outer(area, c);
        const auto add_point = [&](const Vec3& d, double weight) {
            m.t += weight * (2 * dot(area, d) * d + norm_squared(d) * area);
            m.C.add(weight * area, d);
        };
        add_point(c, 0.75);
        for (const Vec3& corner : triangles_[i]) add_point(corner - m.center, 1.0 / 12);
    }
    return m;
}

void WindingNumber::CubicForm::add(const Vec3& n, const Vec3& d) {
    const double xx = d.x * d.x, yy = d.y * d.y, zz = d.z * d.z;
    const double xy = 2 * d.x * d.y, yz = 2 * d.y * d.z, zx = 2 * d.z * d.x;
    const std::array<double, 10> terms = {n.x * xx,
                                          n.y * yy,
                                          n.z * zz,
                                          n.y * xx + n.x * xy,
                                          n.z * xx + n.x * zx,
                                          n.x * yy + n.y * xy,
                                          n.z * yy + n.y * yz,
                                          n.x * zz + n.z * zx,
                                          n.y * zz + n.z * yz,
                                          n.x * yz + n.y * zx + n.z * xy};
    for (std::size_t i = 0; i < terms.size(); ++i) coefficients[i] += terms[i];
}

double WindingNumber::CubicForm::operator()(const Vec3& r) const {
    const auto& k = coefficients;
    return r.x * r.x * (k[0] * r.x + k[3] * r.y + k[4] * r.z) + r.y * r.y * (k[1] * r.y + k[5] * r.x + k[6] * r.z) +
           r.z * r.z * (k[2] * r.z + k[7] * r.x + k[8] * r.y) + k[9] * r.x * r.y * r.z;
}

double WindingNumber::far_field(const Moments& node, const Vec3& r, double r_squared) const {
    const double quadratic = 3 * dot(r, node.M * r) + 1.5 * dot(node.t, r) - 7.5 * node.C(r) / r_squared;
    return (dot(node.A, r) + trace(node.M) - quadratic / r_squared) / (r_squared * std::sqrt(r_squared));
}

double WindingNumber::operator()(const Vec3& point) const {
    const Vec3 q = (point - origin_) * inverse_size_;
    double half_angles = 0, far_angles = 0;
    std::array<std::uint32_t, 64> stack;  // one entry a level: the tree halves 2^32 triangles at most 32 times
    std::size_t depth = 0;
    if (!nodes_.empty()) stack[depth++] = 0;
    while (depth > 0) {
        const std::uint32_t index = stack[--depth];
        const Moments& node = nodes_[index];
        const Vec3 r = node.center - q;
        const double r2 = norm_squared(r);
        if (r2 > node.far_squared) {
            far_angles += far_field(node, r, r2);
        } else if (node.right == 0) {
            for (std::uint32_t i = node.begin; i < node.end; ++i)
                half_angles += half_solid_angle(triangles_[i][0] - q, triangles_[i][1] - q, triangles_[i][2] - q);
        } else {
            stack[depth++] = node.right;
            stack[depth++] = index + 1;
        }
    }
    return (2 * half_angles + far_angles) / (4 * std::numbers::pi);
}

double exact_winding_number(const TriangleMesh& mesh, const Vec3& point) {
    double half_angles = 0;
    for (const Triangle& t : mesh.triangles)
        half_angles +=
            half_solid_angle(mesh.vertices[t[0]] - point, mesh.vertices[t[1]] - point, mesh.vertices[t[2]] - point);
    return half_angles / (2 * std::numbers::pi);
}

}  // namespace phyxel
