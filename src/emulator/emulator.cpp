#include "emulator/emulator.h"

#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/motion.h"
#include "emulator/emulator_impl.h"
#include "emulator/placement.h"
#include "emulator/stop_reach.h"
#include "haptics/limits.h"
#include "scenario/located.h"

namespace predictor {
namespace {

constexpr double kAlignRotationSpeed = 0.3;  // [rad/s]

std::array<bool, kHands> SensorHasNoise(const Scenario& s) {
  std::array<bool, kHands> noise = {};
  for (int i = 0; i < kHands; ++i)
    noise[i] = s.mode == Mode::kEmulate && s.Has(i) &&
               (s.HasRealArms() || s.arm(i).sensor.noise_force > 0);
  return noise;
}

std::array<double, kHands> QuietForces(const Scenario& s) {
  std::array<double, kHands> quiet = {};
  for (int i = 0; i < kHands; ++i)
    if (s.mode == Mode::kEmulate && s.Has(i))
      quiet[i] = HandEstimator::QuietDeviation(s.arm(i).sensor).head<3>().maxCoeff();
  return quiet;
}

std::array<SamplePeriods, kHands> PeriodsOf(const Scenario& s) {
  std::array<SamplePeriods, kHands> periods;
  for (int i = 0; i < kHands; ++i)
    if (s.mode == Mode::kEmulate && s.Has(i))
      periods[i] = {1 / s.arm(i).sample_rate, 1 / s.arm(i).sensor.sample_rate};
  return periods;
}

Twist TwistOf(const Jacobian& J, const JointVector& v) {
  Twist V = Twist::Zero();
  for (int j = 0; j < J.cols(); ++j) V += J.col(j) * v[j];
  return V;
}

}  // namespace

Emulator::Impl::Impl(const Scenario& s, std::unique_ptr<Device> real_arms)
    : scenario(s),
      dt(1 / s.rate),
      direct(s.mode == Mode::kDirect),
      world(s),
      monitor(s.safety, s.rendering, SensorHasNoise(s), 1 / s.rate, PeriodsOf(s), s.HasRealArms()),
      warnings(QuietForces(s), 1 / s.rate),
      stopper(s.safety, {}, 1 / s.rate),
      parameters(s) {
  setup.object_start = world.state().object.X_W.p;
  setup.cobot_joints = world.joint_names();
  for (int i = 0; i < kHands; ++i) present[i] = s.Has(i);
  if (direct) {
    person = MakeOperator(s, HandInertia::kInScene);
    setup.device = "none: the hands act on the object's own handles";
    return;
  }
  std::array<std::shared_ptr<const RobotModel>, kHands> models;
  std::array<FrameId, kHands> frames;
  std::array<JointBounds, kHands> bounds;
  std::array<double, kHands> lags = {}, coasting = {};
  double reaction = 0;
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    arms[i].emplace(s, i, dt);
    lags[i] = HapticLoop::Lag(s.arm(i).loop, dt);
    coasting[i] = CoastingOf(s.arm(i), dt);
    models[i] = arms[i]->model();
    frames[i] = arms[i]->handle_frame();
    const ArmLimits limits = LimitsOf(s.arm(i), *models[i]);
    bounds[i] = {limits.lower, limits.upper, limits.velocity, limits.acceleration};
    reaction = std::max(reaction, ReactionTime(s.arm(i).loop) + dt);
    lower[i] = limits.lower;
    upper[i] = limits.upper;
    fastest[i] = limits.velocity;
  }
  const std::array<Pose, kHands> X_WD = {world.state().handle[0].X_W, world.state().handle[1].X_W};
  setup.start = PlaceArms(s, models, frames, X_WD, 0);
  const HapticLoop loop(world.Linearise(), s, dt);
  setup.lead = ChooseLead(loop, s, dt);
  renderer.emplace(s, models, setup.lead.lead, dt);
  recovery.emplace(s, models);
  guard = Guard(bounds, dt, reaction);
  stopper = StopController(s.safety, bounds, dt, lags, coasting);
  device = real_arms
               ? std::move(real_arms)
               : MakeSimulatedDevice(s, PlaceArms(s, models, frames, X_WD, s.rig.start_offset));
  rig = dynamic_cast<const SimulatedDevice*>(device.get());
  setup.device = device->Describe();
  setup.simulated = rig != nullptr;
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    for (JointVector* x : {&command.v[i], &rendered.v[i], &sample.arms[i].q, &sample.arms[i].v})
      x->setZero(models[i]->dof());
  }
}

