#include "bench_registry.h"

namespace phyxel::cli {

const std::vector<Bench>& benches() {
    static const std::vector<Bench> all = {};
    return all;
}

}  // namespace phyxel::cli
