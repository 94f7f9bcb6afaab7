#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace phyxel {

/// Work space that is costly to make and useful again: tasks borrow an object and give it back. Which one a task gets
/// is left to chance, so an object must not remember anything that shows.
template <class T>
class ScratchPool {
public:
    explicit ScratchPool(std::function<std::unique_ptr<T>()> make) : make_(std::move(make)) {}

    /// Calls `use(object)` with an object of this task's own.
    template <class Use>
    void with(Use&& use) {
        std::unique_ptr<T> object;
        {
            std::lock_guard lock(mutex_);
            if (!idle_.empty()) object = std::move(idle_.back()), idle_.pop_back();
        }
        if (!object) object = make_();
        use(*object);
        std::lock_guard lock(mutex_);
        idle_.push_back(std::move(object));
    }

private:
    std::function<std::unique_ptr<T>()> make_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<T>> idle_;
};

}  // namespace phyxel
