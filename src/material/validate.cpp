#include <cmath>
#include <sstream>
#include <string>

#include "phyxel/error.h"
#include "phyxel/material.h"

namespace phyxel {
namespace {

[[noreturn]] void refuse(const std::string& field, double found, const std::string& expected) {
    std::ostringstream message;
    message.precision(12);
    message << "material: " << field << " is " << found << ", but must be " << expected;
    throw Error(message.str());
}

}  // namespace

void validate(const Material& m) {
    if (!(m.density >= smallest_density && m.density <= largest_density))
        refuse("density", m.density, "a positive number of kg/m^3, 1e-6 to 1e9 (water has 1000)");
    if (!(m.youngs_modulus >= smallest_modulus && m.youngs_modulus <= largest_modulus))
        refuse("youngs_modulus", m.youngs_modulus,
               "a positive number of Pa, 1e-6 to 1e15 (jelly has 2e4, steel 2.1e11)");
    if (!(m.poissons_ratio > -1 && m.poissons_ratio < 0.5))
        refuse("poissons_ratio", m.poissons_ratio,
               "above -1 and below 0.5; use 0.45 to 0.49 for a material that keeps its volume");
    if (!(std::isfinite(m.volume_stiffness) && m.volume_stiffness >= 0))
        refuse("volume_stiffness", m.volume_stiffness, "zero or a positive number of Pa");
    if (m.volume_stiffness != 0 && m.law != Law::saint_venant_kirchhoff)
        refuse("volume_stiffness", m.volume_stiffness,
               "zero unless the law is saint-venant-kirchhoff; leave it out or choose that law");
}

}  // namespace phyxel
