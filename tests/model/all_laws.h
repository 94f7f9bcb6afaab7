#pragma once

#include <string>
#include <utility>
#include <vector>

#include "phyxel/material.h"

namespace phyxel {

/// Every law with its name for messages, and those again that treat a ratio near one half in a way of their own.
inline std::vector<std::pair<std::string, Material>> all_laws() {
    const Material soft = {.density = 1000, .youngs_modulus = 1e6, .poissons_ratio = 0.3, .law = Law::linear};
    Material volume = saint_venant_kirchhoff(soft), nearly_incompressible = soft;
    volume.volume_stiffness = 2e6;
    nearly_incompressible.poissons_ratio = 0.49;
    return {{"linear", soft},
            {"saint venant-kirchhoff", saint_venant_kirchhoff(soft)},
            {"saint venant-kirchhoff with volume force", volume},
            {"corotated", corotated(soft)},
            {"neo-hookean", neo_hookean(soft)},
            {"corotated, nearly incompressible", corotated(nearly_incompressible)},
            {"neo-hookean, nearly incompressible", neo_hookean(nearly_incompressible)}};
}

}  // namespace phyxel