// ---- the tick ----------------------------------------------------------------------------------

void Emulator::Impl::Tick(std::uint64_t wall_ns, int deadlines_missed) noexcept {
  timer.Start();
  missed = static_cast<std::uint32_t>(std::max(0, deadlines_missed));
  TakeRequests();
  reading = writing = sensing = simulation = haptics = Status::Ok();
  before = world.state();
  if (!direct) reading = device->Read(&sample);
  if (rig) hands = rig->rig().true_operator();
  timer.Lap(Stage::kRead);
  if (direct)
    ActDirectly();
  else
    Sense(&sensing);
  timer.Lap(Stage::kSense);
  waiting = Waits();
  ran = StateMachine::TimePasses(states.state()) && !waiting;
  FollowParameters();
  if (ran) Simulate(&simulation);
  timer.Lap(Stage::kSimulate);
  solved = Renders();
  if (solved) Render(&haptics);
  timer.Lap(Stage::kRender);
  const Status wrong = Doubt();
  well_time = wrong.ok() ? well_time + dt : 0;
  Judge(wrong);
  Judge(CheckEnabling());
  Warn();
  timer.Lap(Stage::kMonitor);
  Command();
  timer.Lap(Stage::kGuard);
  if (!direct) Write();
  timer.Lap(Stage::kWrite);
  Record(wall_ns);
  Advance();
  FollowEnablingDevice();
}

void Emulator::Impl::Write() noexcept {
  command.state = states.state();
  command.run_time = run_time;
  command.hands = hand_inputs;
  writing = device->Write(command);
  if (!writing.ok()) Judge(writing);
}

// What the monitor makes of the tick so far.
Status Emulator::Impl::Doubt() noexcept {
  MonitorInput input;
  input.present = present;
  input.sample = direct ? nullptr : &sample;
  input.wrench = wrench;
  input.real = real;
  for (int i = 0; i < kHands; ++i) input.virtual_[i] = before.handle[i];
  input.world = &world.state();
  input.render = solved ? &rendered : nullptr;
  input.lower = lower;
  input.upper = upper;
  input.velocity = fastest;
  input.device = reading;
  input.sensing = sensing;
  input.simulation = simulation;
  input.haptics = haptics;
  input.running = states.state() == RunState::kRun;
  input.missed_deadlines =
      rig || direct ? 0 : static_cast<int>(missed);  // a simulated rig waits with us
  input.follows = states.state() == RunState::kAlign || states.state() == RunState::kRun;
  input.recovers = states.state() == RunState::kRecovery;
  return monitor.Check(input);
}

void Emulator::Impl::Sense(Status* status) noexcept {
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    ArmSide& arm = *arms[i];
    Status s = arm.Update(sample.arms[i]);
    if (s.ok() && states.state() == RunState::kSelfTest) s = arm.Tare(sample.arms[i]);
    if (!s.ok() && status->ok()) {
      *status = s;
      status->hand = static_cast<std::int8_t>(i);
    }
    real[i] = arm.handle();
    wrench[i] = arm.wrench();
    // Before its bias is known a reading says nothing of the hand.
    if (!tared || states.state() == RunState::kSelfTest) wrench[i] = {};
  }
}

