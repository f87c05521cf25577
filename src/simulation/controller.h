// Controllers of the virtual cobot. To add a controller, see docs/developer/add-a-controller.md.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/archive.h"
#include "core/messages.h"
#include "models/robot.h"
#include "scenario/own_parameters.h"

namespace predictor {

class TapedController;

// A controller's input, which is what the controller of a real cobot can measure.
struct ControllerInput {
  double time = 0;                 // simulated time [s]
  const JointVector* q = nullptr;  // [rad]
  const JointVector* v = nullptr;  // [rad/s]
  const RobotModel* model = nullptr;
  const RobotData* data = nullptr;  // after UpdateDynamics at (q, v): poses, Jacobians, M, gravity
  FrameId end_effector;
  const FrameMotion* E = nullptr;  // pose and twist of the end-effector at (q, v)
  // The reading of the wrist sensor: the wrench of the load on the end-effector, about E, in axes
  // of W. The reading is zero unless the controller uses the sensor.
  Wrench F_E_W = Wrench::Zero();
  const JointVector* torque = nullptr;  // that acts at present [N·m]
  Pose X_WO;                            // of the object, without any error
};

class Controller {
 public:
  virtual ~Controller() = default;
  // Computes joint torques [N·m] before the effort limits are applied. The torques depend only on
  // the input, the memory and the last Tune. Earlier calls must not influence the torques, since
  // start, reset and linearisation call this function at other states. Does not use the heap or a
  // lock, and does not throw.
  virtual void Compute(const ControllerInput& input, JointVector* torque) noexcept = 0;
  // Returns the memory, which is everything that Advance changes, as smoothly varying numbers of
  // any unit. Its size is constant. Saved states and the linearisation contain the memory.
  virtual std::span<double> memory() noexcept { return {}; }
  // Sets the memory for a cobot that has rested at `input` for a long time.
  virtual void Start(const ControllerInput&) noexcept {}
  // Sets the memory for a controller that replaces another one at `input`, while input.torque acts.
  // Does not use the heap or a lock, and does not throw.
  virtual void TakeOver(const ControllerInput& input) noexcept { Start(input); }
  // Advances the memory by the controller's period dt [s]. Does not use the heap or a lock, or
  // throw.
  virtual void Advance(const ControllerInput& input, double dt) noexcept {
    static_cast<void>(input), static_cast<void>(dt);
  }
  // Returns whether the input contains the wrist sensor's reading.
  virtual bool uses_wrist_sensor() const noexcept { return false; }
  // Returns the energy stored in the controller's springs [J], or 0 if the controller has no
  // springs.
  virtual double StoredEnergy(const ControllerInput& input) const noexcept = 0;
  // Changes stiffness and damping. If `keeps_force`, the set-point shifts so that the springs'
  // force at `input` does not change. Does nothing for a controller without springs and dampers.
  // Does not use the heap or a lock, and does not throw.
  virtual void Tune(const ControllerTuning& tuning, const ControllerInput& input,
                    bool keeps_force) noexcept {
    static_cast<void>(tuning), static_cast<void>(input), static_cast<void>(keeps_force);
  }
  virtual bool has_springs() const noexcept { return false; }
  // Shifts the Cartesian set-point by `shift` from its usual place: a translation [m] and a
  // rotation vector [rad] in W. Does nothing for a controller without a Cartesian set-point. Does
  // not use the heap or a lock, and does not throw.
  virtual void ShiftSetPoint(const Vector6& shift) noexcept { static_cast<void>(shift); }
  // Returns 1 for each axis of W along or about which a spring pulls the end-effector to the
  // set-point, so that ShiftSetPoint has an effect, and 0 for the others.
  virtual Vector6 set_point_axes() const noexcept { return Vector6::Zero(); }
  // Undoes Tune and ShiftSetPoint.
  virtual void ResetTuning() noexcept {}
  // Returns the outcome of the last Compute, and the status if the step was refused.
  virtual ControllerOutcome outcome() const noexcept { return ControllerOutcome::kComputed; }
  virtual Status failure() const noexcept {
    return {StopCause::kPhysics, -1, std::numeric_limits<double>::quiet_NaN(), 0,
            Quantity::kNotFinite};
  }
  // The scene is being set up, which is not part of the control loop: the controller may then
  // allocate memory. A new controller is in this phase.
  virtual void SetUp(bool) noexcept {}
  // In real time, a controller outside the program has a deadline. In virtual time, the program
  // waits for the controller.
  virtual void SetRealTime(bool) noexcept {}
  // Gives the controller's process a real-time priority (SCHED_FIFO) below that of the loop if the
  // scenario requests it, or removes this priority. Returns a text that states what the system
  // granted, to be printed after "Real-time scheduling: ...; ". Returns "" if there is nothing to
  // report. Not for the tick.
  virtual std::string PrioritiseProcess(bool) { return ""; }
  // Returns null unless the controller is outside the program.
  virtual TapedController* taped() noexcept { return nullptr; }
  // Archives the changes by Tune, ShiftSetPoint and Start. The caller archives the memory.
  virtual void Archive(StateArchive&) noexcept {}
};

// The data from which a controller is made. They are its part of the scenario, the robot, and the
// state at the start.
struct ControllerContext {
  const ControllerSpec& spec;
  const RobotModel& model;
  FrameId end_effector;
  JointVector posture;                                   // [rad]
  Pose X_WE_start;                                       // set-point if there is no trajectory
  double gravity;                                        // [m/s²]
  std::filesystem::path folder = {};                     // of the scenario
  double period = 1e-3;                                  // of the controller [s]
  std::shared_ptr<const std::vector<double>> tape = {};  // Scenario::controller_tape
  bool distrusts_libraries = false;                      // OperatingRules
};

// The registry's description of a controller.
struct ControllerKind : ParameterKind {
  std::unique_ptr<Controller> (*make)(const ControllerContext&, const OwnParameters&);
};

// Returns the registry's kind for the controller class C, whose constructor takes the context and
// the parameters P. `name` is its cobot.controller.type.
template <class C, class P>
constexpr ControllerKind ControllerKindOf(const char* name, const char* doc,
                                          ControllerPlace place = ControllerPlace::kProgram) {
  constexpr bool is_tunable = !std::is_same_v<decltype(&C::Tune), decltype(&Controller::Tune)>;
  return {{name, doc, NewParameters<P>, place, is_tunable},
          [](const ControllerContext& context,
             const OwnParameters& parameters) -> std::unique_ptr<Controller> {
            return std::make_unique<C>(context, ValueOf<P>(parameters));
          }};
}

// Returns the `values` of the parameter `key`, one per joint. A single value applies to all joints.
// Throws InputError if the number of values is neither 1 nor the number of joints.
JointVector PerJoint(const ControllerContext& context, const std::string& key,
                     const std::vector<double>& values);

// Makes the controller that context.spec.type names, from the list in controllers/controllers.h.
// Throws InputError if the name is unknown or if the controller's part of the scenario does not fit
// the robot.
std::unique_ptr<Controller> MakeController(const ControllerContext& context);
std::vector<std::string> ControllerNames();

}  // namespace predictor
