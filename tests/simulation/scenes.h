// Scenes for the tests, built in C++. A Panda holds a box or a ball.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "models/robot.h"
#include "scenario/scenario.h"
#include "simulation/controller.h"

namespace predictor {

inline constexpr double kGravity = 9.81;  // [m/s²]

// Returns the paper's cobot on a stand of 0.6 m, stiff in the vertical direction only. The scene
// has no floor.
inline Scenario PandaScene() {
  Scenario s;
  s.file = std::filesystem::path(PREDICTOR_SOURCE_DIR) / "scenarios" / "test.yaml";
  s.cobot.model = "package://example-robot-data/robots/panda_description/urdf/panda.urdf";
  s.cobot.remove_links = {"panda_hand"};
  s.cobot.base.xyz = {0, 0, 0.6};
  s.cobot.end_effector = "panda_link8";
  s.cobot.posture = {0, -0.3, 0, -2.0, 0, 1.7, 0.785};
  s.cobot.controller.Set("stiffness.translation=[5, 5, 500]");
  s.environment.gravity = kGravity;
  s.environment.floor = false;
  return s;
}

// A box hangs from the end-effector by a spherical joint in its top face, with a handle at each
// side. The cobot is stronger than a Panda, whose wrist can barely hold 9 kg.
inline Scenario BoxScene(double mass) {
  Scenario s = PandaScene();
  s.cobot.effort_limit = {200};
  s.object.primitive = PrimitiveSpec{};
  s.object.primitive->size = {0.26, 0.38, 0.2};
  s.object.primitive->mass = mass;
  s.object.attachment.on_end_effector.rpy = {M_PI, 0, 0};  // the flange faces down
  s.object.attachment.on_object.xyz = {0, 0, 0.1};
  s.left_handle = HandleSpec{};
  s.left_handle->pose.xyz = {0, 0.19, -0.1};
  s.right_handle = HandleSpec{};
  s.right_handle->pose.xyz = {0, -0.19, -0.1};
  s.right_handle->pose.rpy = {0.3, -0.2, 0.5};
  return s;
}

// A box of 2 kg is fixed to the flange. One handle is in the flange, and the scene uses another
// controller.
inline Scenario FlangeScene(const std::string& type, const std::vector<std::string>& parameters) {
  Scenario s = BoxScene(2);
  s.object.attachment.joint = JointType::kFixed;
  s.object.attachment.on_object.xyz = {0, 0, 0};
  s.object.primitive->size = {0.1, 0.1, 0.1};
  s.left_handle->pose = {};
  s.right_handle.reset();
  s.cobot.controller = {type, {}};
  for (const std::string& p : parameters) s.cobot.controller.Set(p);
  return s;
}

// The hand holds almost nothing (a grain of 1 mg), so that the test observes the cobot alone.
inline Scenario EmptyScene() {
  Scenario s = PandaScene();
  s.object.primitive = PrimitiveSpec{};
  s.object.primitive->shape = Shape::kSphere;
  s.object.primitive->size = {0.001, 0, 0};
  s.object.primitive->mass = 1e-6;
  s.object.attachment.joint = JointType::kFixed;
  s.left_handle = HandleSpec{};
  s.cobot.joint_friction.viscous = {0};
  return s;
}

// A cobot's model, its workspace at a given state, and its controller.
struct ControlledRobot {
  explicit ControlledRobot(const Scenario& s)
      : model(RobotModel::Load(
            {s.cobot.model, s.file.parent_path(), s.cobot.remove_links, s.cobot.base.ToPose()})),
        data(*model),
        end_effector(model->Frame(s.cobot.end_effector)),
        posture(Eigen::Map<const Eigen::VectorXd>(s.cobot.posture.data(), model->dof())) {
    Update(posture, JointVector::Zero(model->dof()));
    controller = MakeController({s.cobot.controller, *model, end_effector, posture,
                                 data.FramePose(*model, end_effector), kGravity});
  }

  void Update(const JointVector& q_, const JointVector& v_) {
    q = q_;
    v = v_;
    data.UpdateDynamics(*model, q, v, kGravity);
    E.X_W = data.FramePose(*model, end_effector);
    E.V_W = data.FrameTwist(*model, end_effector);
  }
  ControllerInput Input(double time = 0) const {
    return {time, &q, &v, model.get(), &data, end_effector, &E};
  }
  JointVector Torque(double time = 0) {
    JointVector torque;
    controller->Compute(Input(time), &torque);
    return torque;
  }
  double Energy(double time = 0) { return controller->StoredEnergy(Input(time)); }

  std::shared_ptr<const RobotModel> model;
  RobotData data;
  FrameId end_effector;
  JointVector posture, q, v;
  FrameMotion E;
  std::unique_ptr<Controller> controller;
};

}  // namespace predictor
