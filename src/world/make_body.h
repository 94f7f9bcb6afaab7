#pragma once

#include <optional>

#include "world/parts.h"

namespace phyxel {

/// Initial speeds above that of light [m/s] are mistakes.
inline constexpr double fastest = 299792458;

/// Throws `Error` naming the field unless `settings` can make a body.
void validate(const BodySettings& settings);

/// The mesh where `settings` place it: scaled, turned, shifted. Rest space.
TriangleMesh placed(const TriangleMesh& mesh, const BodySettings& settings);

/// Makes a body from a mesh, and notes warnings. Throws `Error` when the mesh is refused or the settings do not fit it.
std::unique_ptr<DynamicBody> make_body(const TriangleMesh& mesh, const BodySettings& settings, World::Parts& parts,
                                       MeshReport& mesh_report);

/// Estimates the stable step of a body at rest. Throws `Error` when it is so short that no run would ever end.
void find_rest_step(DynamicBody& body, const World::Parts& parts);

/// Makes the contact samples of a body that has none yet. When that is makes no difference to them.
void make_contact(DynamicBody& body, const World::Parts& parts);

/// Makes contact, if there are samples, as stiff as the world's integrator has it.
void prepare_contact(DynamicBody& body, const World::Parts& parts);

/// The cell of a point in rest space that lies inside of the body, to 1e-6 of its size; nothing for a point outside.
std::optional<std::uint32_t> find_cell_of_point(const DynamicBody& body, const Vec3& rest_point);

}  // namespace phyxel
