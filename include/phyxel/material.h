#pragma once

#include <span>
#include <string_view>

namespace phyxel {

/// The constitutive laws; each has the same small-strain moduli. Formulas: docs/stages/material.md.
enum class Law {
    linear,                  ///< small strain; turns rotation into growth, for comparison only
    saint_venant_kirchhoff,  ///< Hooke's law with Green strain (Stegmayr 2008); collapses under strong compression
    corotated,               ///< Hooke's law in the rotated frame (Brunet et al. 2019)
    neo_hookean,             ///< stable neo-Hookean: the default for soft and breaking bodies
};

/// What a material may have: far more than any real one, and still within what double precision can work with.
inline constexpr double smallest_density = 1e-6, largest_density = 1e9;   ///< [kg/m^3]
inline constexpr double smallest_modulus = 1e-6, largest_modulus = 1e15;  ///< [Pa]

/// An isotropic elastic material.
struct Material {
    double density = 0;  ///< rest density [kg/m^3], 1e-6 to 1e9; raising it makes the body heavier and slower
    double youngs_modulus =
        0;  ///< stiffness [Pa], 1e-6 to 1e15; raising it makes the body stiffer and explicit steps shorter
    double poissons_ratio = 0;  ///< -1 < nu < 0.5; raising it makes the body keep its volume
    Law law = Law::neo_hookean;
    double volume_stiffness =
        0;  ///< k_v [Pa] >= 0, Saint Venant-Kirchhoff only: penalizes change of volume (Stegmayr 2008, 3.60)

    friend bool operator==(const Material&, const Material&) = default;
};

/// The same material under a given law: `neo_hookean({.density = 1000, .youngs_modulus = 2e5, .poissons_ratio =
/// 0.45})`.
inline Material with_law(Material material, Law law) { return material.law = law, material; }
inline Material linear(const Material& material) { return with_law(material, Law::linear); }
inline Material saint_venant_kirchhoff(const Material& material) {
    return with_law(material, Law::saint_venant_kirchhoff);
}
inline Material corotated(const Material& material) { return with_law(material, Law::corotated); }
inline Material neo_hookean(const Material& material) { return with_law(material, Law::neo_hookean); }

/// A named material with the source of its numbers.
struct Preset {
    std::string_view name;  ///< "jelly", "rubber", "soft tissue", "wood", "steel", "concrete", "glass", "clay"
    Material material;
    std::string_view source;  ///< where the numbers come from
};

std::span<const Preset> presets();

/// The preset of that name. Throws `Error` listing the names, with the nearest one, when there is none.
const Preset& find_preset(std::string_view name);

/// Throws `Error` naming the field, its value and its range unless the material can be used.
void validate(const Material& material);

}  // namespace phyxel
