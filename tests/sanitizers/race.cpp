// A sum without care for threads, inside a parallel loop: the thread sanitizer must report it. Built by
// scripts/run_tests.py; that it finds this race is what makes its silence about the library mean something.
#include "base/threads.h"

int main() {
    double sum = 0;
    phyxel::Threads(4).for_each(100000, 64, [&](std::size_t i) { sum += static_cast<double>(i); });
    return sum > 0 ? 0 : 1;
}
