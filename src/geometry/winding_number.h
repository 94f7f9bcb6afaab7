#pragma once

#include <array>
#include <vector>

#include "geometry/bvh.h"

namespace phyxel {

/// Generalized winding number of a point: the solid angle under which it sees the surface, signed and divided by 4 pi.
/// 1 inside a closed outward surface and 0 outside, 2 where two bodies overlap, in between near a hole.
///
/// Jacobson et al., "Robust inside-outside segmentation using generalized winding numbers" (2013); the tree with its
/// far-field expansion is that of Barill et al., "Fast winding numbers for soups and clouds" (2018). With r = c - q
/// from the point q to the centre c of a far group of triangles, and d = X - c on the surface of normal n, a far group
/// adds the Taylor series of its integral of n.g(r + d), g(r) = r / |r|^3, up to second order in d:
///
///     4 pi w = A.r / |r|^3  +  tr(M) / |r|^3 - 3 r.M r / |r|^5  -  3/2 t.r / |r|^5 + 15/2 C(r) / |r|^7,
///
///     A = int n dA,  M = int n d^T dA,  t = int 2 (n.d) d + |d|^2 n dA,  C(r) = int (n.r) (d.r)^2 dA;
///
/// near triangles are exact. A group is far when |r| > far_ratio times its radius. Const and safe to call from many
/// threads; the value depends on the mesh and the point alone.
class WindingNumber {
public:
    /// Raising `far_ratio` (above 1) makes the sum more exact and slower; the error falls with its cube. The default
    /// keeps it below 0.003 on the tests' meshes: only points whose winding number is that close to 1/2 can be
    /// misjudged.
    explicit WindingNumber(const TriangleMesh& mesh, double far_ratio = 2.5);

    double operator()(const Vec3& point) const;

    /// The inside test: winding number above 1/2.
    bool inside(const Vec3& point) const { return (*this)(point) > 0.5; }

private:
    /// The form C(r), by its ten monomials.
    struct CubicForm {
        std::array<double, 10> coefficients{};  ///< of xxx yyy zzz xxy xxz yyx yyz zzx zzy xyz
        void add(const Vec3& n, const Vec3& d);
        double operator()(const Vec3& r) const;
    };
    struct Moments {
        Vec3 center;             ///< area-weighted centroid of the group
        double far_squared = 0;  ///< (far_ratio * radius)^2
        Vec3 A, t;
        Mat3 M;
        CubicForm C;
        std::uint32_t begin = 0, end = 0, right = 0;  ///< as in Bvh::Node
    };
    Moments moments_of(const Bvh::Node& node, double far_ratio) const;
    double far_field(const Moments& node, const Vec3& r, double r_squared) const;

    Vec3 origin_;  ///< the mesh is moved and scaled to size 1: no area under- or overflows
    double inverse_size_ = 1;
    std::vector<std::array<Vec3, 3>> triangles_;  ///< [triangles] corners, leaf by leaf
    std::vector<Moments> nodes_;                  ///< [nodes] of the tree, depth first
};

/// The same number by the exact sum over all triangles: the slow reference.
double exact_winding_number(const TriangleMesh& mesh, const Vec3& point);

}  // namespace phyxel
