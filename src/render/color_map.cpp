#include "render/color_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace phyxel {
namespace {

/// Viridis at t = 0, 1/16, ..., 1. Straight lines between them stay within 0.01 of the full table of 256.
constexpr std::array<Vec3f, 17> viridis = {{
    {0.267004f, 0.004874f, 0.329415f},
    {0.282327f, 0.094955f, 0.417331f},
    {0.278826f, 0.175490f, 0.483397f},
    {0.258965f, 0.251537f, 0.524736f},
    {0.229739f, 0.322361f, 0.545706f},
    {0.199430f, 0.387607f, 0.554642f},
    {0.172719f, 0.448791f, 0.557885f},
    {0.149039f, 0.508051f, 0.557250f},
    {0.127568f, 0.566949f, 0.550556f},
    {0.120638f, 0.625828f, 0.533488f},
    {0.157851f, 0.683765f, 0.501686f},
    {0.246070f, 0.738910f, 0.452024f},
    {0.369214f, 0.788888f, 0.382914f},
    {0.515992f, 0.831158f, 0.294279f},
    {0.678489f, 0.863742f, 0.189503f},
    {0.845561f, 0.887322f, 0.099702f},
    {0.993248f, 0.906157f, 0.143936f},
}};

}  // namespace

Vec3f color_map(double t) {
    if (std::isnan(t)) return {0.5f, 0.5f, 0.5f};
    const double place = std::clamp(t, 0.0, 1.0) * static_cast<double>(viridis.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(place), viridis.size() - 2);
    const float s = static_cast<float>(place - static_cast<double>(i));
    return (1 - s) * viridis[i] + s * viridis[i + 1];
}

}  // namespace phyxel
