// Predicts properties of a scenario before anything moves.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "analysis/check/base_search.h"
#include "analysis/check/contact.h"
#include "analysis/check/reach.h"
#include "analysis/check/shift_search.h"
#include "analysis/check/start.h"
#include "core/messages.h"
#include "haptics/stability.h"
#include "scenario/machine.h"
#include "scenario/scenario.h"
#include "scenario/stop_budget.h"
#include "simulation/sampled_loop.h"

namespace predictor {

// The smallest singular value of a handle's Jacobian on the path [m].
inline constexpr double kMinSingularValue = 0.03;
inline constexpr double kMinMargin = 2;           // factor by which the hands' impedance may grow
                                                  // (StabilityMargin)
inline constexpr double kMarginPrecision = 1.02;  // precision of the bisection for the margin

// The results for the virtual cobot with its load at rest, and for the arms.
struct ModelsReport {
  double cobot_mass = 0;  // [kg]
  int cobot_joints = 0;
  double object_mass = 0;         // [kg]
  Vector3 sag = Vector3::Zero();  // object at equilibrium minus object at the set-point, in W [m]
  Pose X_WO;                      // object at equilibrium
  double torque_share = 0;        // static torque divided by its limit, for the worst joint
  double torque = 0, torque_limit = 0;  // torque of that joint and its limit [N·m], or a force [N]
                                        // if the joint is prismatic
  bool torque_is_force = false;
  std::string torque_joint;
  struct Arm {
    double mass = 0;  // [kg]
    int joints = 0;
    double payload_mass = 0;  // mass of the handle [kg]
    double reach = 0;         // distance from the base to the handle at the start [m]
    std::vector<std::string> joint_names;
  };
  std::array<std::optional<Arm>, kHands> arms;
};

// The margins of the haptic loop (haptics/stability.h).
struct StabilityReport {
  double lag = 0;         // lag of the arms [s]
  double lead = 0;        // chosen automatically or set by the scenario [s]
  bool chosen = true;     // chosen by `lead: auto`
  bool withheld = false;  // no lead is used because the loop of a real arm has not been measured
  StabilityMargin without_lead, margin, full_lead;  // at lead 0, `lead` and `lag`
  std::vector<double> masses, stiffnesses;          // axes of the table [kg], [N/m]
  std::vector<StabilityMargin> table;               // at `lead`; ordered by mass
};

struct CheckReport {
  std::string scenario;
  bool direct = false;
  ModelsReport models;
  StartReport start;
  SampledLoop controller;        // the cobot's controller as it is sampled, without hands
  std::string controller_joint;  // name of its joint
  double security_distance = 0;  // of link pairs [m]
  std::optional<Reach> reach;    // empty without a device
  double comfort = 0;            // comfort of the reach, see Comfort
  std::array<std::string, kHands> arm_key;  // key of an arm's base and loop
  std::array<Vector3, kHands> base = {Vector3::Zero(), Vector3::Zero()};  // current bases [m]
  PoseSpec shift;                                                         // current shift
  // A search sets `proposal` or, if the arms are fixed (Scenario::HasFixedArms), `shift_proposal`.
  std::optional<BaseProposal> proposal;
  std::optional<ShiftProposal> shift_proposal;
  std::optional<StabilityReport> stability;  // empty without a device
  // Contacts of the object with its surroundings, and the keys that let the cobot's links touch
  // something, whose contacts are not predicted. Both are empty without a device.
  std::vector<ContactReport> contacts;
  std::vector<std::string> link_contacts;
  // `stop` is a stop from `handle_speed` [m/s] as the arms perform it (StopOfArms). `longest_stop`
  // is the same stop with a joint at its speed limit (MinStopAcceleration). Both stops are empty
  // without a device.
  std::optional<StopBudget> stop, longest_stop;
  double handle_speed = 0;
  std::vector<std::string> problems;  // sentences, each with its remedy; if there are any, the
                                      // check fails
  std::vector<std::string> warnings;

  bool fit() const { return problems.empty(); }
  // Returns the name of a joint of an arm, or "" for −1.
  std::string JointName(std::size_t hand, int joint) const {
    return joint < 0 ? "" : models.arms[hand]->joint_names[static_cast<std::size_t>(joint)];
  }
};

struct CheckOptions {
  bool search = true;
  const Machine* machine = nullptr;  // machine whose arms the scenario uses; may be null
  std::function<void(double share, const char* what)> progress = [](double, const char*) {};
};

// Throws InputError for every error for which `run` would refuse the scenario. The exception is a
// start out of reach: the scenario then fails the check.
CheckReport Check(const Scenario& scenario, const CheckOptions& options);

// Returns whether a margin is sufficient, within the precision of its computation.
inline bool Suffices(const StabilityMargin& margin) {
  return kMarginPrecision * margin.gain >= kMinMargin;
}

// Returns a hand with another mass [kg] and stiffness [N/m] but the same damping ratio. `stiffness`
// is the largest component of the hand's stiffness. The other components of the stiffness and the
// rotational stiffness change in proportion.
HandSpec Varied(HandSpec hand, double mass, double stiffness);

// Computes the stability margins of the loop. `world` is at rest, and no hand holds a handle. The
// table covers a range of hands. Each of these hands is the scenario's hand with another mass and
// another stiffness but the same damping ratio. The largest component of the stiffness has a given
// value.
StabilityReport CheckStability(const Scenario& scenario, const LinearModel& world,
                               const std::vector<double>& masses,
                               const std::vector<double>& stiffnesses, const OnProgress& progress);

// These functions return the report as text for the user and as JSON in SI units.
std::string CheckText(const CheckReport& report);
std::string CheckJson(const CheckReport& report);
// Returns the JSON Schema (draft-07) of CheckJson.
std::string CheckSchema();

}  // namespace predictor
