#pragma once

/// Phyxel: soft and breakable solids from bare surface meshes. This header brings the whole public interface.

#include "phyxel/body.h"
#include "phyxel/error.h"
#include "phyxel/material.h"
#include "phyxel/mesh.h"
#include "phyxel/solver.h"
#include "phyxel/vector.h"
#include "phyxel/version.h"
#include "phyxel/world.h"
