#include "simulation/world.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/motion.h"
#include "simulation/controlled_scene.h"
#include "simulation/coupling.h"
#include "simulation/equilibrium.h"
#include "simulation/linearise.h"
#include "simulation/taped_controller.h"

namespace predictor {
namespace {

// Beyond these values, the simulation has diverged: no arm or load moves that fast.
constexpr double kMaxVelocity = 100;      // of a joint [rad/s, m/s]
constexpr double kMaxAcceleration = 1e6;  // of a joint [rad/s², m/s²]

constexpr unsigned kState = mjSTATE_INTEGRATION;

double Largest(const double* values, mjtSize count) {
  double largest = 0;
  for (mjtSize i = 0; i < count; ++i) {
    const double x = std::fabs(values[i]);
    if (!(x <= largest)) largest = x;  // keeps NaN
    if (std::isnan(x)) return x;
  }
  return largest;
}

Status Failure(double value, double limit) {
  Status status;
  status.cause = StopCause::kPhysics;
  status.value = value;
  status.limit = limit;
  return status;
}

}  // namespace

struct World::Impl {
  explicit Impl(const Scenario& scenario)
      : events(scenario),
        controlled(scenario, events),
        carried(mj_makeData(controlled.model())),
        data(carried.get()),
        hands(scenario.hands()) {
    for (const int h : hands) X_OD[h] = scenario.handle(h).pose.ToPose();
    SetCoupling(scenario);
    FindEquilibrium(&controlled, data);
    controlled.StartController(data);
    start.resize(static_cast<std::size_t>(mj_stateSize(controlled.model(), kState)));
    saved.resize(start.size());
    if (const Scene* scene = controlled.loose_scene()) {
      loose.reset(mj_makeData(scene->model.get()));
      saved_loose.resize(static_cast<std::size_t>(mj_stateSize(scene->model.get(), kState)));
    }
    PrepareStart();
    Reset();
    SetUp(false);
  }

  void SetUp(bool begins) noexcept {
    if (TapedController* taped = controlled.taped()) taped->SetUp(begins);
  }

  void SetCoupling(const Scenario& scenario) {
    const ObjectModel& body = controlled.scene().object_model;
    for (std::size_t h = 0; h < kHands; ++h) {
      const HandleMobility mobility = MobilityAt(body.mass, body.inertia, X_OD[h].p - body.com);
      coupling[h] = Coupling(scenario.coupling, scenario.safety.handle_speed,
                             scenario.safety.handle_rotation_speed, mobility,
                             controlled.model()->opt.timestep);
    }
  }

  // Prepares the state to which Reset returns: at rest, without applied forces.
  void PrepareStart() {
    const mjModel* m = controlled.model();
    std::fill_n(data->qfrc_applied, m->nv, 0.0);
    std::fill_n(data->xfrc_applied, 6 * m->nbody, 0.0);
    std::fill_n(data->qvel, m->nv, 0.0);
    std::fill_n(data->qacc_warmstart, m->nv, 0.0);
    data->time = 0;
    mj_getState(m, data, start.data(), kState);
  }

  // Whether the object is carried or free. To be followed by Restore.
  void SetLoose(bool is_loose) noexcept {
    controlled.SetLoose(is_loose);
    data = controlled.is_loose() ? loose.get() : carried.get();
  }
  std::vector<double>& Saved() noexcept { return controlled.is_loose() ? saved_loose : saved; }

  void TakeHandsOff() noexcept {
    for (int hand = 0; hand < kHands; ++hand) {
      SetHandMass(controlled.start_scene(), hand, 0);
      if (loose) SetHandMass(*controlled.loose_scene(), hand, 0);
    }
  }

  void Reset() noexcept {
    SetLoose(false);
    TakeHandsOff();
    events.Reset();
    controlled.Resume({});
    Restore(start);
    controlled.ResetController();
    controlled.ApplyController(0, data);
    state = {};
    object = {};
    end_effector = {};
    UpdateMotion(0);
    Publish();
  }

