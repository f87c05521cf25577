// Controllers of the virtual cobot. Adding one: docs/add-a-controller.md.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/archive.h"
#include "core/messages.h"
#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

// What a controller sees: the cobot alone, never the load or the hands.
struct ControllerInput {
  double time = 0;                 // simulated time [s]
  const JointVector* q = nullptr;  // [rad]
  const JointVector* v = nullptr;  // [rad/s]
  const RobotModel* model = nullptr;
  const RobotData* data = nullptr;  // UpdateDynamics done at (q, v): poses, Jacobians, M, gravity
  FrameId end_effector;
};

class Controller {
 public:
  virtual ~Controller() = default;
  // Joint torques [N·m], before the effort limits are applied. A function of the input and of the
  // last Tune: no memory of earlier calls, since start, reset and linearisation call it at states
  // of their own. No heap, lock or exception.
  virtual void Compute(const ControllerInput& input, JointVector* torque) noexcept = 0;
  // Energy stored in the controller's springs [J]; 0 if it has none.
  virtual double StoredEnergy(const ControllerInput& input) const noexcept = 0;
  // Changes stiffness and damping; the set-point shifts so that the springs' force at `input` stays
  // as it is. What has neither does nothing. No heap, lock or exception.
  virtual void Tune(const ControllerTuning& tuning, const ControllerInput& input) noexcept {
    static_cast<void>(tuning), static_cast<void>(input);
  }
  // Back to the scenario's values and set-point.
  virtual void ResetTuning() noexcept {}
  // What Tune has changed.
  virtual void Archive(StateArchive&) noexcept {}
};

// What a controller is made from: the scenario's part, the robot, its start.
struct ControllerContext {
  const ControllerSpec& spec;
  const RobotModel& model;
  FrameId end_effector;
  JointVector posture;  // [rad]
  Pose X_WE_start;      // set-point when there is no trajectory
  double gravity;       // [m/s²]
};

using ControllerFactory = std::unique_ptr<Controller> (*)(const ControllerContext&);

// The controller that context.spec.type names, out of the list in controllers/controllers.h. Throws
// InputError if there is none of that name or if its part of the scenario does not fit the robot.
std::unique_ptr<Controller> MakeController(const ControllerContext& context);
std::vector<std::string> ControllerNames();

}  // namespace predictor
