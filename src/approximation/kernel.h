#pragma once

#include "phyxel/body.h"

namespace phyxel {

/// Weight w(s) of a node at distance s h from a point, and its derivative dw/ds. All are 1 at s = 0 (the scale of a
/// weight cancels in moving least squares) and 0 from s = 1 on.
///   quartic spline  1 - 6 s^2 + 8 s^3 - 3 s^4                     (Brunet et al. 2019)
///   poly6           (1 - s^2)^3                                   (Stegmayr 2008, 3.25; Mueller et al. 2003)
///   cubic spline    1 - 6 s^2 + 6 s^3 (s <= 1/2), 2 (1 - s)^3     (Monaghan & Lattanzio 1985, support 1)
///   Wendland C2     (1 - s)^4 (4 s + 1)                           (Wendland 1995)
constexpr double weight(KernelShape shape, double s) {
    if (s >= 1) return 0;
    const double t = 1 - s;
    switch (shape) {
        case KernelShape::quartic_spline:
            return 1 + s * s * (-6 + s * (8 - 3 * s));
        case KernelShape::poly6:
            return (1 - s * s) * (1 - s * s) * (1 - s * s);
        case KernelShape::cubic_spline:
            return s <= 0.5 ? 1 + 6 * s * s * (s - 1) : 2 * t * t * t;
        case KernelShape::wendland:
            return t * t * t * t * (4 * s + 1);
    }
    return 0;
}

constexpr double weight_derivative(KernelShape shape, double s) {
    if (s >= 1) return 0;
    const double t = 1 - s;
    switch (shape) {
        case KernelShape::quartic_spline:
            return s * (-12 + s * (24 - 12 * s));
        case KernelShape::poly6:
            return -6 * s * (1 - s * s) * (1 - s * s);
        case KernelShape::cubic_spline:
            return s <= 0.5 ? s * (18 * s - 12) : -6 * t * t;
        case KernelShape::wendland:
            return -20 * s * t * t * t;
    }
    return 0;
}

}  // namespace phyxel
