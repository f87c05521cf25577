// Bodies of simple shape, and the movable objects of the surroundings.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"

namespace predictor {

enum class Shape { kBox, kCylinder, kSphere };

// An object defined in the scenario itself, of uniform density unless an inertia is given.
struct PrimitiveSpec {
  Shape shape = Shape::kBox;
  // The dimensions are x, y and z for a box, radius and length for a cylinder, and the radius for a
  // sphere [m].
  Vector3 size = {0.1, 0.1, 0.1};
  double mass = 1;                           // [kg]
  Vector3 center_of_mass = Vector3::Zero();  // centre of mass in O [m]
  std::optional<Vector3> inertia;  // principal moments about the centre of mass, axes of O [kg·m²]
};

// An entry of environment.objects: a body that others can push and that nothing holds at the start.
struct MovableSpec {
  std::string name;   // by which events and messages refer to it
  std::string model;  // URDF; empty: the primitive
  std::optional<PrimitiveSpec> primitive;
  // Pose of the object's frame in W at the start [m], [rad].
  Vector3 xyz = Vector3::Zero();
  Vector3 rpy = Vector3::Zero();
  // The coefficient of sliding friction of the object's contacts. If the other body also has a
  // friction coefficient, the lower of the two coefficients applies. If this coefficient is absent,
  // the coefficient of the other body applies. If both are absent, environment.friction applies.
  std::optional<double> friction;
  std::vector<std::string> touches = {"object"};  // that collide with it: object, cobot
  Vector3 color = {0.35, 0.55, 0.75};             // red, green, blue; of a primitive

  Pose X_WM() const { return PoseFromXyzRpy(xyz, rpy); }  // NOLINT(readability-identifier-naming)
  bool Touches(const char* what) const {
    return std::find(touches.begin(), touches.end(), what) != touches.end();
  }
};

}  // namespace predictor
