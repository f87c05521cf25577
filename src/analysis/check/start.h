// Examines where the cobot and the object are at the start of a run, when both are at rest.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"
#include "models/robot.h"
#include "scenario/scenario.h"
#include "simulation/link_gaps.h"
#include "simulation/world.h"

namespace predictor {

struct StartReport {
  Vector3 flange = Vector3::Zero();    // origin of the end-effector E, in W [m]
  Vector3 outward = Vector3::UnitZ();  // where the last link points (LastLinkDirection), in W
  bool is_outside = true;              // the object is on that side of the end-effector
  ObjectGaps gaps;                     // of the object and the cobot
  ObjectSupport support;               // of the object [N]
  double weight = 0;                   // of the object [N]
  std::vector<ContactPair> pairs;      // of cobot.touches
  std::vector<std::size_t> keep_out;   // numbers of the fixtures that are keep-out volumes

  // Returns the angle between the last link and straight down [rad].
  double tilt() const;
};

// `cobot` is the cobot of the scenario, and `world` is in its initial state.
StartReport DescribeStart(const Scenario& scenario, const RobotModel& cobot, const World& world);

// Returns sentences that warn of an object that overlaps the cobot or that rests on the floor.
std::vector<std::string> StartWarnings(const StartReport& start);

// Appends the lines of the report for the user.
void AddStart(const StartReport& start, std::string* text);

}  // namespace predictor
