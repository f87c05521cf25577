// What can be known of a scenario before anything moves.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "analysis/check/base_search.h"
#include "analysis/check/reach.h"
#include "core/messages.h"
#include "haptics/stability.h"
#include "scenario/machine.h"
#include "scenario/scenario.h"
#include "scenario/stop_budget.h"

namespace predictor {

inline constexpr double kLeastSingularValue = 0.03;  // of a handle's Jacobian on the path [m]
inline constexpr double kLeastMargin = 2;         // by which the hands may grow (StabilityMargin)
inline constexpr double kMarginPrecision = 1.02;  // of the margin's bisection
inline constexpr double kPathStep = 0.02;         // between samples of a path [s]

// The virtual cobot with its load, at rest; and the arms.
struct ModelsReport {
  double cobot_mass = 0;  // [kg]
  int cobot_joints = 0;
  double object_mass = 0;               // [kg]
  Vector3 sag = Vector3::Zero();        // object at equilibrium minus at the set-point, in W [m]
  Pose X_WO;                            // object at equilibrium
  double torque_share = 0;              // static torque over its limit, of the worst joint
  double torque = 0, torque_limit = 0;  // of that joint [N·m]
  std::string torque_joint;
  struct Arm {
    double mass = 0;  // [kg]
    int joints = 0;
    double payload_mass = 0;  // of the handle [kg]
    double reach = 0;         // from the base to the handle at the start [m]
    std::vector<std::string> joint_names;
  };
  std::array<std::optional<Arm>, kHands> arms;
};

// Margins of the haptic loop (haptics/stability.h).
struct StabilityReport {
  double lag = 0;                                   // of the arms [s]
  double lead = 0;                                  // chosen, or the scenario's [s]
  bool chosen = true;                               // by `lead: auto`
  bool withheld = false;                            // there is none: a real arm's loop is a guess
  StabilityMargin without_lead, margin, full_lead;  // at lead 0, `lead` and `lag`
  std::vector<double> masses, stiffnesses;          // of the table [kg], [N/m]
  std::vector<StabilityMargin> table;               // at `lead`; mass by mass
};

struct CheckReport {
  std::string scenario;
  bool direct = false;
  ModelsReport models;
  double security_distance = 0;             // of link pairs [m]
  std::optional<Reach> reach;               // without a device: none
  double comfort = 0;                       // of the reach, see Comfort
  std::array<std::string, kHands> arm_key;  // where base and loop of an arm are to be changed
  std::array<Vector3, kHands> base = {Vector3::Zero(), Vector3::Zero()};  // as they are [m]
  std::optional<BaseProposal> proposal;                                   // if a search was made
  std::optional<StabilityReport> stability;                               // without a device: none
  // Of a stop out of `handle_speed` [m/s], as the arms obey it (StopOfArms), and where a joint
  // turns as fast as it may (LeastStopAcceleration); without a device: none.
  std::optional<StopBudget> stop, longest_stop;
  double handle_speed = 0;
  std::vector<std::string> problems;  // each a sentence with what to do; any: unfit
  std::vector<std::string> warnings;

  bool fit() const { return problems.empty(); }
};

struct CheckOptions {
  bool search = true;
  const Machine* machine = nullptr;  // whose arms the scenario has; or null
  std::function<void(double share, const char* what)> progress = [](double, const char*) {};
};

// Throws InputError for what `run` would refuse, but for a start out of reach: that is unfit.
CheckReport Check(const Scenario& scenario, const CheckOptions& options);

// Whether a margin is enough, as far as it is known.
inline bool Suffices(const StabilityMargin& margin) {
  return kMarginPrecision * margin.gain >= kLeastMargin;
}

// A hand with another mass [kg] and stiffness [N/m], equally damped: `stiffness` is its largest
// component, the others and that of rotation change in proportion.
HandSpec Varied(HandSpec hand, double mass, double stiffness);

// The loop's margins. `world`: at rest, hands off. For a range of hands: the scenario's with each
// mass, and its stiffness scaled so that the largest is as given (damping ratio kept).
StabilityReport CheckStability(const Scenario& scenario, const LinearModel& world,
                               const std::vector<double>& masses,
                               const std::vector<double>& stiffnesses, const OnProgress& progress);

// The report for people, and as JSON in SI units.
std::string CheckText(const CheckReport& report);
std::string CheckJson(const CheckReport& report);

}  // namespace predictor
