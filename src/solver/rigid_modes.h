#pragma once

#define EIGEN_MPL2_ONLY
#include <Eigen/Cholesky>
#include <span>
#include <vector>

#include "base/threads.h"
#include "phyxel/vector.h"

namespace phyxel {

/// The rigid motions Z of bodies that touch, as a coarse space. A preconditioner that knows each body alone takes what
/// it touches for fixed, so that bodies moving together look as stiff as their contact. With A the sum of inertia and
/// contact, which is all that resists a rigid motion, and E = Z^T A Z,
///     V = Z E^-1 Z^T + (1 - Z E^-1 (A Z)^T) B (1 - A Z E^-1 Z^T)
/// solves for the rigid motions exactly and leaves the rest to B (balancing, Mandel 1993).
class RigidModes {
public:
    struct Body {
        std::size_t first;             ///< node, in vectors over all bodies
        std::span<const Vec3> x;       ///< positions now
        std::span<const double> mass;  ///< [kg]
        double inertia;                ///< c of c M [1/s^2]
    };

    /// `contact(d, out)` adds the stiffness of all contact applied to d to out. Bodies that are held have no rigid
    /// motions and are not to be given.
    template <class Contact>
    void build(std::span<const Body> bodies, std::size_t nodes, Contact&& contact) {
        clear();
        std::vector<Vec3> d(nodes), out(nodes);
        for (const Body& body : bodies)
            for (std::size_t kind = 0; kind < 6; ++kind) {
                Mode mode = make_mode(body, kind);
                std::fill(d.begin(), d.end(), Vec3{});
                std::fill(out.begin(), out.end(), Vec3{});
                std::copy(mode.way.begin(), mode.way.end(), d.begin() + static_cast<std::ptrdiff_t>(body.first));
                contact(d, out);
                add_resistance(body, out, mode);
                modes_.push_back(std::move(mode));
            }
        factorize();
    }
    void clear() { modes_.clear(); }
    bool empty() const { return modes_.empty(); }

    /// Coefficients of the rigid motions that balance r, which becomes what they leave.
    Eigen::VectorXd take(std::vector<Vec3>& r) const;
    /// Adds to z, made from what `take` left, the motions `taken` less what z itself has of them.
    void add(const Eigen::VectorXd& taken, std::vector<Vec3>& z) const;

private:
    struct Entry {
        std::uint32_t node;
        Vec3 force;
    };
    struct Mode {
        std::size_t first;
        std::vector<Vec3> way;          ///< [nodes of the body] Z
        std::vector<Entry> resistance;  ///< A Z, where it is not zero
    };
    static Mode make_mode(const Body& body, std::size_t kind);
    static void add_resistance(const Body& body, std::span<const Vec3> contact, Mode& mode);
    void factorize();

    std::vector<Mode> modes_;
    Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace phyxel