// Direct mode: what a sensor between hand and handle would read is the hand's own effort less the
// inertia of the hand, which is part of the scene.
void Emulator::Impl::ActDirectly() noexcept {
  OperatorInput input;
  input.dt = dt;
  input.run_time = run_time;
  input.running = states.state() == RunState::kRun;
  input.present = present;
  input.handle = before.handle;
  input.hands = hand_inputs;
  person->Step(input, &hands);
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    real[i] = before.handle[i];
    wrench[i].present = true;
    wrench[i].F_H_W = hands.F_H_W[i];
    wrench[i].F_H_W.head<3>() -= hands.hand_mass[i] * before.handle[i].A_W.head<3>();
  }
}

void Emulator::Impl::Simulate(Status* status) noexcept {
  WorldInput input;
  input.present = present;
  input.coupled = !direct;
  input.handle = real;
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    input.F_H_W[i] = direct ? hands.F_H_W[i] : wrench[i].F_H_W;
    input.hand_mass[i] = direct ? hands.hand_mass[i] : 0;
  }
  if (!reading.ok() || !sensing.ok()) return;  // a wrench in doubt never enters the physics
  *status = world.Step(input, dt);
}

void Emulator::Impl::Warn() noexcept {
  if (direct) return;
  const RunState state = states.state();
  WarningInput input;
  input.present = present;
  input.sample = &sample;
  input.wrench = wrench;
  input.rests = state == RunState::kIdle || state == RunState::kArmed || state == RunState::kHeld ||
                state == RunState::kUnpowered;
  warnings.Follow(input);
}

std::array<RenderArm, kHands> Emulator::Impl::View() const noexcept {
  std::array<RenderArm, kHands> view;
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    const ArmSide& arm = *arms[i];
    view[i] = {true, arm.model().get(), &arm.data(), &arm.ahead(), arm.handle_frame(), &arm.q()};
  }
  return view;
}

// While the key is held; without it the arms come to rest by the guard's bounds, and when nothing
// is left to undo RECOVERY is over.
void Emulator::Impl::Recover() noexcept {
  for (int i = 0; i < kHands; ++i)
    if (present[i]) arms[i]->LookAhead(guard.last()[i]);
  if (Enabled() && !waiting) return recovery->Step(View(), wrench, &command.v);
  for (auto& v : command.v) v.setZero();
}

// What a handle may do in this state. A stop has a profile of its own.
HandleCap Emulator::Impl::Cap() const noexcept {
  switch (states.state()) {
    case RunState::kAlign:
      return {scenario.safety.align_speed, kAlignRotationSpeed};
    case RunState::kRun:
      return {scenario.safety.handle_speed, scenario.safety.handle_rotation_speed};
    case RunState::kRecovery:
      return {Recovery::kHandleSpeed, Recovery::kHandleSpeed / Recovery::kLength};
    default:
      return {HUGE_VAL, HUGE_VAL};
  }
}

void Emulator::Impl::Render(Status* status) noexcept {
  RenderTarget target;
  target.aligning = states.state() == RunState::kAlign;
  target.speed_cap = Cap().speed;
  target.rotation_cap = Cap().rotation;
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    arms[i]->LookAhead(guard.last()[i]);
    // Poses at the time of the sample, so that their difference is the error; motion after the
    // step.
    target.handle[i] = before.handle[i];
    target.handle[i].V_W = target.aligning ? Twist(Twist::Zero()) : world.state().handle[i].V_W;
    target.handle[i].A_W = world.state().handle[i].A_W;
  }
  *status = renderer->Render(View(), target, guard.last(), &rendered);
}

// Whatever asked for the command: no handle is told to go faster than it may in this state. Returns
// how many joints that altered.
int Emulator::Impl::KeepToCap(const std::array<Jacobian, kHands>& J) noexcept {
  const HandleCap cap = Cap();
  double factor = 1;
  for (int i = 0; i < kHands; ++i) {
    if (!present[i] || command.v[i].size() != J[i].cols()) continue;
    const Twist V = TwistOf(J[i], command.v[i]);
    factor = std::min({factor, cap.speed / std::max(1e-12, V.head<3>().norm()),
                       cap.rotation / std::max(1e-12, V.tail<3>().norm())});
  }
  // Recovery heeds no acceleration: where the guard cut each joint's by itself, the handles would
  // go another way than either command, and maybe faster.
  return factor < 1 || states.state() == RunState::kRecovery ? guard.Slow(factor, &command.v) : 0;
}

