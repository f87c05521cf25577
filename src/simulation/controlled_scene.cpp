#include "simulation/controlled_scene.h"

#include "core/error.h"
#include "core/motion.h"
#include "models/arm_model.h"
#include "scenario/operating_rules.h"
#include "simulation/taped_controller.h"

namespace predictor {
namespace {

RobotSource Source(const Scenario& scenario) {
  return {scenario.cobot.model, scenario.folder(), scenario.cobot.remove_links,
          scenario.cobot.base.ToPose(), "cobot"};
}

FrameId EndEffectorOf(const CobotSpec& spec, const RobotModel& robot) {
  try {
    return robot.Frame(spec.end_effector);
  } catch (const InputError& error) {
    throw error.Within("cobot.end_effector");
  }
}

JointVector EffortLimit(const CobotSpec& spec, const RobotModel& robot) {
  if (spec.effort_limit.empty()) return robot.effort_limit();
  const int size = static_cast<int>(spec.effort_limit.size());
  if (size != 1 && size != robot.dof()) {
    throw InputError::At("cobot.effort_limit",
                         "cobot.effort_limit has " + std::to_string(size) +
                             " values. Give none to use the model's, one for all joints, or " +
                             std::to_string(robot.dof()) + ".");
  }
  JointVector limit(robot.dof());
  for (int j = 0; j < robot.dof(); ++j) limit[j] = OneOrEach(spec.effort_limit, j);
  return limit;
}

Pose StartOfEndEffector(const RobotModel& robot, const FrameId& end_effector,
                        const JointVector& q) {
  RobotData data(robot);
  data.UpdateKinematics(robot, q, JointVector::Zero(q.size()));
  return data.FramePose(robot, end_effector);
}

}  // namespace

ControlledScene::ControlledScene(const Scenario& scenario)
    : robot_(RobotModel::Load(Source(scenario))),
      end_effector_(EndEffectorOf(scenario.cobot, *robot_)),
      gravity_(scenario.environment.gravity),
      posture_(PostureOf(scenario.cobot.posture, *robot_, "cobot.posture")),
      controller_(
          MakeController({scenario.cobot.controller, *robot_, end_effector_, posture_,
                          StartOfEndEffector(*robot_, end_effector_, posture_), gravity_,
                          scenario.folder(), 1 / scenario.cobot.control.rate,
                          scenario.controller_tape, RulesFor(scenario).distrusts_libraries})),
      scene_(ComposeScene(scenario, *robot_, controller_->uses_wrist_sensor())),
      wrist_(scenario.cobot.wrist_sensor, scene_.model->opt.timestep, scenario.seed),
      timing_(scenario.cobot.control, scene_.model->opt.timestep),
      effort_limit_(EffortLimit(scenario.cobot, *robot_)),
      robot_data_(*robot_),
      q_(JointVector::Zero(robot_->dof())),
      v_(q_),
      torque_(q_),
      computed_(q_) {}

bool ControlledScene::Update(mjData* data) noexcept {
  if (!Guarded(mj_step1, model(), data)) return false;
  for (int j = 0; j < q_.size(); ++j) {
    q_[j] = data->qpos[scene_.qpos[static_cast<std::size_t>(j)]];
    v_[j] = data->qvel[scene_.dof[static_cast<std::size_t>(j)]];
  }
  robot_data_.UpdateDynamics(*robot_, q_, v_, gravity_);
  return true;
}

ControllerInput ControlledScene::Input(double t) const {
  ControllerInput input{t, &q_, &v_, robot_.get(), &robot_data_, end_effector_};
  if (has_wrist_sensor()) input.F_E_W = wrist_.reading();
  input.torque = &torque_;
  return input;
}

bool ControlledScene::ApplyController(double t, mjData* data) noexcept {
  if (!ComputeTorque(t, &torque_)) return false;
  WriteTorque(data);
  return true;
}

bool ControlledScene::ComputeTorque(double t, JointVector* torque) noexcept {
  controller_->Compute(Input(t), torque);
  if (!torque->allFinite()) return false;
  *torque = torque->cwiseMin(effort_limit_).cwiseMax(-effort_limit_);
  return controller_->outcome() != ControllerOutcome::kFailed;
}

void ControlledScene::WriteTorque(mjData* data) const noexcept {
  for (int j = 0; j < torque_.size(); ++j) {
    data->qfrc_applied[scene_.dof[static_cast<std::size_t>(j)]] = torque_[j];
  }
}

void ControlledScene::StartController(mjData* data) noexcept {
  if (has_wrist_sensor()) {
    mj_forwardSkip(model(), data, mjSTAGE_VEL, 0);
    wrist_at_start_ = WristWrench(*data);
  }
  ResetController();
}

// Uses the state of the last Update.
void ControlledScene::ResetController() noexcept {
  wrist_.Reset(wrist_at_start_);
  controller_->Start(Input(0));
  if (timing_.is_immediate()) return;
  ComputeTorque(0, &computed_);
  timing_.Reset(computed_);
}

bool ControlledScene::StepController(double t, mjData* data) noexcept {
  if (const ControllerAnswer* played = taped() ? taped()->played() : nullptr) {
    torque_ = played->torque;
    WriteTorque(data);
    return played->outcome != ControllerOutcome::kFailed;
  }
  if (timing_.is_immediate()) return ApplyController(t, data);
  if (timing_.is_due() && !ComputeTorque(t, &computed_)) return false;
  torque_ = timing_.Apply(computed_);
  WriteTorque(data);
  return true;
}

Wrench ControlledScene::WristWrench(const mjData& data) const noexcept {
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data.site_xmat +
                                                                         9 * scene_.wrist_site);
  const Eigen::Map<const Vector3> at(data.site_xpos + 3 * scene_.wrist_site);
  Wrench F_W;
  // The engine's sensor gives the wrench of the end-effector on the load.
  F_W << -(R * Eigen::Map<const Vector3>(data.sensordata)),
      -(R * Eigen::Map<const Vector3>(data.sensordata + 3));
  return ShiftWrench(F_W, at - robot_data_.FramePose(*robot_, end_effector_).p);
}

