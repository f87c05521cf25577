#include "simulation/world.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/motion.h"
#include "models/object_model.h"
#include "simulation/controlled_scene.h"
#include "simulation/coupling.h"
#include "simulation/equilibrium.h"
#include "simulation/linearise.h"
#include "simulation/taped_controller.h"

namespace predictor {
namespace {

// Beyond these values, the simulation has diverged, because no arm or load moves that fast.
constexpr double kMaxVelocity = 100;      // of a joint [rad/s, m/s]
constexpr double kMaxAcceleration = 1e6;  // of a joint [rad/s², m/s²]
// A rolling small ball may turn faster than any joint.
constexpr double kMaxMovableVelocity = 1000;  // [rad/s, m/s]

// Returns the largest absolute value and its index. The first NaN counts as the largest.
double Largest(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index* index) {
  double largest = 0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double x = std::fabs(values[i]);
    if (x <= largest) continue;
    largest = x;
    *index = i;
    if (std::isnan(x)) break;
  }
  return largest;
}

Status NotFinite() { return {StopCause::kPhysics, -1, std::nan(""), 0, Quantity::kNotFinite}; }

// Returns the failure of a step whose largest velocity or acceleration is above its limit.
Status Diverged(double value, double limit, Quantity quantity) {
  if (!std::isfinite(value)) return NotFinite();
  return {StopCause::kPhysics, -1, value, limit, quantity};
}

}  // namespace

struct World::Impl {
  explicit Impl(const Scenario& scenario)
      : events(scenario), controlled(scenario, events), hands(scenario.hands()) {
    for (const int h : hands) X_OD[h] = HandlePose(scenario, h);
    SetCoupling(scenario);
    FindEquilibrium(scenario.environment, &controlled);
    controlled.StartController();
    start.resize(engine().state_size());
    saved.resize(start.size());
    if (const Engine* loose = controlled.loose_engine()) saved_loose.resize(loose->state_size());
    PrepareStart();
    Reset();
    SetUp(false);
  }

  void SetUp(bool begins) noexcept {
    if (TapedController* taped = controlled.taped()) taped->SetUp(begins);
  }

  // Returns the result of a function that may change the state of a copy of the engine.
  template <class Function>
  auto Examine(const Function& function) {
    SetUp(true);
    const std::unique_ptr<Engine> copy = engine().Copy();
    const JointVector torque = controlled.torque();
    auto result = function(copy.get());
    controlled.Update(&engine());  // the workspace is shared
    controlled.SetTorque(torque);
    SetUp(false);
    return result;
  }

  LinearModel Linearise(bool contacts) {
    return Examine([&](Engine* copy) {
      return predictor::Linearise(&controlled, copy, state.time, hands, X_OD, contacts);
    });
  }

  Engine& engine() const noexcept { return controlled.engine(); }

  void SetCoupling(const Scenario& scenario) {
    const ObjectModel& body = engine().object_model();
    for (std::size_t h = 0; h < kHands; ++h) {
      const HandleMobility mobility = MobilityAt(body.mass, body.inertia, X_OD[h].p - body.com);
      coupling[h] = Coupling(scenario.coupling, scenario.safety.handle_speed,
                             scenario.safety.handle_rotation_speed, mobility, engine().step());
    }
  }

  // Prepares the state to which Reset returns, which is at rest and without applied forces.
  void PrepareStart() {
    engine().joint_forces().setZero();
    engine().SetObjectWrench(Wrench::Zero());
    engine().velocities().setZero();
    engine().ForgetSolution();
    engine().SetTime(0);
    engine().Save(start);
  }

  std::vector<double>& Saved() noexcept { return controlled.is_loose() ? saved_loose : saved; }

  void TakeHandsOff() noexcept {
    for (int hand = 0; hand < kHands; ++hand) {
      controlled.start_engine().SetHandMass(hand, 0);
      if (Engine* loose = controlled.loose_engine()) loose->SetHandMass(hand, 0);
    }
  }

  void Reset() noexcept {
    controlled.SetLoose(false);
    TakeHandsOff();
    events.Reset();
    controlled.Resume({});
    Restore(start);
    controlled.ResetController();
    controlled.ApplyController(0, &engine());
    state = {};
    object = {};
    end_effector = {};
    UpdateMotion(0);
    Publish();
  }

  // Restores a state and updates all dependent quantities.
  void Restore(const std::vector<double>& from) noexcept {
    engine().Restore(from);
    controlled.Update(&engine());
  }

  // Archives the engine's state and the masses of the hands, which change the engine's scene in
  // direct mode.
  void Archive(StateArchive& a) noexcept {
    bool is_loose = controlled.is_loose();
    Engine* loose = controlled.loose_engine();
    if (loose) a(is_loose);
    if (!a.saves()) {
      controlled.SetLoose(is_loose);
      TakeHandsOff();
    }
    engine().Save(Saved());
    a(Saved());
    for (int hand = 0; hand < kHands; ++hand) {
      double mass = engine().HandMass(hand);
      a(mass);
      if (!a.saves()) engine().SetHandMass(hand, mass);
    }
    controlled.start_engine().ArchiveMasses(a);
    if (loose) loose->ArchiveMasses(a);
    a(controlled, events, object, end_effector, state);
    if (state.cobot_dof != static_cast<int>(controlled.q().size()) ||
        state.movables.count != engine().movables().count)
      a.Fail();
    if (a.saves() || !a.ok()) return;
    controlled.Resume(events.disturbance());
    Restore(Saved());
  }

