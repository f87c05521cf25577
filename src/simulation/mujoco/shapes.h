// Adds shapes to MuJoCo's description of a scene.
#pragma once

#include <string>

#include "models/object_model.h"
#include "models/urdf.h"
#include "simulation/mujoco/library.h"

namespace predictor {

void SetVector(double* to, const Vector3& from);
void SetPose(double* pos, double* quat, const Pose& X);

// Gives a body this mass, centre of mass and inertia.
void SetInertia(mjsBody* body, const ObjectModel& model);

// The floor and the table collide with the object. The object does not collide with itself.
void SetContact(mjsGeom* geom, bool surroundings, double friction);

// Adds a shape to a body. For collisions, a mesh is replaced by its convex hull. `name` is the name
// of the shape and of its mesh, and `key` is the scenario's key, which error messages state. Throws
// InputError.
mjsGeom* AddShape(mjSpec* spec, mjsBody* body, const ModelShape& shape, const std::string& name,
                  const std::string& key);

// Call this after the engine has rejected the whole model. Throws InputError if the engine also
// rejects this mesh alone.
void CheckMesh(const ModelShape& shape, const std::string& key);

}  // namespace predictor
