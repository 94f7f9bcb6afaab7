#pragma once

#include <cmath>
#include <filesystem>
#include <span>
#include <string_view>
#include <type_traits>

#include "phyxel/vector.h"

namespace phyxel {

/// Throws the error of `require_finite`.
[[noreturn]] void refuse_value(const std::filesystem::path& path, std::string_view what, std::size_t index);

/// No file may hold a NaN or an infinity: throws an `Error` that names the file, `what` and the index of the first such
/// value. Integers pass.
template <class T>
void require_finite(const std::filesystem::path& path, std::string_view what, std::span<const T> values) {
    if constexpr (!std::is_integral_v<T>)
        for (std::size_t i = 0; i < values.size(); ++i)
            if (!std::isfinite(values[i])) refuse_value(path, what, i);
}
template <class T>
void require_finite(const std::filesystem::path& path, std::string_view what, std::span<const Vec3T<T>> vectors) {
    for (std::size_t i = 0; i < vectors.size(); ++i)
        if (!is_finite(vectors[i])) refuse_value(path, what, i);
}

}  // namespace phyxel
