// A sum without care for threads, inside a parallel loop: the thread sanitizer must report it. Built by
// scripts/run_tests.py; that it finds this race is what makes its silence about the library mean something.
#include <chrono>
#include <thread>

#include "base/threads.h"

int main() {
    double sum = 0;
    phyxel::Threads(4).for_each(400, 1, [&](std::size_t i) {
        sum += static_cast<double>(i);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));  // lets every thread get a share
    });
    return sum > 0 ? 0 : 1;
}
