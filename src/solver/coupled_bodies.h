#pragma once

#include "contact/body_contact.h"
#include "solver/incremental_potential.h"
#include "solver/rigid_modes.h"
#include "solver/warped_preconditioner.h"

namespace phyxel {

/// Bodies whose implicit steps are found together because they touch, or one alone: the sum of their potentials and of
/// the contact between them, over the node positions of all, one body after the other.
class CoupledBodies {
public:
    struct Part {
        IncrementalPotential* potential;
        WarpedPreconditioner* preconditioner;
        double way = 1;  ///< what distances to the solution are measured by
    };

    /// `contact` may be null.
    CoupledBodies(std::vector<Part> parts, const BodyContact* contact, const Threads& threads);

    std::size_t size() const { return offset_.back(); }
    /// The part of a vector over all nodes that belongs to one body.
    std::span<Vec3> of(std::size_t part, std::vector<Vec3>& all) const {
        return std::span(all).subspan(offset_[part], offset_[part + 1] - offset_[part]);
    }
    std::span<const Vec3> of(std::size_t part, const std::vector<Vec3>& all) const {
        return std::span(all).subspan(offset_[part], offset_[part + 1] - offset_[part]);
    }

    /// Writes the derivative by x; held components are 0.
    void gradient(const std::vector<Vec3>& x, std::vector<Vec3>& g);
    /// Writes the second derivative at x applied to d, held components 0.
    void action(const std::vector<Vec3>& x, const std::vector<Vec3>& d, std::vector<Vec3>& out);
    /// Moves held components to where their grips are at the end of the step.
    void place_held(std::vector<Vec3>& x) const;

    /// Turns the frames of the preconditioner with the bodies at x.
    void turn(const std::vector<Vec3>& x);
    /// Takes the stiffness of contact at x into the preconditioner, after `turn`. Whether there is any.
    bool support(const std::vector<Vec3>& x);
    /// z = V r, body by body, and together for the rigid motions of those that touch something.
    void precondition(const std::vector<Vec3>& r, std::vector<Vec3>& z);

    /// Distance to the solution over the way, of the body that is furthest: sqrt(|g . z|) with z = V g; NaN where that
    /// is no number or, for a body alone, negative.
    double distance(const std::vector<Vec3>& g, const std::vector<Vec3>& z) const;

    const Threads& threads;

private:
    void find_rigid_modes(const std::vector<Vec3>& x);
    void precondition_alone(const std::vector<Vec3>& r, std::vector<Vec3>& z);

    std::vector<Part> parts_;
    std::vector<std::size_t> offset_;  ///< [parts + 1] first node of each body
    const BodyContact* contact_;
    RigidModes modes_;
};

}  // namespace phyxel
