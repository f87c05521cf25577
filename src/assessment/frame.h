// Everything that is judged about the person at one time, based on the posture and the loads.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

#include "assessment/muscle_use.h"
#include "ergonomics/fatigue.h"
#include "ergonomics/niosh.h"
#include "ergonomics/owas.h"
#include "ergonomics/reba.h"
#include "ergonomics/rula.h"
#include "ergonomics/strength.h"
#include "person/body_loads.h"
#include "person/posture_angles.h"
#include "scenario/scenario.h"

namespace predictor::assessment {

// A value that is not known.
inline constexpr double kUnknownValue = std::numeric_limits<double>::quiet_NaN();

// Assumptions about the work that no recording contains.
struct WorkPattern {
  bool repeated = false;  // the person takes the same posture at least four times a minute
  bool held = false;      // a posture is static for more than a minute
  ergonomics::Coupling coupling = ergonomics::Coupling::kGood;
  // Duration of the work with lifts like those of the run.
  ergonomics::LiftDuration lifting = ergonomics::LiftDuration::kShort;
  // Effort with which a hand grips a handle, 0 … 10 (OMNI-RES). Without a value, DUET is not
  // evaluated, because no sensor measures this effort, and the hand activity is a lower bound.
  std::optional<double> grip_effort;
  // A trial in which the person held a load until exhaustion. Without a value, Peternel's fatigue
  // is not evaluated.
  std::optional<ergonomics::TrialFatigue> fatigue_trial;
  // Strength of the person, as a multiple of the mean for the person's sex (BodySpec::strength).
  std::array<double, ergonomics::kStrengthDirections> strength = {1, 1, 1, 1};
};

// If a hand of the modelled body misses its handle by more than this distance, the person did not
// stand as operator.stance states, so nothing is concluded from the posture (design choice) [m].
inline constexpr double kLargestMiss = 0.05;

// If `known` is false, a hand misses its handle by more than kLargestMiss. In this case, the scores
// are 0 and no other value is a number.
struct Frame {
  bool known = true;
  person::PostureAngles angles;
  person::BodyLoads loads;
  // The scores of the arm with the worse score, among the arms that hold a handle. The scores use
  // the force of both hands together.
  ergonomics::RulaScores rula;
  ergonomics::RebaScores reba;
  ergonomics::OwasScore owas;
  // The torque divided by the strength in the torque's direction (flexion or extension). This
  // strength is the mean for the person's sex times WorkPattern::strength. The value of a raised
  // shoulder (see IsRaised) is not a number.
  std::array<double, kHands> elbow_use = {}, shoulder_use = {};
  // The share of people of the operator's sex, 0 … 1, who are strong enough for the same torques.
  // This share does not depend on WorkPattern::strength.
  std::array<double, kHands> elbow_capable = {}, shoulder_capable = {};
  bool reached = false;  // whether the hands reach the handles in this posture
  // The use of the muscles is computed for the nominal person only.
  std::array<ArmMuscleUse, kHands> muscles;
};

struct FrameInput {
  const person::BodySample& sample;
  std::array<double, kHands> force_rate;  // rate of change of each hand's force, over 0.1 s [N/s]
};

// Where the hands of a posture are.
struct Reach {
  bool reached = false;
  double miss = 0;  // largest distance by which a hand misses its handle [m]
};

Frame FrameOf(const FrameInput& input, const person::PostureAngles& angles,
              const person::BodyLoads& loads, const Reach& reach, Sex sex, const WorkPattern& work);

// Returns the moment of the hands' forces about the lower back, without the weight of the trunk
// [N·m].
double LiftMoment(const Frame& frame);

// Returns whether the upper arm is raised above 90°. Models of the shoulder then disagree with
// measurements (Bergmann et al. 2011), so nothing is concluded about the shoulder.
bool IsRaised(const person::ArmAngles& arm);

// Returns the torque of an arm's joint [N·m], or not a number if it is unknown or if the joint
// belongs to a raised shoulder.
double TorqueOf(const Frame& frame, int hand, person::ArmJoint joint);
// Returns the part of this torque that the hands' wrenches cause [N·m].
double OverloadOf(const Frame& frame, int hand, person::ArmJoint joint);
// Returns the magnitude of the moment at the shoulder [N·m], or not a number if it is unknown or if
// the shoulder is raised.
double ShoulderMoment(const Frame& frame, std::size_t hand);

// In RULA and REBA, a force that rises faster than this counts as a shock (design choice) [N/s].
inline constexpr double kShockRate = 300;

}  // namespace predictor::assessment