  // Frees the object, which keeps its motion and the masses of the hands. If a step fails, the
  // world returns to this time.
  void Loosen() noexcept {
    for (int hand = 0; hand < kHands; ++hand) {
      controlled.loose_engine()->SetHandMass(hand, engine().HandMass(hand));
      controlled.start_engine().SetHandMass(hand, 0);
    }
    controlled.Loosen();
    engine().Save(saved_loose);
  }

  Status Step(const WorldInput& input, double dt) noexcept {
    engine().Save(Saved());
    bool changed = false;
    for (int hand = 0; hand < kHands; ++hand) {
      const double mass = input.hand_mass[static_cast<std::size_t>(hand)];
      changed = engine().SetHandMass(hand, mass) || changed;
    }
    if (changed) controlled.Update(&engine());
    if (!events.empty()) controlled.Disturb(events.Update(state, input), engine().time());
    if (controlled.must_loosen()) Loosen();
    const FrameMotion object_before = object;
    const FrameMotion end_effector_before = end_effector;
    const auto wrench_before = state.coupling;
    const long steps = std::lround(dt / engine().step());
    for (long i = 0; i < steps; ++i) {
      const Status status = SubStep(input);
      if (status.ok()) continue;
      Restore(Saved());
      object = object_before;
      end_effector = end_effector_before;
      state.coupling = wrench_before;
      state.controller = controlled.outcome();
      if (controlled.taped()) state.torque = controlled.torque();  // a replay needs it
      return status;
    }
    Publish();
    return Status::Ok();
  }

  Status SubStep(const WorldInput& input) noexcept {
    Engine& world = engine();
    if (!controlled.StepController(world.time())) return controlled.failure();
    if (!controlled.Hold(ApplyWrenches(input)) || !world.Advance()) return NotFinite();
    if (const Status status = CheckResult(); !status.ok()) return status;
    controlled.SenseWrist();
    if (!controlled.Update(&world) || !controlled.Follow()) return NotFinite();
    controlled.AdvanceController(world.time());
    UpdateMotion(1 / world.step());
    return Status::Ok();
  }

  // Returns whether the engine's last step diverged, and what shows it.
  Status CheckResult() const noexcept {
    Engine& world = engine();
    Eigen::Index i = 0;
    const double velocity = Largest(world.velocities(), &i);
    if (!(velocity <= kMaxVelocity))
      return Diverged(velocity, kMaxVelocity,
                      Translates(i) ? Quantity::kSpeed : Quantity::kAngularSpeed);
    const double acceleration = Largest(world.accelerations(), &i);
    if (!(acceleration <= kMaxAcceleration))
      return Diverged(acceleration, kMaxAcceleration,
                      Translates(i) ? Quantity::kAcceleration : Quantity::kAngularAcceleration);
    if (!world.positions().allFinite()) return NotFinite();
    const double movable = Largest(world.movable_velocities(), &i);
    if (!(movable <= kMaxMovableVelocity))  // each one has a linear velocity, then an angular one
      return Diverged(movable, kMaxMovableVelocity,
                      i % 6 < 3 ? Quantity::kSpeed : Quantity::kAngularSpeed);
    return Status::Ok();
  }

  // Returns whether velocity i of the engine is that of a translation.
  bool Translates(Eigen::Index i) const noexcept {
    const Engine::Layout& at = engine().layout();
    if (at.object_v >= 0 && i >= at.object_v && i < at.object_v + 3) return true;
    const RobotModel& robot = controlled.robot();
    for (int j = 0; j < robot.dof(); ++j)
      if (at.v[static_cast<std::size_t>(j)] == i) return robot.is_prismatic(j);
    return false;
  }

  // Applies the wrenches of the hands and of the coupling as one wrench on the object's body, and
  // returns that wrench. All wrenches of hands and coupling act at the handles D.
  Wrench ApplyWrenches(const WorldInput& input) noexcept {
    const Vector3 com = engine().object_com();
    Wrench sum = controlled.is_loose() ? controlled.LandingOf(object) : Wrench::Zero();
    for (Wrench& wrench : state.coupling) wrench.setZero();
    for (const int h : hands) {
      if (!input.present.Has(h)) continue;
      const FrameMotion D = MotionOfFixed(object, X_OD[h]);
      if (input.coupled) state.coupling[h] = coupling[h].Compute(D, input.handle[h]);
      sum += ShiftWrench(input.F_H_W[h] + state.coupling[h], D.X_W.p - com);
    }
    engine().SetObjectWrench(sum);
    return sum;
  }

