// Measures the convex hulls that collide instead of meshes.
#pragma once

#include <string>

#include "models/urdf.h"

namespace predictor {

// Returns the volume of the convex hull of a mesh shape, divided by the volume that the mesh
// encloses. A few missing triangles hardly change this volume. Returns 1 if the triangles do not
// have a common orientation, so that the volume is unknown, and for shapes that are no meshes.
// `key` is the key of the scenario that error messages name. Throws InputError if the mesh cannot
// be read. Not for the tick.
double HullExcess(const ModelShape& shape, const std::string& key);

}  // namespace predictor
