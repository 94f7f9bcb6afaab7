#include <fmt/format.h>

#include <cmath>

#include "studies/beam.h"
#include "studies/results.h"

/// Brunet et al. 2019, figure 5: deflection of the bent and of the stretched beam against the number of nodes, of the
/// meshless method with its default settings and of finite elements with as many nodes.

namespace phyxel::studies {
namespace {

using fem::ElementType;

/// One size of the meshless beam, with what is asked of it [%].
struct Size {
    std::size_t cells;
    double bending, stretching;
};
constexpr Size sizes[] = {{2, 0.8, 0.6}, {3, 0.4, 0.45}, {4, 0.25, 0.2}, {6, 0.15, 0.15}};

class Accuracy {
public:
    explicit Accuracy(const Options& options)
        : options_(options),
          results_("accuracy", {"load", "method", "nodes", "tip [mm]", "error [%]", "sideways [mm]", "iterations"},
                   options) {}

    int run() {
        for (const Vec3& force : {bending, stretching}) {
            for (const Size& size : sizes) {
                if (options_.small && size.cells > 3) break;
                const BeamResult beam = meshless_beam(beam_settings(size.cells), force, options_.threads);
                const double error = add(force, "meshless", beam);
                results_.note(beam.hash);
                const std::string what = fmt::format("{} {} nodes, meshless", is_bending(force), beam.nodes);
                results_.expect_at_most(what + ", error [%]", error, force.z > 0 ? size.stretching : size.bending);
                results_.expect_at_most(what + ", sideways drift [mm]", std::abs(beam.tip.x), 1e-6);
                results_.expect_at_most(what + ", Newton iterations", double(beam.iterations), 7);
                if (size.cells == 4) meshless_ = error;
            }
            const double hexahedra = elements(force, "8-node hexahedra", ElementType::hexahedra_8);
            elements(force, "27-node hexahedra", ElementType::hexahedra_27);
            const double tetrahedra = elements(force, "tetrahedra", ElementType::tetrahedra);
            if (options_.small || force.z > 0) continue;
            results_.expect_at_least("bending, 1025 nodes, error of hexahedra over meshless", hexahedra / meshless_,
                                     20);
            results_.expect_at_least("bending, 1025 nodes, error of tetrahedra over meshless", tetrahedra / meshless_,
                                     100);
        }
        return results_.finish();
    }

private:
    const Options& options_;
    Results results_;
    double meshless_ = 0;  ///< error at 1025 nodes

    static const char* is_bending(const Vec3& force) { return force.z > 0 ? "stretching" : "bending"; }

    /// Returns the error's amount [%].
    double add(const Vec3& force, const std::string& method, const BeamResult& beam) {
        const double error = 100 * tip_error(beam, force);
        results_.add_row({is_bending(force), method, double(beam.nodes), force.z > 0 ? beam.tip.z : beam.tip.y, error,
                          beam.tip.x, double(beam.iterations)});
        results_.expect(fmt::format("{} {} nodes, {}: converged", is_bending(force), beam.nodes, method),
                        beam.converged);
        return std::abs(error);
    }

    /// Returns the error's amount at 1025 nodes [%].
    double elements(const Vec3& force, const std::string& method, ElementType type) {
        double at_1025 = 0;
        for (const Size& size : sizes) {
            if (options_.small && size.cells > 2) break;
            if (type == ElementType::hexahedra_27 && size.cells % 2 == 1) continue;
            const double error = add(force, method, element_beam(type, size.cells, force));
            if (size.cells == 4) at_1025 = error;
        }
        return at_1025;
    }
};

}  // namespace

int run_accuracy(const Options& options) { return Accuracy(options).run(); }

}  // namespace phyxel::studies