  // Updates poses and twists. Computes the accelerations as the changes of the twists since the
  // previous ones, times `rate` [1/s].
  void UpdateMotion(double rate) noexcept {
    const FrameMotion O = engine().MotionOf(SceneBody::kObject);
    const FrameMotion& E = controlled.end_effector();
    const Vector6 A_WO = rate * (O.V_W - object.V_W);
    const Vector6 A_WE = rate * (E.V_W - end_effector.V_W);
    object = O;
    object.A_W = A_WO;
    end_effector = E;
    end_effector.A_W = A_WE;
  }

  void Publish() noexcept {
    state.time = engine().time();
    state.cobot_dof = static_cast<int>(controlled.q().size());
    state.q = controlled.q();
    state.v = controlled.v();
    state.torque = controlled.torque();
    state.object = object;
    state.end_effector = end_effector;
    for (const int h : hands) state.handle[h] = MotionOfFixed(object, X_OD[h]);
    state.events = events.active();
    state.latest_event = events.latest();
    state.cobot_stop = static_cast<std::uint8_t>(controlled.cobot_stop());
    state.attachment = controlled.attachment();
    if (engine().movable_positions().size() > 0) state.movables = engine().movables();
    if (const PickUp* pick_up = controlled.pick_up()) {
      state.movables.held = pick_up->held();
      state.movables.grip = pick_up->state();
    }
    state.energy = controlled.Energy(engine().time());
    state.controller = controlled.outcome();
  }

  // Uses a copy, because the solution of a contact depends on the previous solutions.
  ObjectSupport Support() const {
    if (!controlled.start_engine().has_contacts_at_rest()) return {};
    const std::unique_ptr<Engine> copy = controlled.start_engine().Copy();
    copy->Restore(start);
    for (int j = 0; j < state.cobot_dof; ++j)
      copy->joint_forces()[copy->layout().v[static_cast<std::size_t>(j)]] = state.torque[j];
    ObjectSupport support;
    if (!copy->Prepare() || !copy->ComputeAccelerations(false)) return support;
    for (int i = 0; i < copy->contact_count(); ++i) {
      const Contact contact = copy->contact(i);
      const bool of_object = contact.link.empty() && contact.body < 0;
      if (!of_object) continue;
      const bool is_floor = contact.floor;
      (is_floor ? support.floor : support.other) += contact.force_W.z();
      if (contact.fixture >= 0)
        support.fixtures |= std::uint64_t{1} << contact.fixture;
      else
        (is_floor ? support.touches_floor : support.touches_table) = true;
    }
    return support;
  }

  EventSequence events;
  ControlledScene controlled;
  Hands hands;
  std::array<Pose, kHands> X_OD;
  std::array<Coupling, kHands> coupling;
  // The engine's states at the start and before the present step.
  std::vector<double> start, saved, saved_loose;
  FrameMotion object, end_effector;
  WorldState state;
};

World::World(const Scenario& scenario) : impl_(std::make_unique<Impl>(scenario)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

Status World::Step(const WorldInput& input, double dt) noexcept { return impl_->Step(input, dt); }
const WorldState& World::state() const { return impl_->state; }
void World::Reset() noexcept { impl_->Reset(); }
void World::Archive(StateArchive& a) noexcept { impl_->Archive(a); }
void World::Tune(const ControllerTuning& tuning) noexcept {
  impl_->controlled.Tune(tuning, impl_->engine().time());
}
std::vector<std::string> World::joint_names() const {
  std::vector<std::string> names;
  const RobotModel& robot = impl_->controlled.robot();
  names.reserve(static_cast<std::size_t>(robot.dof()));
  for (int j = 0; j < robot.dof(); ++j) names.push_back(robot.joint_name(j));
  return names;
}
std::vector<ContactPair> World::contact_pairs() const {
  return impl_->controlled.start_engine().contact_pairs();
}
double World::object_mass() const { return impl_->engine().object_model().mass; }
const JointVector& World::effort_limit() const { return impl_->controlled.effort_limit(); }
std::string World::EngineFailure() const { return impl_->engine().Failure(); }
std::string World::SceneXml() const { return impl_->controlled.start_engine().SceneText(); }

std::string World::PrioritiseProcess(bool on) { return impl_->controlled.PrioritiseProcess(on); }
void World::SetRealTime(bool real_time) noexcept { impl_->controlled.SetRealTime(real_time); }
void World::Play(const ControllerAnswer& answer) noexcept {
  if (TapedController* taped = impl_->controlled.taped()) taped->Play(answer);
}
std::vector<double> World::ControllerTape() const {
  const TapedController* taped = impl_->controlled.taped();
  if (!taped) return {};
  return {taped->tape().begin(), taped->tape().end()};
}

ObjectSupport World::SupportAtStart() const { return impl_->Support(); }

LinearModel World::Linearise() const { return impl_->Linearise(true); }
LinearModel World::LineariseWithoutContacts() const { return impl_->Linearise(false); }

SampledLoop World::JudgeController() const {
  return impl_->Examine([this](Engine* copy) {
    return JudgeSampledLoop(&impl_->controlled, copy, impl_->state.time);
  });
}

}  // namespace predictor
