#include "emulator/emulator.h"

#include <cmath>
#include <utility>

#include "core/error.h"
#include "emulator/emulator_impl.h"
#include "emulator/placement.h"
#include "haptics/limits.h"
#include "scenario/located.h"

namespace predictor {
namespace {

constexpr double kTareTime = 0.3;                            // sensors are averaged, hands off [s]
constexpr int kTareTicks = HandEstimator::kTareSamples + 1;  // at least
constexpr double kAlignRotationSpeed = 0.3;                  // [rad/s]
constexpr double kAlignedWell = 1e-4;  // aligning ends early below this [m], and half of it as
constexpr double kAlignedWellRotation = 1e-3;  // an angle [rad]
constexpr double kTrustedAge = 0.010;          // of a sample by which a stop follows an arm [s]
constexpr double kAlignPatience = 3;           // or when within tolerance after this time [s]
constexpr double kEnablingSigns = 0.02;        // between signs of an enabling device [s]

std::array<bool, kHands> SensorHasNoise(const Scenario& s) {
  std::array<bool, kHands> noise = {};
  for (int i = 0; i < kHands; ++i)
    noise[i] = s.mode == Mode::kEmulate && s.Has(i) && s.arm(i).sensor.noise_force > 0;
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

}  // namespace

Emulator::Impl::Impl(const Scenario& s, std::unique_ptr<Device> real_arms)
    : scenario(s),
      dt(1 / s.rate),
      direct(s.mode == Mode::kDirect),
      world(s),
      monitor(s.safety, s.rendering, SensorHasNoise(s), 1 / s.rate, PeriodsOf(s),
              s.device.type != "simulated"),
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
  std::array<double, kHands> lags = {};
  double reaction = 0;
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    arms[i].emplace(s, i, dt);
    lags[i] = HapticLoop::Lag(s.arm(i).loop, dt);
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
  stopper = StopController(s.safety, bounds, dt, lags);
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
  ran = StateMachine::TimePasses(states.state());
  FollowParameters();
  if (ran) Simulate(&simulation);
  timer.Lap(Stage::kSimulate);
  solved = Renders();
  if (solved) Render(&haptics);
  timer.Lap(Stage::kRender);
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
  input.missed_deadlines = rig || direct ? 0 : deadlines_missed;  // a simulated rig waits with us
  input.follows = states.state() == RunState::kAlign || states.state() == RunState::kRun;
  input.recovers = states.state() == RunState::kRecovery;
  const Status wrong = monitor.Check(input);
  well_time = wrong.ok() ? well_time + dt : 0;
  Judge(wrong);
  Judge(CheckEnabling());
  Warn();
  timer.Lap(Stage::kMonitor);
  Command();
  timer.Lap(Stage::kGuard);
  if (!direct) {
    command.state = states.state();
    command.run_time = run_time;
    command.hands = hand_inputs;
    writing = device->Write(command);
    if (!writing.ok()) Judge(writing);
  }
  timer.Lap(Stage::kWrite);
  Record(wall_ns);
  Advance();
  FollowEnablingDevice();
}

// ---- what people and pages put in ---------------------------------------------------------------

bool Emulator::Impl::Submit(const RunInput& input) noexcept {
  if (input_count >= kInputsPerTick || !Take(input)) return false;
  inputs[static_cast<std::size_t>(input_count++)] = input;
  return true;
}

// Nothing of it is trusted: it may come from another process.
bool Emulator::Impl::Take(const RunInput& input) noexcept {
  const auto ask = [this](RunEvent event) {
    requests.fetch_or(1U << static_cast<int>(event), std::memory_order_release);
    return true;
  };
  switch (input.kind) {
    case InputKind::kStop:
      return ask(RunEvent::kStopRequested);
    case InputKind::kAlign:
      return setup.simulated && ask(RunEvent::kAlignRequested);
    case InputKind::kStart:
      return setup.simulated && ask(RunEvent::kStartRequested);
    case InputKind::kReset:
      return setup.simulated && ask(RunEvent::kReset);
    case InputKind::kParameter:
      return parameters.Set(input.parameter, input.value);
    case InputKind::kHand:
      return TakeHand(input);
    case InputKind::kHeadset:
      if (!(input.value > 0)) return false;
      headset = {StopCause::kHeadset, -1, input.value, kHeadsetSilence};
      return true;
    case InputKind::kEnable:
      if (setup.simulated) return false;
      enabling_age = input.value > 0 ? 0 : HUGE_VAL;
      return true;
    case InputKind::kLatency:
    case InputKind::kMarker:
      return true;
    default:
      return false;
  }
}

bool Emulator::Impl::TakeHand(const RunInput& input) noexcept {
  constexpr double kReach = 5;  // no hand is farther from the origin [m]
  if (scenario.operator_.type != "browser" || input.hand >= kHands || !present[input.hand])
    return false;
  const PoseRecord said{input.p, input.q};
  double norm = 0;
  for (const double x : input.q) norm += x * x;
  double distance = 0;
  for (const double x : input.p) distance += x * x;
  if (!(std::abs(norm - 1) < 1e-3) || !(distance < kReach * kReach)) return false;
  HandInput& hand = hand_inputs[input.hand];
  hand.X_WH = FromRecord(said);
  hand.X_WH.q.normalize();
  hand.grip = input.grip != 0;
  hand.age = 0;
  return true;
}

void Emulator::Impl::FollowParameters() noexcept {
  if (!ran || !parameters.Step(dt)) return;
  world.Tune({parameters[Parameter::kStiffnessTranslation],
              parameters[Parameter::kStiffnessRotation], parameters[Parameter::kDampingRatio]});
  monitor.SetThresholds(parameters[Parameter::kForceThreshold],
                        parameters[Parameter::kTorqueThreshold]);
}

// Stops first, the most severe before the others, and in any state: what follows is the table's to
// say. Whatever else was asked for in the same tick as a stop is not done.
void Emulator::Impl::TakeRequests() noexcept {
  const std::uint32_t bits = requests.exchange(0, std::memory_order_acquire);
  const bool end = end_requested.exchange(false, std::memory_order_acquire);
  const auto has = [bits](RunEvent event) { return (bits >> static_cast<int>(event) & 1U) != 0; };
  asked = static_cast<std::uint16_t>(bits | (end ? kEndRequest : 0U));
  record.refused = record.why_refused = 0;
  if (has(RunEvent::kStopAndPowerOff)) return StopOnRequest(RunEvent::kStopAndPowerOff);
  if (const Status silent = std::exchange(headset, Status::Ok()); !silent.ok()) Judge(silent);
  if (has(RunEvent::kStopRequested)) return StopOnRequest(RunEvent::kStopRequested);
  if (end && StateMachine::MayMove(states.state()) && latched.ok())
    return BeginStop(Status::Ok(), RunEvent::kStopRequested);
  for (const RunEvent event : {RunEvent::kReset, RunEvent::kRecoverRequested,
                               RunEvent::kAlignRequested, RunEvent::kStartRequested})
    if (has(event)) Obey(event);
}

// A cause that is known already stays the cause.
void Emulator::Impl::StopOnRequest(RunEvent stop) noexcept {
  const bool at_rest = states.state() == RunState::kHeld || states.state() == RunState::kUnpowered;
  if (!at_rest && latched.ok()) latched = {StopCause::kOperator};
  BeginStop(latched, stop);
}

bool Emulator::Impl::HandsFree() const noexcept {
  for (int i = 0; i < kHands; ++i)
    if (present[i] && (wrench[i].F_H_W.head<3>().norm() > kFreeForce ||
                       wrench[i].F_H_W.tail<3>().norm() > kFreeTorque))
      return false;
  return true;
}

// What stands in the way of a request that the table would grant.
Refusal Emulator::Impl::WhyNot(RunEvent event) const noexcept {
  const RunState state = states.state();
  if (event == RunEvent::kReset) {
    if (setup.simulated || (state != RunState::kHeld && state != RunState::kUnpowered))
      return Refusal::kNone;
    if (!HandsFree()) return Refusal::kHandLoaded;
    return well_time < kCauseAbsent ? Refusal::kCauseRemains : Refusal::kNone;
  }
  if (!Enabled()) return Refusal::kNotEnabled;
  if (direct || event != RunEvent::kAlignRequested || state != RunState::kIdle)
    return Refusal::kNone;
  if (!setup.simulated && !HandsFree()) return Refusal::kNotFree;
  const Beyond beyond = recovery->Find(View());
  return beyond == Beyond::kJoint   ? Refusal::kBeyondJoint
         : beyond == Beyond::kLinks ? Refusal::kBeyondLinks
                                    : Refusal::kNone;
}

// Asked at the wrong time, the table's answer to a request may be a stop.
void Emulator::Impl::Obey(RunEvent event) noexcept {
  if (direct && event == RunEvent::kRecoverRequested) return;  // no arms that could be beyond
  if (const Refusal why = WhyNot(event); why != Refusal::kNone) {
    record.refused = static_cast<std::uint8_t>(1 + static_cast<int>(event));
    record.why_refused = static_cast<std::uint8_t>(why);
    return;
  }
  if (!states.Handle(event)) return;
  state_time = 0;
  const RunState now = states.state();
  if (now == RunState::kStopping) {
    latched = {StopCause::kOperator};
    BeginStop(latched, RunEvent::kStopAndPowerOff);
  } else if (event == RunEvent::kReset) {
    ResetRun();
  } else if (now == RunState::kRecovery) {
    stopper.Reset();
    handle_speed = handle_rate = 0;
  }
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

Status Emulator::Impl::CheckEnabling() const noexcept {
  const RunState state = states.state();
  if (Enabled() || (state != RunState::kAlign && state != RunState::kRun)) return Status::Ok();
  return {StopCause::kEnabling, -1, std::min(enabling_age, kEnablingSilence + dt),
          kEnablingSilence};
}

// Its signs are inputs of the next tick, as a key's are: so they are recorded. One that is pressed
// when the program begins, or still is after a stop, may be jammed or taped: it counts once it has
// been let go. In silence no sign comes, and the time-out lets go.
void Emulator::Impl::FollowEnablingDevice() noexcept {
  const Enabling now = device ? device->enabling() : Enabling::kNone;
  if (now == Enabling::kNone || now == Enabling::kSilent) return;
  if (states.state() == RunState::kStopping) was_released = false;
  if (now == Enabling::kReleased) was_released = true;
  const bool holds = now == Enabling::kPressed && was_released;
  pressed_time += dt;
  if (holds == pressed && !(holds && pressed_time >= kEnablingSigns)) return;
  pressed = holds;
  pressed_time = 0;
  RunInput sign;
  sign.kind = InputKind::kEnable;
  sign.value = holds ? 1 : 0;
  Submit(sign);
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
  if (Enabled()) return recovery->Step(View(), wrench, &command.v);
  for (auto& v : command.v) v.setZero();
}

void Emulator::Impl::Render(Status* status) noexcept {
  RenderTarget target;
  target.aligning = states.state() == RunState::kAlign;
  target.speed_cap = target.aligning ? scenario.safety.align_speed : scenario.safety.handle_speed;
  target.rotation_cap =
      target.aligning ? kAlignRotationSpeed : scenario.safety.handle_rotation_speed;
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

// Acts on what the monitor found: the first doubt stops the arms, in this tick. At rest after a run
// that ended without a cause, what could be held is left to the reset.
void Emulator::Impl::Judge(const Status& wrong, RunEvent stop) noexcept {
  if (wrong.power_off) stop = RunEvent::kStopAndPowerOff;
  if (wrong.ok()) return;
  if (!latched.ok() && !FollowsTask(states.state())) return Escalate(stop);
  const RunState state = states.state();
  if (state == RunState::kInit || state == RunState::kUnpowered) return;
  if (state == RunState::kHeld && stop != RunEvent::kStopAndPowerOff) return;
  latched = wrong;
  BeginStop(wrong, stop);
}

// What comes on top of a stop's cause can only make its end harder.
void Emulator::Impl::Escalate(RunEvent stop) noexcept {
  if (stop == RunEvent::kStopAndPowerOff && states.level() == StopLevel::kHold) states.Handle(stop);
}

// A stop under way goes on as it is; its cause may come to be known late, its end be made harder.
void Emulator::Impl::BeginStop(const Status& cause, RunEvent stop) noexcept {
  if (states.Handle(stop)) state_time = 0;
  if (states.state() != RunState::kStopping) return;
  if (!stopper.active()) doubtful = false;
  stopper.Begin(cause, run_time, guard.last(), handle_speed, handle_rate, &handle_twist);
}

// Since the last command, for a stop to keep its time: an arm went on meanwhile. What takes longer
// than the deadlines that stop is left to the controllers.
int Emulator::Impl::TicksPassed() const noexcept {
  if (rig || direct) return 1;  // they wait with us
  return 1 + std::min(static_cast<int>(missed), Monitor::kMissedDeadlines);
}

void Emulator::Impl::Brake() noexcept {
  StopGeometry geometry;
  geometry.measured = true;
  for (int i = 0; i < kHands; ++i) {
    if (!arms[i]) continue;
    ArmSide& arm = *arms[i];
    const ArmSample& measured = sample.arms[i];
    geometry.V_W[i] = real[i].V_W;
    geometry.measured = geometry.measured && !measured.fault && measured.arm_age <= kTrustedAge;
    arm.LookAhead(guard.last()[i]);
    arm.ahead().FrameJacobian(*arm.model(), arm.handle_frame(), &geometry.J[i]);
    geometry.p_WH[i] = arm.ahead().FramePose(*arm.model(), arm.handle_frame()).p;
  }
  doubtful = doubtful || latched.cause == StopCause::kDevice || monitor.jumped();
  if (doubtful) return stopper.Next(&command.v, TicksPassed());
  stopper.Next(geometry, &command.v, TicksPassed());
}

void Emulator::Impl::Command() noexcept {
  switch (states.state()) {
    case RunState::kRun:
    case RunState::kAlign:
      command.v = rendered.v;
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
  const bool braking = states.state() == RunState::kStopping;
  record.guard_altered =
      static_cast<std::uint8_t>(guard.Apply(q, &command.v, braking ? TicksPassed() : 1));
  // As the command will be obeyed: rendering and braking have looked ahead in this tick.
  double speed = 0;
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    Jacobian J;
    arms[i]->ahead().FrameJacobian(*arms[i]->model(), arms[i]->handle_frame(), &J);
    Twist& V = handle_twist[i];
    V.setZero();
    for (int j = 0; j < J.cols(); ++j) V += J.col(j) * guard.last()[i][j];
    speed = std::max(
        {speed, V.head<3>().norm(), scenario.rendering.rotation_length * V.tail<3>().norm()});
  }
  handle_rate = (speed - handle_speed) / dt;
  handle_speed = speed;
  stopper.Observe({real[0].X_W.p, real[1].X_W.p});
}

bool Emulator::Impl::Aligned() const noexcept {
  double position = 0;
  double rotation = 0;
  for (int i = 0; i < kHands; ++i) {
    if (!present[i]) continue;
    position = std::max(position, (before.handle[i].X_W.p - real[i].X_W.p).norm());
    rotation = std::max(rotation, RotationError(before.handle[i].X_W.q, real[i].X_W.q).norm());
  }
  if (position > scenario.safety.align_tolerance ||
      rotation > scenario.safety.align_tolerance_rotation)
    return false;
  if ((position >= kAlignedWell || rotation >= kAlignedWellRotation) &&
      state_time <= kAlignPatience)
    return false;
  return guard.MayRestNext();  // ARMED moves nothing, not even to brake
}

// What follows by itself from a tick: time, and the steps between states that need no person.
void Emulator::Impl::Advance() noexcept {
  const RunState state = states.state();
  if (ran) run_time += dt;
  for (HandInput& hand : hand_inputs) hand.age += dt;
  enabling_age += dt;
  input_count = 0;
  state_time += dt;
  bool changed = false;
  if (state == RunState::kInit) {
    changed = states.Handle(RunEvent::kStarted);
    BeginTare();
  } else if (state == RunState::kSelfTest &&
             (direct || state_time >= std::max(kTareTime, kTareTicks * dt))) {
    Status quiet;
    for (auto& arm : arms)
      if (const Status side = arm ? arm->FinishTare() : Status::Ok(); !side.ok()) quiet = side;
    if (quiet.ok())
      tared = changed = states.Handle(RunEvent::kSelfTestPassed);
    else
      Judge(quiet);
  } else if (state == RunState::kAlign && Aligned()) {
    changed = states.Handle(RunEvent::kAligned);
  } else if (state == RunState::kStopping && (direct || stopper.done())) {
    changed = states.Handle(RunEvent::kStandstill);
  } else if (state == RunState::kRecovery && Recovered()) {
    changed = states.Handle(RunEvent::kRecovered);
  }
  if (changed) state_time = 0;
}

// The key is let go (with a simulated rig: nothing is left to do), the arms rest, and nothing is
// beyond any more. Out of a stop it may end before that: there the reset asks again.
bool Emulator::Impl::Recovered() const noexcept {
  for (const JointVector& v : guard.last())
    if ((v.array() != 0).any()) return false;
  if (!setup.simulated && Enabled()) return false;
  return states.level() == StopLevel::kHold || recovery->Find(View()) == Beyond::kNothing;
}

void Emulator::Impl::BeginTare() noexcept {
  for (auto& arm : arms)
    if (arm) arm->BeginTare();
}

// Back to the scenario's start; nothing moves by it.
void Emulator::Impl::ResetRun() noexcept {
  latched = Status::Ok();
  run_time = state_time = well_time = 0;
  world.Reset();
  parameters.Reset();
  monitor.SetThresholds(parameters[Parameter::kForceThreshold],
                        parameters[Parameter::kTorqueThreshold]);
  monitor.Reset();
  hand_inputs.fill(HandInput());
  stopper.Reset();
  guard.Reset();
  if (renderer) renderer->Reset();
  if (person) person->Reset();
  for (auto& arm : arms)
    if (arm) arm->Reset();
  BeginTare();  // for a reset that leads through SELFTEST
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
double Emulator::run_time() const { return impl_->run_time; }
const StopReport& Emulator::stop() const { return impl_->stopper.report(); }
const EmulatorSetup& Emulator::setup() const { return impl_->setup; }
const Scenario& Emulator::scenario() const { return impl_->scenario; }
double Emulator::dt() const { return impl_->dt; }

}  // namespace predictor