void Emulator::Impl::Command() noexcept {
  switch (states.state()) {
    case RunState::kRun:
    case RunState::kAlign:
      command.v = rendered.v;
      if (aligned || waiting)
        for (auto& v : command.v) v.setZero();
      break;
    case RunState::kStopping:
      Brake();
      break;
    case RunState::kRecovery:
      Recover();
      break;
    default:
      for (auto& v : command.v) v.setZero();
  }
  record.guard_altered = 0;
  if (direct) return;
  // The last joints that were believed: what is wrong with a sample has stopped the arms already,
  // and must not replace the stop's profile by the guard's own braking.
  std::array<JointVector, kHands> q;
  for (int i = 0; i < kHands; ++i)
    if (arms[i]) q[i] = arms[i]->q();
  // As the command will be obeyed: rendering and braking have looked ahead in this tick.
  std::array<Jacobian, kHands> J;
  for (int i = 0; i < kHands; ++i)
    if (present[i])
      arms[i]->ahead().FrameJacobian(*arms[i]->model(), arms[i]->handle_frame(), &J[i]);
  const int slowed = KeepToCap(J);
  const bool braking = states.state() == RunState::kStopping;
  record.guard_altered = static_cast<std::uint8_t>(
      std::max(slowed, guard.Apply(q, &command.v, braking ? TicksPassed() : 1)));
  double speed = 0;
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    Twist& V = handle_twist[i];
    V = TwistOf(J[i], guard.last()[i]);
    speed = std::max(speed, StopSpeed(V));
  }
  handle_rate = (speed - handle_speed) / dt;
  handle_speed = speed;
  stopper.Observe({real[0].X_W, real[1].X_W}, InMotion());
}

// ---- the interface -----------------------------------------------------------------------------

Emulator::Emulator(const Scenario& scenario, std::unique_ptr<Device> device) try
    : impl_(std::make_unique<Impl>(scenario, std::move(device))) {
} catch (const InputError& error) {
  throw Located(error, scenario);
}
Emulator::~Emulator() = default;
void Emulator::Tick(std::uint64_t wall_ns, int missed) noexcept { impl_->Tick(wall_ns, missed); }
bool Emulator::Submit(const RunInput& input) noexcept { return impl_->Submit(input); }
bool Emulator::HasRoomForInput() const noexcept { return impl_->input_count < kInputsPerTick; }
void Emulator::Request(RunEvent event) noexcept {
  impl_->requests.fetch_or(1U << static_cast<int>(event), std::memory_order_release);
}
void Emulator::RequestEnd() noexcept {
  impl_->end_requested.store(true, std::memory_order_release);
}
std::size_t Emulator::SaveState(std::span<std::byte> to) noexcept {
  StateArchive archive = StateArchive::ToSave(to);
  impl_->Archive(archive);
  return archive.ok() ? archive.used() : 0;
}
void Emulator::LoadState(std::span<const std::byte> from) {
  StateArchive archive = StateArchive::ToLoad(from);
  impl_->Archive(archive);
  if (archive.ok() && archive.used() == from.size()) return;
  throw InputError("The saved state (" + std::to_string(from.size()) +
                   " bytes) is not one of this scenario and this version of the program. Use the "
                   "version that wrote it.");
}
const TickRecord& Emulator::record() const { return impl_->record; }
RunState Emulator::state() const { return impl_->states.state(); }
StopLevel Emulator::level() const { return impl_->states.level(); }
double Emulator::run_time() const { return impl_->run_time; }
const StopReport& Emulator::stop() const { return impl_->stopper.report(); }
const EmulatorSetup& Emulator::setup() const { return impl_->setup; }
const Scenario& Emulator::scenario() const { return impl_->scenario; }
double Emulator::dt() const { return impl_->dt; }

}  // namespace predictor