void ControlledScene::SenseWrist(const mjData& data) noexcept {
  if (has_wrist_sensor()) wrist_.Step(WristWrench(data));
}

void ControlledScene::AdvanceController(double t) noexcept {
  if (!controller_->memory().empty() && timing_.is_due()) Advance(t, timing_.period_time());
}

void ControlledScene::Archive(StateArchive& a) noexcept {
  a(torque_, timing_);
  if (!timing_.is_immediate()) a(computed_);
  if (has_wrist_sensor()) a(wrist_);
  for (double& x : controller_->memory()) a(x);
  controller_->Archive(a);
}

FrameMotion ControlledScene::EndEffector() const {
  FrameMotion motion;
  motion.X_W = robot_data_.FramePose(*robot_, end_effector_);
  motion.V_W = robot_data_.FrameTwist(*robot_, end_effector_);
  return motion;
}

FrameMotion ControlledScene::Object(const mjData& data) const {
  FrameMotion motion;
  const double* q = data.xquat + 4 * scene_.object;
  motion.X_W = {Eigen::Map<const Vector3>(data.xpos + 3 * scene_.object),
                Quaternion(q[0], q[1], q[2], q[3])};
  double velocity[6];  // angular, then linear
  mj_objectVelocity(model(), &data, mjOBJ_XBODY, scene_.object, velocity, 0);
  motion.V_W << Eigen::Map<Vector3>(velocity + 3), Eigen::Map<Vector3>(velocity);
  return motion;
}

double ControlledScene::Energy(double t, mjData* data) const noexcept {
  if (const ControllerAnswer* played = taped() ? taped()->played() : nullptr) return played->energy;
  mj_energyVel(model(), data);
  const double height = data->xipos[3 * scene_.object + 2];
  return data->energy[1] + scene_.object_model.mass * gravity_ * height +
         controller_->StoredEnergy(Input(t));
}

}  // namespace predictor
