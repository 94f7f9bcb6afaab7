#include "geometry/refined_mesh.h"

#include <algorithm>
#include <map>
#include <utility>

#include "geometry/closest_point.h"

namespace phyxel {
namespace {

/// The middles of the edges that are too long, by their ends.
std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> add_middles(TriangleMesh& mesh, double longest) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto ends = std::minmax(t[c], t[(c + 1) % 3]);
            const Vec3 a = mesh.vertices[ends.first], b = mesh.vertices[ends.second];
            if (!(norm(b - a) > longest)) continue;
            if (middles.emplace(ends, static_cast<std::uint32_t>(mesh.vertices.size())).second)
                mesh.vertices.push_back(0.5 * (a + b));
        }
    return middles;
}

}  // namespace

TriangleMesh refined(TriangleMesh mesh, double longest) {
    mesh.parts.clear();
    for (;;) {
        const auto middles = add_middles(mesh, longest);
        if (middles.empty()) return mesh;
        std::vector<Triangle> pieces;
        for (const Triangle& t : mesh.triangles) {
            std::array<std::uint32_t, 3> middle;
            int halved = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const auto found = middles.find(std::minmax(t[c], t[(c + 1) % 3]));
                middle[c] = found == middles.end() ? no_triangle : found->second;
                halved += middle[c] != no_triangle;
            }
            if (halved == 3) {
                pieces.push_back({t[0], middle[0], middle[2]});
                pieces.push_back({t[1], middle[1], middle[0]});
                pieces.push_back({t[2], middle[2], middle[1]});
                pieces.push_back(middle);
                continue;
            }
            // The corner is first that stands between the two halved edges, or before the only one.
            std::size_t first = 0;
            while (halved > 0 &&
                   !(middle[first] != no_triangle && (halved == 1 || middle[(first + 2) % 3] != no_triangle)))
                ++first;
            const std::uint32_t a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3];
            if (halved == 0) {
                pieces.push_back(t);
            } else if (halved == 1) {
                pieces.push_back({a, middle[first], c});
                pieces.push_back({middle[first], b, c});
            } else {
                const std::uint32_t after = middle[first], before = middle[(first + 2) % 3];
                pieces.push_back({a, after, before});
                // The rest is cut along its shorter diagonal.
                const auto length = [&](std::uint32_t i, std::uint32_t j) {
                    return norm_squared(mesh.vertices[i] - mesh.vertices[j]);
                };
                if (length(after, c) < length(before, b)) {
                    pieces.push_back({after, b, c});
                    pieces.push_back({after, c, before});
                } else {
                    pieces.push_back({after, b, before});
                    pieces.push_back({before, b, c});
                }
            }
        }
        mesh.triangles = std::move(pieces);
    }
}

}  // namespace phyxel
