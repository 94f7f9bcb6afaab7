#pragma once

#include "phyxel/vector.h"

namespace phyxel {

/// Where a picture is taken from.
struct Camera {
    Vec3 eye{0, 0, 1};          ///< [m]
    Vec3 target{};              ///< [m] the middle of the picture
    Vec3 up{0, 1, 0};           ///< points up in the picture
    double field_of_view = 28;  ///< vertical [degrees]

    Vec3 backward() const { return normalized(eye - target); }
    double distance() const { return norm(eye - target); }
    /// Tangent of half the vertical angle of view.
    double tangent() const;
    /// Half the height of what is seen at the target's distance [m]; the measure of everything that is only decoration.
    double half_height() const { return distance() * tangent(); }
};

/// How a fitted camera looks at things.
struct ViewDirection {
    double azimuth = 35;    ///< [degrees] about the vertical, from the front
    double elevation = 18;  ///< [degrees] above the horizon
    double margin = 1.2;    ///< size of the picture over size of what must be seen
};

/// Two horizontal directions that make a right-handed frame with `up`: for up = y they are z (the front) and x.
struct HorizontalFrame {
    Vec3 front, side, up;
};
HorizontalFrame horizontal_frame(const Vec3& up);

/// The unit direction at `azimuth` and `elevation` [degrees].
Vec3 direction_at(const HorizontalFrame& frame, double azimuth, double elevation);

/// The nearest camera in the given direction that sees the whole box [lower, upper], the box in the middle of the
/// picture; `aspect` is the picture's width over its height. A box of no extent is seen from 1 m.
Camera fit_camera(const Vec3& lower, const Vec3& upper, double aspect, const Vec3& up = {0, 1, 0},
                  const ViewDirection& direction = {});

}  // namespace phyxel
