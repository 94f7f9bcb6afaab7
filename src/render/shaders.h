#pragma once

#include <string>

namespace phyxel {

/// The GLSL programs of the renderer. All light is linear until the sRGB framebuffer stores it.
namespace shaders {

std::string depth_vertex();    ///< casters, seen in parallel; `to_clip`, `to_world`
std::string depth_fragment();  ///< nothing but depth
std::string square_vertex();   ///< the unit square anywhere in the picture; `center`, `half_size` in clip space
std::string backdrop_fragment();
std::string overlay_fragment();  ///< `image`, colour multiplied by opacity
std::string contact_fragment();  ///< how much of the sky a point of the floor does not see
std::string surface_vertex();    ///< `to_clip`, `to_world`
std::string surface_fragment();
std::string floor_fragment();

}  // namespace shaders
}  // namespace phyxel
