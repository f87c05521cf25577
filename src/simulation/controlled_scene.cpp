#include "simulation/controlled_scene.h"

#include "core/error.h"
#include "core/motion.h"
#include "models/arm_model.h"
#include "scenario/operating_rules.h"
#include "simulation/event_checks.h"
#include "simulation/landing.h"
#include "simulation/smooth_friction.h"
#include "simulation/taped_controller.h"

namespace predictor {
namespace {

JointVector StartPosture(const Scenario& scenario, const RobotModel& robot) {
  const char* key = "cobot.posture";
  if (scenario.tree) CheckPostureUnits(*scenario.tree, robot, key);
  return PostureOf(scenario.cobot.posture, robot, key);
}

FrameId EndEffectorOf(const CobotSpec& spec, const RobotModel& robot) {
  try {
    return robot.Frame(spec.end_effector);
  } catch (const InputError& error) {
    throw error.Within("cobot.end_effector");
  }
}

Pose StartOfEndEffector(const RobotModel& robot, const FrameId& end_effector,
                        const JointVector& q) {
  RobotData data(robot);
  data.UpdateKinematics(robot, q, JointVector::Zero(q.size()));
  return data.FramePose(robot, end_effector);
}

ControllerContext ContextOf(const ControllerSpec& spec, const Scenario& scenario,
                            const RobotModel& robot, const FrameId& end_effector,
                            const JointVector& posture) {
  return {spec,
          robot,
          end_effector,
          posture,
          StartOfEndEffector(robot, end_effector, posture),
          scenario.environment.gravity,
          scenario.folder(),
          1 / scenario.cobot.control.rate,
          scenario.controller_tape,
          RulesFor(scenario).distrusts_libraries};
}

std::unique_ptr<Controller> MakeStandby(const ControllerContext& context) {
  std::unique_ptr<Controller> controller;
  try {
    controller = MakeController(context);
  } catch (const InputError& error) {
    throw error.Within("cobot.standby_controller");
  }
  if (controller->taped() == nullptr) return controller;
  throw InputError::At("cobot.standby_controller.type",
                       "cobot.standby_controller.type is " + context.spec.type +
                           ". The standby controller must be part of the program.");
}

}  // namespace

ControlledScene::LooseObject::LooseObject(const Scenario& scenario, const RobotModel& robot)
    : engine(MakeEngine(scenario, robot, false, Holding::kFree)),
      attachment(scenario.object.attachment, engine.get()) {}

ControlledScene::ControlledScene(const Scenario& scenario, const EventSequence& events)
    : robot_(LoadCobotModel(scenario)),
      end_effector_(EndEffectorOf(scenario.cobot, *robot_)),
      gravity_(scenario.environment.gravity),
      posture_(StartPosture(scenario, *robot_)),
      controller_(MakeController(
          ContextOf(scenario.cobot.controller, scenario, *robot_, end_effector_, posture_))),
      standby_(scenario.cobot.standby_controller
                   ? MakeStandby(ContextOf(*scenario.cobot.standby_controller, scenario, *robot_,
                                           end_effector_, posture_))
                   : nullptr),
      payload_(scenario.cobot.payload),
      carried_(MakeEngine(scenario, *robot_, has_wrist_sensor(), Holding::kJoint)),
      loose_(events.loosens_attachment() ? std::make_unique<LooseObject>(scenario, *robot_)
                                         : nullptr),
      pick_up_(events.picks_up() ? std::make_unique<PickUp>(carried_.get()) : nullptr),
      wrist_(scenario.cobot.wrist_sensor, carried_->step(), scenario.seed),
      timing_(scenario.cobot.control, carried_->step(), events.longest_delay()),
      effort_limit_(EffortLimit(scenario.cobot, *robot_)),
      robot_data_(*robot_),
      q_(JointVector::Zero(robot_->dof())),
      v_(q_),
      torque_(q_),
      computed_(q_),
      safety_(scenario.cobot),
      obstacles_(events.obstacles()),
      absent_(obstacles_) {
  for (int j = 0; j < robot_->dof(); ++j) friction_.push_back(carried_->JointFriction(j));
  CheckEvents(events, scenario.object.attachment.joint, scenario.cobot.controller.type,
              *controller_, standby_.get());
  if (obstacles_ != 0) RemoveFixtures();
}

bool ControlledScene::Update(Engine* engine) noexcept {
  if (!engine->Prepare()) return false;
  const Engine::Layout& at = engine->layout();
  const Engine::Values q = engine->positions(), v = engine->velocities();
  for (int j = 0; j < q_.size(); ++j) {
    q_[j] = q[at.q[static_cast<std::size_t>(j)]];
    v_[j] = v[at.v[static_cast<std::size_t>(j)]];
  }
  X_WO_ = engine->PoseOf(SceneBody::kObject);
  robot_data_.UpdateDynamics(*robot_, q_, v_, gravity_);
  E_.X_W = robot_data_.FramePose(*robot_, end_effector_);
  E_.V_W = robot_data_.FrameTwist(*robot_, end_effector_);
  return true;
}

ControllerInput ControlledScene::Input(double t) const {
  ControllerInput input{t, &q_, &v_, robot_.get(), &robot_data_, end_effector_, &E_};
  if (has_wrist_sensor()) input.F_E_W = wrist_.reading() + disturbance_.sensor;
  input.torque = &torque_;
  input.X_WO = X_WO_;
  return input;
}

bool ControlledScene::ApplyController(double t, Engine* engine) noexcept {
  if (!ComputeTorque(t, &torque_)) return false;
  WriteTorque(engine);
  return true;
}

bool ControlledScene::ComputeTorque(double t, JointVector* torque) noexcept {
  Acting().Compute(Input(t), torque);
  if (!torque->allFinite()) return false;
  if (payload_ || pick_up_) AddPayload(torque);
  AddModelErrors(torque);
  *torque = torque->cwiseMin(effort_limit_).cwiseMax(-effort_limit_);
  return Acting().outcome() != ControllerOutcome::kFailed;
}

// Returns the share of the payload that the cobot's program says is in the gripper. The cobot's
// program does not know whether an object slips or breaks loose.
double ControlledScene::PayloadShare() const noexcept {
  const GripperCommands& gripper = disturbance_.gripper;
  if (!gripper.was_opened()) return 1;
  if (gripper.is_open() || (is_loose_ && loose_->attachment.missed())) return 0;
  return gripper.grasped < gripper.load_time ? gripper.grasped / gripper.load_time : 1;
}

void ControlledScene::AddPayload(JointVector* torque) const noexcept {
  const Pose& X_WE = E_.X_W;
  Jacobian J;
  robot_data_.FrameJacobian(*robot_, end_effector_, &J);
  if (payload_) {
    Wrench weight = Wrench::Zero();
    weight[2] = PayloadShare() * payload_->mass * gravity_;
    weight = ShiftWrench(weight, X_WE.q * payload_->center_of_mass);
    torque->noalias() += J.transpose().lazyProduct(weight);
  }
  if (pick_up_) torque->noalias() -= J.transpose().lazyProduct(PickedLoad());
}

// Returns the weight that the cobot's program says that the object holds, on E, about E, in W.
Wrench ControlledScene::PickedLoad() const noexcept {
  Wrench weight = Wrench::Zero();
  if (!pick_up_) return weight;
  weight[2] = -pick_up_->load() * gravity_;
  return ShiftWrench(weight,
                     X_WO_ * pick_up_->p_OL() - robot_data_.FramePose(*robot_, end_effector_).p);
}

// Adds the effect of a load at E and of friction for which the controller compensates although
// neither of them exists.
void ControlledScene::AddModelErrors(JointVector* torque) const noexcept {
  const Disturbance& d = disturbance_;
  if (d.payload != 0) {
    Jacobian J;
    robot_data_.FrameJacobian(*robot_, end_effector_, &J);
    torque->noalias() += d.payload * gravity_ * J.row(2).transpose();
  }
  if (d.coulomb == 0 && d.viscous == 0) return;
  for (int j = 0; j < torque->size(); ++j)
    (*torque)[j] += SmoothFriction(d.coulomb, d.viscous, v_[j]);
}

void ControlledScene::WriteTorque(Engine* engine) const noexcept {
  Engine::Values forces = engine->joint_forces();
  for (int j = 0; j < torque_.size(); ++j)
    forces[engine->layout().v[static_cast<std::size_t>(j)]] = torque_[j];
}

void ControlledScene::StartController() noexcept {
  if (has_wrist_sensor()) {
    engine().ComputeAccelerations(true);
    wrist_at_start_ = WristWrench(engine());
  }
  ResetController();
}

// Uses the state of the last Update.
void ControlledScene::ResetController() noexcept {
  tuning_ = {};
  controller_->ResetTuning();
  wrist_.Reset(wrist_at_start_);
  controller_->Start(Input(0));
  if (standby_) {
    standby_->ResetTuning();
    standby_->Start(Input(0));
  }
  ComputeTorque(0, &computed_);
  if (!timing_.is_immediate()) timing_.Reset(computed_);
  torque_ = computed_;
  if (safety_.is_on()) safety_.Reset(Input(0));
}

bool ControlledScene::StepController(double t) noexcept {
  if (const ControllerAnswer* played = taped() ? taped()->played() : nullptr) {
    torque_ = played->torque;
    WriteTorque(&engine());
    return played->outcome != ControllerOutcome::kFailed;
  }
  const bool computes = timing_.is_immediate() || timing_.is_due();
  if (computes && !disturbance_.frozen && !ComputeTorque(t, &computed_)) return false;
  torque_ = timing_.is_immediate() ? computed_ : timing_.Apply(computed_);
  if (safety_.is_on()) {
    safety_.Limit(Input(t), step(), &torque_);
    torque_ = torque_.cwiseMin(effort_limit_).cwiseMax(-effort_limit_);
  }
  if (disturbance_.brakes || disturbance_.powerless) torque_.setZero();
  WriteTorque(&engine());
  return true;
}

void ControlledScene::Tune(const ControllerTuning& tuning, double t) noexcept {
  tuning_ = tuning;
  SetGains(t, true);
}

void ControlledScene::SetGains(double t, bool keeps_force) noexcept {
  const ControllerTuning& by = disturbance_.gains;
  const ControllerTuning gains = {tuning_.stiffness_translation * by.stiffness_translation,
                                  tuning_.stiffness_rotation * by.stiffness_rotation,
                                  tuning_.damping_ratio * by.damping_ratio};
  controller_->Tune(gains, Input(t), keeps_force);
  if (standby_) standby_->Tune(gains, Input(t), keeps_force);
}

void ControlledScene::Disturb(const Disturbance& disturbance, double t) noexcept {
  const Disturbance before = disturbance_;
  disturbance_ = disturbance;
  if (disturbance.gains != before.gains) SetGains(t, false);
  if (disturbance.set_point != before.set_point) {
    controller_->ShiftSetPoint(disturbance.set_point);
    if (standby_) standby_->ShiftSetPoint(disturbance.set_point);
  }
  if (disturbance.brakes != before.brakes) SetBrakes(disturbance.brakes);
  if (disturbance.delay != before.delay) timing_.AddDelay(disturbance.delay);
  if (disturbance.standby != before.standby) Acting().TakeOver(Input(t));
  if (loose_) loose_->attachment.SetLimits(disturbance.grip);
  if (is_loose_) loose_->attachment.Command(disturbance.gripper);
  if (pick_up_ && pick_up_->Command(disturbance.pick_up)) Update(&engine());
  if (safety_.is_on()) safety_.SetLoad(Input(t), PayloadShare(), PickedLoad());
  if (absent_ != (obstacles_ & ~disturbance.obstacles)) PlaceObstacles();
}

void ControlledScene::RemoveFixtures() noexcept {
  carried_->RemoveFixtures(absent_);
  if (loose_) loose_->engine->RemoveFixtures(absent_);
}

// Removes and adds fixtures as the events require. A fixture that overlaps the object, the cobot or
// a movable object is added only when the overlap has ended.
void ControlledScene::PlaceObstacles() noexcept {
  const std::uint64_t before = absent_;
  absent_ = AbsentFixtures(obstacles_, disturbance_.obstacles, 0, 0);
  RemoveFixtures();
  Update(&engine());
  const std::uint64_t absent =
      AbsentFixtures(obstacles_, disturbance_.obstacles, before, TouchedFixtures(engine()));
  if (absent == absent_) return;
  absent_ = absent;
  RemoveFixtures();
  Update(&engine());
}

void ControlledScene::Resume(const Disturbance& disturbance) noexcept {
  disturbance_ = disturbance;
  SetBrakes(disturbance.brakes);
  timing_.AddDelay(disturbance.delay);
  if (loose_) loose_->attachment.SetLimits(disturbance.grip);
  if (pick_up_) {
    if (disturbance.pick_up.picked == HUGE_VAL) pick_up_->Reset();
    pick_up_->Resume();
  }
  if (obstacles_ == 0) return;
  if (disturbance.obstacles == 0) absent_ = obstacles_;
  RemoveFixtures();
}

void ControlledScene::Loosen() noexcept {
  const FrameMotion O = carried_->MotionOf(SceneBody::kObject);
  Engine& loose = *loose_->engine;
  loose.Clear();
  loose.SetTime(carried_->time());
  const Engine::Layout& from = carried_->layout();
  const Engine::Layout& to = loose.layout();
  Engine::Values q = loose.positions(), v = loose.velocities();
  for (std::size_t j = 0; j < static_cast<std::size_t>(q_.size()); ++j) {
    q[to.q[j]] = carried_->positions()[from.q[j]];
    v[to.v[j]] = carried_->velocities()[from.v[j]];
  }
  loose.MoveObject(O);
  loose.movable_positions() = carried_->movable_positions();
  loose.movable_velocities() = carried_->movable_velocities();
  is_loose_ = true;
  WriteTorque(&loose);
  Update(&loose);
  loose_->attachment.Close();
  loose_->attachment.Command(disturbance_.gripper);
  loose_->landing = LandingHeight(loose.object_com().z());
}

bool ControlledScene::Hold(const Wrench& object_wrench) noexcept {
  if (is_loose_) return loose_->attachment.Hold(object_wrench);
  return !pick_up_ || pick_up_->Hold(object_wrench);
}

bool ControlledScene::Follow() noexcept {
  if (is_loose_) loose_->attachment.Follow();
  return !pick_up_ || !pick_up_->Follow() || Update(&engine());
}

Wrench ControlledScene::LandingOf(const FrameMotion& object) const noexcept {
  return LandingWrench(carried_->object_model(), object, loose_->landing);
}

// A closed brake is joint friction that resists up to the motor's largest torque.
void ControlledScene::SetBrakes(bool closed) noexcept {
  for (int j = 0; j < q_.size(); ++j) {
    DofFriction friction = friction_[static_cast<std::size_t>(j)];
    if (closed) friction = {friction.torque + effort_limit_[j], kBrakeImpedance};
    carried_->SetJointFriction(j, friction);
    if (loose_) loose_->engine->SetJointFriction(j, friction);
  }
}

Wrench ControlledScene::WristWrench(const Engine& engine) const noexcept {
  if (is_loose_) return loose_->attachment.load();
  Vector3 at;
  const Wrench F_W = engine.LoadWrench(&at);
  return ShiftWrench(F_W, at - E_.X_W.p);
}

void ControlledScene::SenseWrist() noexcept {
  if (has_wrist_sensor()) wrist_.Step(WristWrench(engine()));
}

void ControlledScene::AdvanceController(double t) noexcept {
  if (!Acting().memory().empty() && timing_.is_due() && !disturbance_.frozen)
    Acting().Advance(Input(t), timing_.period_time());
  if (!safety_.is_on()) return;
  // The cobot does not know the torque of closed brakes, so it cannot estimate anything.
  if (disturbance_.brakes)
    safety_.Skip(v_);
  else
    safety_.Watch(Input(t), step());
}

void ControlledScene::Archive(StateArchive& a) noexcept {
  a(torque_, timing_, computed_, tuning_, safety_);
  if (obstacles_ != 0) a(absent_);
  a(pick_up_);
  if (has_wrist_sensor()) a(wrist_);
  a(loose_);
  for (Controller* controller : {controller_.get(), standby_.get()}) {
    if (controller == nullptr) continue;
    for (double& x : controller->memory()) a(x);
    controller->Archive(a);
  }
}

double ControlledScene::Energy(double t) const noexcept {
  if (const ControllerAnswer* played = taped() ? taped()->played() : nullptr) return played->energy;
  const double kinetic = engine().KineticEnergy();
  double energy = kinetic + carried_->object_model().mass * gravity_ * engine().object_com().z() +
                  engine().MovablePotential() + Acting().StoredEnergy(Input(t));
  if (payload_) {
    const Pose& X_WE = E_.X_W;
    energy -= PayloadShare() * payload_->mass * gravity_ * (X_WE * payload_->center_of_mass).z();
  }
  if (pick_up_) energy -= pick_up_->load() * gravity_ * (X_WO_ * pick_up_->p_OL()).z();
  return energy;
}

}  // namespace predictor