  // Restores a state and updates all dependent quantities.
  void Restore(const std::vector<double>& from) noexcept {
    mj_resetData(controlled.model(), data);  // clears warnings, and the stack after an error
    mj_setState(controlled.model(), data, from.data(), kState);
    controlled.Update(data);
  }

  // Archives the engine's state, and the hands' masses, by which direct mode changes the engine's
  // model.
  void Archive(StateArchive& a) noexcept {
    bool is_loose = controlled.is_loose();
    if (loose) a(is_loose);
    if (!a.saves()) {
      SetLoose(is_loose);
      TakeHandsOff();
    }
    mjModel* m = controlled.model();
    mj_getState(m, data, Saved().data(), kState);
    a(Saved());
    for (int hand = 0; hand < kHands; ++hand) {
      const int body = controlled.scene().hand[static_cast<std::size_t>(hand)];
      double mass = body < 0 ? 0 : m->body_mass[body];
      a(mass);
      if (!a.saves()) SetHandMass(controlled.scene(), hand, mass);
    }
    // These are sums, archived with their rounding errors.
    ArchiveMasses(controlled.start_scene(), a);
    if (loose) ArchiveMasses(*controlled.loose_scene(), a);
    a(controlled, events, object, end_effector, state);
    if (state.cobot_dof != static_cast<int>(controlled.q().size())) a.Fail();
    if (a.saves() || !a.ok()) return;
    controlled.Resume(events.disturbance());
    Restore(Saved());
  }

  static void ArchiveMasses(const Scene& scene, StateArchive& a) noexcept {
    for (int body = 0; body < scene.model->nbody; ++body) a(scene.model->body_subtreemass[body]);
  }

  // Frees the object, with its motion and the masses of the hands on it. A step that fails returns
  // to this moment.
  void Loosen() noexcept {
    for (int hand = 0; hand < kHands; ++hand) {
      const int body = controlled.scene().hand[static_cast<std::size_t>(hand)];
      if (body < 0) continue;
      SetHandMass(*controlled.loose_scene(), hand, controlled.model()->body_mass[body]);
      SetHandMass(controlled.start_scene(), hand, 0);
    }
    controlled.Loosen(*data, loose.get());
    data = loose.get();
    mj_getState(controlled.model(), data, saved_loose.data(), kState);
  }

  Status Step(const WorldInput& input, double dt) noexcept {
    const double timestep = controlled.model()->opt.timestep;
    mj_getState(controlled.model(), data, Saved().data(), kState);
    bool changed = false;
    for (int hand = 0; hand < kHands; ++hand) {
      const double mass = input.hand_mass[static_cast<std::size_t>(hand)];
      changed = SetHandMass(controlled.scene(), hand, mass) || changed;
    }
    if (changed) controlled.Update(data);
    if (!events.empty()) controlled.Disturb(events.Update(state, input), data->time);
    if (controlled.must_loosen()) Loosen();
    const FrameMotion object_before = object;
    const FrameMotion end_effector_before = end_effector;
    const auto wrench_before = state.coupling;
    const long steps = std::lround(dt / timestep);
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
    mjModel* m = controlled.model();
    if (!controlled.StepController(data->time, data)) return controlled.failure();
    ApplyWrenches(input);
    if (!controlled.HoldObject(data)) return Failure(std::nan(""), 0);
    if (!Guarded(mj_step2, m, data)) return Failure(std::nan(""), 0);
    const double acceleration = Largest(data->qacc, m->nv);
    if (!(acceleration <= kMaxAcceleration)) return Failure(acceleration, kMaxAcceleration);
    const double velocity = Largest(data->qvel, m->nv);
    if (!(velocity <= kMaxVelocity)) return Failure(velocity, kMaxVelocity);
    if (!std::isfinite(Largest(data->qpos, m->nq))) return Failure(std::nan(""), 0);
    controlled.SenseWrist(*data);
    if (!controlled.Update(data)) return Failure(std::nan(""), 0);
    controlled.FollowObject(*data);
    controlled.AdvanceController(data->time);
    UpdateMotion(1 / m->opt.timestep);
    return Status::Ok();
  }

