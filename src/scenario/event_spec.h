// What goes wrong in a run, and when.
#pragma once

#include <optional>
#include <string>

#include "core/types.h"
#include "scenario/yaml_tree.h"

namespace predictor {

// The region in which an event begins. The region is a sphere whose centre is given relative to the
// object's position at the start.
struct EventPlaceSpec {
  Vector3 center = Vector3::Zero();  // offset in W [m]
  double radius = 0.05;              // [m]
};

// The event begins when all given conditions hold at once.
struct TriggerSpec {
  double after = 0;                     // simulated time from which the event may begin [s]
  double window = 0;                    // added to `after`, a random share of it [s]
  std::optional<EventPlaceSpec> place;  // where the object must be
  std::optional<double> force;          // force that a hand must exceed [N]
  bool gripping = false;                // every hand must exert a force
};

// One entry of `events`, which specifies a hazard that occurs on purpose.
struct EventSpec {
  std::string event = "power_loss";  // a name in the registry of hazards
  TriggerSpec trigger;
  double duration = 0;  // [s]; 0: until the end of the run
  // The parameters of this hazard (own_parameters.h). Missing parameters have their defaults.
  YamlNode parameters;

  // Sets one parameter to a value in YAML, as in "torque=20".
  void Set(const std::string& assignment) { ApplyOverride(assignment, &parameters); }
};

}  // namespace predictor
