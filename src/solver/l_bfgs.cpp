#include <algorithm>
#include <cmath>
#include <deque>

#include "solver/newton.h"
#include "solver/nodal_vectors.h"

namespace phyxel {
namespace {

constexpr std::size_t most_pairs = 5;
constexpr int most_tries = 8;                 ///< of shorter and shorter steps
constexpr int most_shortenings_in_a_row = 2;  ///< before Newton's method had better go on

struct Pair {
    std::vector<Vec3> step, change;  ///< of x and of the gradient
    double inverse_product = 0;      ///< 1 / (step . change)
};

}  // namespace

SolveReport l_bfgs(CoupledBodies& bodies, std::vector<Vec3>& x, const SolveTolerance& tolerance, int most) {
    const Threads& threads = bodies.threads;
    const std::size_t n = bodies.size();
    SolveReport report;
    std::deque<Pair> pairs;
    std::vector<Vec3> g(n), d(n), q(n), before(n);
    bodies.gradient(x, g);
    int shortened = 0;
    for (int k = 0; k < most; ++k) {
        // d = -H g by the two loops, the preconditioner between them.
        q = g;
        std::vector<double> alpha(pairs.size());
        for (std::size_t p = pairs.size(); p-- > 0;) {
            alpha[p] = pairs[p].inverse_product * inner(pairs[p].step, q, threads);
            add_scaled(q, -alpha[p], pairs[p].change, threads);
        }
        bodies.precondition(q, d);
        for (std::size_t p = 0; p < pairs.size(); ++p) {
            const double beta = pairs[p].inverse_product * inner(pairs[p].change, d, threads);
            add_scaled(d, alpha[p] - beta, pairs[p].step, threads);
        }
        const double decrease = inner(g, d, threads);
        report.residual = std::sqrt(inner(g, g, threads));
        const double distance = bodies.distance(g, d);
        if (!std::isfinite(decrease) || decrease < 0 || !std::isfinite(report.residual)) {
            report.trouble = "the search direction of the implicit step left the numbers";
            return report;
        }
        ++report.newton_iterations;

        // The last step is taken too: it costs no gradient more.
        threads.for_each(n, node_chunk, [&](std::size_t i) { d[i] = -d[i]; });
        add_scaled(x, 1.0, d, threads);
        if (distance <= tolerance.energy || report.residual <= tolerance.force) return report.converged = true, report;
        before = g;
        bodies.gradient(x, g);

        // Where the step overshot, the secant through both slopes says how far to go.
        double length = 1, ratio = inner(g, d, threads) / decrease;
        for (int s = 0; s < most_tries && (!std::isfinite(ratio) || ratio > 0.5); ++s) {
            const double shorter = length * (std::isfinite(ratio) ? std::clamp(1 / (1 + ratio), 0.05, 0.7) : 0.05);
            add_scaled(x, shorter - length, d, threads);
            length = shorter;
            bodies.gradient(x, g);
            ratio = inner(g, d, threads) / decrease;
        }
        shortened = length < 1 ? shortened + 1 : 0;
        if (!std::isfinite(ratio) || shortened > most_shortenings_in_a_row) {
            report.trouble = "the implicit step overshot again and again";
            return report;
        }
        threads.for_each(n, node_chunk, [&](std::size_t i) { d[i] *= length; });

        if (pairs.size() == most_pairs) pairs.pop_front();
        Pair pair{d, g, 0};
        add_scaled(pair.change, -1.0, before, threads);
        const double product = inner(pair.step, pair.change, threads);
        if (product > 0) {
            pair.inverse_product = 1 / product;
            pairs.push_back(std::move(pair));
        }
    }
    report.trouble = "the implicit step did not converge in " + std::to_string(most) + " iterations";
    return report;
}

}  // namespace phyxel
