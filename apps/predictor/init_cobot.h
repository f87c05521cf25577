// The cobot of the scenario that `init` writes: which part of a URDF it is, and how it stands.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"

namespace predictor {

inline constexpr const char* kPandaUrdf =
    "package://example-robot-data/robots/panda_description/urdf/panda.urdf";
inline constexpr double kInitStiffness = 500;  // vertical stiffness of the controller [N/m]

// A cobot as in the scenario, and the pose of its end-effector.
struct InitCobot {
  std::string model, end_effector;
  std::vector<std::string> remove_links;
  double removed_mass = 0;      // mass of these links [kg]
  std::vector<double> posture;  // [rad] or [m]
  Pose X_WE;
};

InitCobot PandaCobot();

// Returns the robot of a URDF in postures in which it can carry `mass` [kg], the most suitable one
// first, or nothing if no posture was found. The result is the same in each call. `urdf` is a file
// or package://..., in a folder from which the scenario may read it. For `end_effector`, see
// FindArm. Throws InputError.
std::vector<InitCobot> OwnCobots(const std::string& urdf, const std::string& end_effector,
                                 const std::filesystem::path& scenario, double mass);

}  // namespace predictor
