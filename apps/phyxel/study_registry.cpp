#include "study_registry.h"

namespace phyxel::cli {

const std::vector<Study>& all_studies() {
    using namespace studies;
    static const std::vector<Study> all = {
        {"accuracy", "figure 5: error of both beams against finite elements of the same size", run_accuracy},
        {"convergence", "figure 4: how solutions of finer and finer lattices draw together", run_convergence},
        {"locking", "figure 7: the bent beam with Poisson's ratio going to one half", run_locking},
        {"ghost-forces", "figure 2: linear against corotated strain under rotation", run_ghost_forces},
        {"rotation", "equation 11 against the rotation of the deformation gradient", run_rotation},
        {"timing", "figure 6: time to solve both beams", run_timing},
        {"two-materials", "figure 8: a cylinder, half stiff and half soft, held at its middle", run_two_materials},
        {"irregular-steps", "section 3.6: large and irregular implicit steps", run_irregular_steps},
        {"nodal-integration", "section 4.1: volumes from densities against volumes of the grid", run_nodal_integration},
        {"support", "section 5: how large neighbourhoods should be", run_support},
        {"torus-on-floor", "figure 9: a torus falls on a floor", run_torus_on_floor},
        {"pile", "figure 10: several bodies fall on each other", run_pile},
    };
    return all;
}

}  // namespace phyxel::cli
