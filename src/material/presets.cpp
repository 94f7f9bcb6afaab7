#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "phyxel/error.h"
#include "phyxel/material.h"

namespace phyxel {
namespace {

/// Everyday materials at room temperature, at small strain. All are isotropic here. Ratios of nearly incompressible
/// materials stop at 0.49: closer to one half costs time steps and resolution and changes nothing that one sees.
constexpr std::array table = {
    Preset{"jelly",
           {.density = 1020, .youngs_modulus = 2.0e4, .poissons_ratio = 0.45},
           "gelatin gel, in the order of the tissue-mimicking gels of Hall et al., IEEE Trans. Ultrason. Ferroelectr. "
           "Freq. "
           "Control 44 (1997) 1355 and Farrer et al., J. Ther. Ultrasound 3 (2015) 9; ratio lowered from nearly 0.5"},
    Preset{"rubber",
           {.density = 930, .youngs_modulus = 2.0e6, .poissons_ratio = 0.49},
           "natural rubber, unfilled: Ashby, Materials Selection in Mechanical Design, appendix on material properties "
           "(1.5 to 2.5 MPa, 920 to 930 kg/m^3); ratio lowered from 0.499. Stegmayr 2008, chapter 5 prints 1e11 Pa"},
    Preset{
        "soft tissue",
        {.density = 1060, .youngs_modulus = 5.0e3, .poissons_ratio = 0.48},
        "healthy liver: Castera et al., Gastroenterology 128 (2005) 343 (transient elastography, up to about 7 kPa); "
        "density: Duck, Physical Properties of Tissue (1990); ratio lowered from nearly 0.5"},
    Preset{"wood",
           {.density = 540, .youngs_modulus = 1.34e10, .poissons_ratio = 0.37},
           "coast Douglas-fir at 12 % moisture: Wood Handbook, USDA FPL-GTR-190 (2010), chapter 5. Modulus along the "
           "grain, ratio the mean of LR 0.292 and LT 0.449; across the grain real wood has 5 to 7 % of that modulus, "
           "which an isotropic material cannot show"},
    Preset{"steel",
           {.density = 7850, .youngs_modulus = 2.1e11, .poissons_ratio = 0.3},
           "structural steel: EN 1993-1-1, 3.2.6; density: EN 1991-1-1, annex A (77.0 to 78.5 kN/m^3)"},
    Preset{"concrete",
           {.density = 2400, .youngs_modulus = 3.1e10, .poissons_ratio = 0.2},
           "C25/30: EN 1992-1-1, table 3.1 (E_cm) and 3.1.3 (uncracked); density: EN 1991-1-1, annex A (24 kN/m^3)"},
    Preset{"glass",
           {.density = 2500, .youngs_modulus = 7.0e10, .poissons_ratio = 0.2},
           "soda-lime float glass: EN 572-1, general physical and mechanical properties"},
    Preset{"clay",
           {.density = 1800, .youngs_modulus = 1.0e7, .poissons_ratio = 0.45},
           "soft saturated clay: Bowles, Foundation Analysis and Design, 5th edition, tables 2-7 and 2-8 (5 to 25 MPa, "
           "ratio 0.4 to 0.5)"},
};

/// Insertions, deletions and replacements that turn `a` into `b` (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
        }
    }
    return row.back();
}

std::string list_of_names() {
    std::string names;
    for (const Preset& preset : table) names += (names.empty() ? "" : ", ") + std::string(preset.name);
    return names;
}

}  // namespace

std::span<const Preset> presets() { return table; }

const Preset& find_preset(std::string_view name) {
    const auto match = std::find_if(table.begin(), table.end(), [&](const Preset& p) { return p.name == name; });
    if (match != table.end()) return *match;
    const auto nearest = std::min_element(table.begin(), table.end(), [&](const Preset& a, const Preset& b) {
        return edit_distance(name, a.name) < edit_distance(name, b.name);
    });
    throw Error("material preset \"" + std::string(name) + "\" does not exist; did you mean \"" +
                std::string(nearest->name) + "\"? The presets are " + list_of_names() + ".");
}

}  // namespace phyxel
