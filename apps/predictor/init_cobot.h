// The cobot of the scenario that `init` writes: the part of the URDF to use, and the cobot's base
// and posture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

inline constexpr const char* kPandaUrdf =
    "package://example-robot-data/robots/panda_description/urdf/panda.urdf";

// The object, which the cobot holds from above at the centre of the object's upper face.
struct InitObject {
  PrimitiveSpec primitive;
  double half_height = 0;  // [m]
};

// A cobot as in the scenario, and the pose of its end-effector.
struct InitCobot {
  std::string model, end_effector;
  std::vector<std::string> remove_links;
  double removed_mass = 0;               // mass of these links [kg]
  std::vector<double> posture;           // [rad] or [m]
  Pose X_WE = {};                        // in that posture
  double base_height = 0;                // of the cobot above the floor [m]
  Vector3 attachment = Vector3::Zero();  // where the object is attached, in E [m]
  double tilt = 0;                       // of the last link from straight down [rad]

  // Returns the position of the object's centre in W [m].
  Vector3 ObjectAt(const InitObject& object) const;
};

InitCobot PandaCobot();

// Returns the robot of a URDF in postures in which it can carry the object, beginning with the most
// suitable posture. Returns nothing if no posture was found. The last link leans by `tilt` from
// straight down [rad]. The object is on the outer side of the last link, clear of the other links
// and of the floor. If the robot is too small to hold the object clear of the floor, the robot's
// base stands higher. The result is the same in each call. `urdf` is a path or package://... URL of
// a file in a folder from which the scenario may read. For `end_effector`, see FindArm. Throws
// InputError.
std::vector<InitCobot> OwnCobots(const std::string& urdf, const std::string& end_effector,
                                 const std::filesystem::path& scenario, const InitObject& object,
                                 double tilt);

}  // namespace predictor
