#include "bench_registry.h"

namespace phyxel::cli {

const std::vector<Bench>& benches() {
    static const std::vector<Bench> all = {
        {"table-5.1", "steps a second on the bodies of the 2008 thesis", bench::run_table_5_1},
        {"cantilever", "error, first swing, time and memory of implicit steps", bench::run_cantilever},
        {"setup", "time and memory from a mesh to the first step", bench::run_setup},
        {"kernel", "forces of many cells at a time against double precision and the core's peak", bench::run_kernel},
        {"solver", "linear systems of implicit steps by multigrid and by block Jacobi", bench::run_solver},
    };
    return all;
}

}  // namespace phyxel::cli
