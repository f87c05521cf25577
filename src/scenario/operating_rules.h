// The operating rules of a run determine what people and programs may do, and what the safety
// functions take into account. The rules follow from the scenario alone and do not change during a
// run.
#pragma once

#include <limits>

#include "core/run_input.h"
#include "scenario/scenario.h"

namespace predictor {

// The defaults are the rules of a run in which no real arm can move, with a simulated rig or in
// direct mode. RulesFor is the only function that distinguishes these kinds of scenario.
struct OperatingRules {
  // -- Who may command --
  // The program takes the run from IDLE to RUN without a person.
  bool auto_start = true;
  // Pages may request align, start, end and reset. If this rule is false, only a person at the rig
  // may make these requests.
  bool remote_start = true;
  // While the arms are at rest, a page may select the next scenario.
  bool may_switch_scenario = true;
  // The arms move in ALIGN, RUN and RECOVERY only while a person holds the enabling key or device.
  bool needs_enabling = false;
  // operator.type must be person, because a person holds the handles.
  bool needs_person = false;
  // ALIGN starts only while no one presses on a handle.
  bool aligns_hands_free = false;
  // RUN starts only while the handles are still within the alignment tolerance.
  bool rechecks_alignment = false;
  // A reset keeps thresholds that a person has tightened.
  bool keeps_tightened_thresholds = false;
  // A person may make the virtual cobot stiffer or less damped than the scenario specifies.
  bool may_stiffen = true;
  // A person who wears a headset must see the moving arms. The run therefore stops if a headset
  // sends no messages.
  bool watches_headsets = false;
  // An access code for the page admits only one client.
  bool single_use_access_code = false;

  // -- The arms --
  // Samples of arms and sensors come from outside the program: a replay needs them.
  bool external_device = false;
  // The arms continue to move while the program is late, so missed deadlines count.
  bool arms_move_between_ticks = false;
  // If an arm still moves after a stop has timed out, its power is cut, because the arm must not be
  // held.
  bool cuts_power_of_moving_arms = false;
  // rendering.formulation must include every repair, because a person can be hurt.
  bool needs_repairs = false;
  // A controller's library must have passed a trial, because a crash of the library would be a
  // crash of the control loop.
  bool distrusts_libraries = false;
  // The elbows keep their distance even if the scenario lists other link pairs.
  bool always_separates_elbows = false;
  // The largest safety.handle_speed that a scenario may set [m/s].
  double max_handle_speed = std::numeric_limits<double>::infinity();

  // -- The force sensors --
  // A constant reading means a frozen sensor, even if the scenario sets no noise.
  bool sensors_always_have_noise = false;
  // A sensor may be mounted or wired incorrectly, so the run stops if a handle runs away.
  bool detects_runaway = false;
  // The gravity that acts on the handles [m/s²].
  double handle_gravity = kStandardGravity;
};

OperatingRules RulesFor(const Scenario& scenario);

// The limits of a parameter that may be changed during a run.
struct ParameterRange {
  double min = 0, max = 0;
  double start = 0;  // the scenario's value; 1 for a factor
};

// Thresholds may only be changed to values below those of the scenario. With real arms, stiffness
// may only be lowered and damping only raised.
ParameterRange RangeOf(const Scenario& scenario, Parameter parameter);

}  // namespace predictor
