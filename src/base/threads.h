#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace phyxel {

/// Parallel loops whose result does not depend on the number of threads: work is cut into chunks of a size that the
/// caller fixes, and sums add one partial per chunk, in order. All threading of the library goes through here.
class Threads {
public:
    using Task = std::function<void(std::size_t)>;
    using ParallelFor = std::function<void(std::size_t count, const Task& task)>;

    /// A pool of `count` threads; 0: as many as the machine has.
    explicit Threads(int count = 0);
    /// The caller's own task system.
    explicit Threads(ParallelFor parallel_for);
    ~Threads();
    Threads(Threads&&) noexcept;
    Threads& operator=(Threads&&) noexcept;

    int count() const { return count_; }

    /// Runs `body(begin, end)` over [0, n) in chunks of `chunk`.
    template <class Body>
    void for_chunks(std::size_t n, std::size_t chunk, Body&& body) const {
        const std::size_t chunks = (n + chunk - 1) / chunk;
        run(chunks, [&](std::size_t c) { body(c * chunk, c * chunk + chunk < n ? c * chunk + chunk : n); });
    }

    /// Runs `body(i)` for every i in [0, n), `chunk` at a time.
    template <class Body>
    void for_each(std::size_t n, std::size_t chunk, Body&& body) const {
        for_chunks(n, chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) body(i);
        });
    }

    /// Sum of `term(i)` over [0, n): chunks are summed each by itself, then added in order.
    template <class Value = double, class Term>
    Value sum(std::size_t n, std::size_t chunk, Term&& term) const {
        std::vector<Value> partial((n + chunk - 1) / chunk);
        for_chunks(n, chunk, [&](std::size_t begin, std::size_t end) {
            Value s{};
            for (std::size_t i = begin; i < end; ++i) s += term(i);
            partial[begin / chunk] = s;
        });
        Value total{};
        for (const Value& p : partial) total += p;
        return total;
    }

private:
    void run(std::size_t tasks, const Task& task) const;

    struct Pool;
    std::unique_ptr<Pool> pool_;
    ParallelFor parallel_for_;
    int count_ = 1;
};

}  // namespace phyxel