  // Applies the wrenches of the hands and of the coupling, all at the handles D, as one wrench on
  // the object's body.
  void ApplyWrenches(const WorldInput& input) noexcept {
    const Eigen::Map<const Vector3> com(data->xipos + 3 * controlled.scene().object);
    Wrench sum = controlled.is_loose() ? controlled.LandingOf(object) : Wrench::Zero();
    for (Wrench& wrench : state.coupling) wrench.setZero();
    for (const int h : hands) {
      if (!input.present.Has(h)) continue;
      const FrameMotion D = MotionOfFixed(object, X_OD[h]);
      if (input.coupled) state.coupling[h] = coupling[h].Compute(D, input.handle[h]);
      sum += ShiftWrench(input.F_H_W[h] + state.coupling[h], D.X_W.p - com);
    }
    Eigen::Map<Vector6>(data->xfrc_applied + 6 * controlled.scene().object) = sum;
  }

  // Updates poses and twists. Computes accelerations from the difference to the previous twists,
  // times `rate` [1/s].
  void UpdateMotion(double rate) noexcept {
    const FrameMotion O = controlled.Object(*data);
    const FrameMotion E = controlled.EndEffector();
    const Vector6 A_WO = rate * (O.V_W - object.V_W);
    const Vector6 A_WE = rate * (E.V_W - end_effector.V_W);
    object = O;
    object.A_W = A_WO;
    end_effector = E;
    end_effector.A_W = A_WE;
  }

  void Publish() noexcept {
    state.time = data->time;
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
    state.energy = controlled.Energy(data->time, data);
    state.controller = controlled.outcome();
  }

  EventSequence events;
  ControlledScene controlled;
  DataPtr carried, loose;  // of the scenes with a carried and with a free object (may be null)
  mjData* data;            // one of them, at state.time, after its position and velocity stages
  Hands hands;
  std::array<Pose, kHands> X_OD;
  std::array<Coupling, kHands> coupling;
  // Engine states: at the start, before the present step.
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
  impl_->controlled.Tune(tuning, impl_->data->time);
}
std::vector<std::string> World::joint_names() const {
  std::vector<std::string> names;
  const RobotModel& robot = impl_->controlled.robot();
  names.reserve(static_cast<std::size_t>(robot.dof()));
  for (int j = 0; j < robot.dof(); ++j) names.push_back(robot.joint_name(j));
  return names;
}
double World::object_mass() const { return impl_->controlled.scene().object_model.mass; }
const JointVector& World::effort_limit() const { return impl_->controlled.effort_limit(); }
std::string World::SceneXml() const { return SceneText(impl_->controlled.start_scene()); }

void World::SetRealTime(bool real_time) noexcept { impl_->controlled.SetRealTime(real_time); }
void World::Play(const ControllerAnswer& answer) noexcept {
  if (TapedController* taped = impl_->controlled.taped()) taped->Play(answer);
}
std::vector<double> World::ControllerTape() const {
  const TapedController* taped = impl_->controlled.taped();
  if (!taped) return {};
  return {taped->tape().begin(), taped->tape().end()};
}

LinearModel World::Linearise() const {
  Impl& impl = *impl_;
  impl.SetUp(true);
  const DataPtr copy(mj_copyData(nullptr, impl.controlled.model(), impl.data));
  const JointVector torque = impl.controlled.torque();
  LinearModel model =
      predictor::Linearise(&impl.controlled, copy.get(), impl.state.time, impl.hands, impl.X_OD);
  impl.controlled.Update(impl.data);  // the workspace is shared
  impl.controlled.SetTorque(torque);
  impl.SetUp(false);
  return model;
}

}  // namespace predictor
