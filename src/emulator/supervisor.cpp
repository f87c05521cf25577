// Performs the checks of a tick, the stops, and those transitions between states that do not need a
// person.
#include "emulator/supervisor.h"

#include <algorithm>

#include "core/motion.h"
#include "sensing/hand_estimator.h"

namespace predictor {
namespace {

constexpr double kInitPatience = 0.2;  // longest wait for fresh samples in INIT [s]
constexpr double kTareTime = 0.3;      // duration of averaging the sensors with hands off [s]
constexpr int kMinTareTicks = HandEstimator::kTareSamples + 1;
// ALIGN ends early when the errors of all handles are at most these values [m], [rad], ...
constexpr double kAlignedWell = 1e-4, kAlignedWellRotation = 1e-3;
// ... and after this time [s] if all errors are within the scenario's tolerance.
constexpr double kAlignPatience = 3;
constexpr double kAlignRotationSpeed = 0.3;  // [rad/s]

std::array<bool, kHands> SensorHasNoise(const Scenario& s) {
  std::array<bool, kHands> noise = {};
  for (int i = 0; i < kHands; ++i)
    noise[i] = s.mode == Mode::kEmulate && s.Has(i) &&
               (RulesFor(s).sensors_always_have_noise || s.arm(i).sensor.noise_force > 0);
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

// Returns whether a driver still moves its arm by itself.
bool InMotion(const DeviceSample& sample) {
  return sample.arms[0].in_motion || sample.arms[1].in_motion;
}

}  // namespace

Supervisor::Supervisor(const Scenario& s, const ArmsSpec& arms)
    : rules_(RulesFor(s)),
      safety_(s.safety),
      dt_(1 / s.rate),
      direct_(s.mode == Mode::kDirect),
      browser_operator_(s.operator_.type == "browser"),
      hands_(s.hands()),
      bounds_(arms.bounds),
      monitor_(s.safety, s.rendering, SensorHasNoise(s), dt_, PeriodsOf(s), rules_.detects_runaway),
      warnings_(QuietForces(s), dt_),
      stopper_(s.safety, arms.bounds, dt_, arms.lags, arms.overruns),
      parameters_(s) {}

// ---- the plan of a tick ------------------------------------------------------------------------

HandleCap Supervisor::Cap() const noexcept {
  switch (states_.state()) {
    case RunState::kAlign:
      return {safety_.align_speed, kAlignRotationSpeed};
    case RunState::kRun:
      return {safety_.handle_speed, safety_.handle_rotation_speed};
    case RunState::kRecovery:
      return {Recovery::kHandleSpeed, Recovery::kHandleSpeed / Recovery::kLength};
    default:
      return {};  // a stop has its own profile
  }
}

// While one arm's controller has not yet started the motion, neither arm moves and the virtual
// world is paused.
TickPlan Supervisor::Plan(const DeviceSample& sample) noexcept {
  TickPlan plan;
  plan.state = states_.state();
  plan.wrench_known = tared_ && plan.state != RunState::kSelfTest;
  plan.waiting = FollowsTask(plan.state) && (sample.arms[0].waits || sample.arms[1].waits);
  plan.time_passes = StateMachine::TimePasses(plan.state) && !plan.waiting;
  plan.renders = !direct_ && (plan.state == RunState::kRun || plan.state == RunState::kAlign);
  plan.cap = Cap();
  plan.run_time = run_time_;
  plan.hand_inputs = hand_inputs_;
  if (!plan.time_passes || !parameters_.Step(dt_)) return plan;
  plan.tuning = ControllerTuning{parameters_[Parameter::kStiffnessTranslation],
                                 parameters_[Parameter::kStiffnessRotation],
                                 parameters_[Parameter::kDampingRatio]};
  monitor_.SetThresholds(parameters_[Parameter::kForceThreshold],
                         parameters_[Parameter::kTorqueThreshold]);
  return plan;
}

// ---- checks ------------------------------------------------------------------------------------

void Supervisor::Check(const TickPlan& plan, const TickData& data) noexcept {
  const Status fault = RunMonitor(plan, data);
  healthy_time_ = fault.ok() ? healthy_time_ + dt_ : 0;
  HandleFault(fault, data.sent);
  HandleFault(CheckEnabling(), data.sent);
  UpdateWarnings(data);
}

Status Supervisor::RunMonitor(const TickPlan& plan, const TickData& data) noexcept {
  MonitorInput input;
  input.present = hands_;
  input.sample = direct_ ? nullptr : &data.sample;
  input.wrench = data.wrench;
  input.real = data.real;
  for (int i = 0; i < kHands; ++i) {
    input.virtual_[i] = data.before.handle[i];
    input.lower[i] = bounds_[i].lower;
    input.upper[i] = bounds_[i].upper;
    input.velocity[i] = bounds_[i].velocity;
  }
  input.world = data.after;
  input.render = plan.renders ? &data.rendered : nullptr;
  input.device = data.reading;
  input.sensing = data.sensing;
  input.simulation = data.simulation;
  input.haptics = data.haptics;
  input.missed_deadlines = rules_.arms_move_between_ticks ? static_cast<int>(data.missed) : 0;
  input.running = plan.state == RunState::kRun;
  input.follows = plan.state == RunState::kAlign || plan.state == RunState::kRun;
  input.recovers = plan.state == RunState::kRecovery;
  return monitor_.Check(input);
}

void Supervisor::UpdateWarnings(const TickData& data) noexcept {
  if (direct_) return;
  const RunState state = states_.state();
  WarningInput input;
  input.present = hands_;
  input.sample = &data.sample;
  input.wrench = data.wrench;
  input.rests = state == RunState::kIdle || state == RunState::kArmed || state == RunState::kHeld ||
                state == RunState::kUnpowered;
  warnings_.Update(input);
}

// ---- faults and stops --------------------------------------------------------------------------

void Supervisor::HandleFault(const Status& fault, const SentMotion& sent) noexcept {
  HandleFault(fault, fault.power_off ? RunEvent::kStopAndPowerOff : RunEvent::kStopRequested, sent);
}

// The first fault stops the arms in the same tick. A later fault may only raise the level of the
// stop. If a run ended without a fault and the arms are at rest, a fault that would only hold the
// arms has no effect before the reset.
void Supervisor::HandleFault(const Status& fault, RunEvent stop, const SentMotion& sent) noexcept {
  if (fault.ok()) return;
  const RunState state = states_.state();
  if (!fault_.ok() && !FollowsTask(state)) {
    if (stop == RunEvent::kStopAndPowerOff) EscalateToPowerOff(fault);
    return;
  }
  if (state == RunState::kInit || state == RunState::kUnpowered) return;
  if (state == RunState::kHeld && stop != RunEvent::kStopAndPowerOff) return;
  fault_ = fault;
  BeginStop(fault, stop, sent);
}

// Raises the level of a stop that would have held the arms, so that the stop ends without power. If
// the run ended without a fault, this fault becomes the fault of the run.
void Supervisor::EscalateToPowerOff(const Status& fault) noexcept {
  if (states_.level() != StopLevel::kHold) return;
  states_.Handle(RunEvent::kStopAndPowerOff);
  Status& cause = fault_.ok() ? fault_ : power_off_cause_;
  cause = fault;
  cause.power_off = true;
}

// A stop in progress continues. The cause of the stop may become known later, and the level of the
// stop may rise.
void Supervisor::BeginStop(const Status& cause, RunEvent stop, const SentMotion& sent) noexcept {
  if (states_.Handle(stop)) state_time_ = 0;
  if (states_.state() != RunState::kStopping) return;
  if (!stopper_.active()) joints_jumped_ = false;
  stopper_.Begin(cause, run_time_, sent.v, sent.handle_speed, sent.handle_rate, &sent.handle_twist);
}

// Returns the fault of an arm that still moves after the stop timed out. This is the arm that was
// last seen moving or, if there is none, the arm whose driver reports motion. The result includes
// the speed of the arm if this speed is the only evidence of motion.
Status Supervisor::StillMoving(const TickData& data) const noexcept {
  const int hand = stopper_.mover() >= 0 ? stopper_.mover() : data.sample.arms[0].in_motion ? 0 : 1;
  const double speed = HandleSpeed(data.real[hand].V_W);
  constexpr double kMax = StopController::kMaxRestSpeed;
  const auto side = static_cast<std::int8_t>(hand);
  if (speed > kMax) return {StopCause::kDevice, side, speed, kMax, Quantity::kSpeed};
  return {StopCause::kDevice, side, stopper_.report().duration, StopController::kPatience,
          Quantity::kTime};
}

// Returns the number of ticks since the last command. A stop needs this number to keep its timing,
// because the arms continued to move between the commands. If the gap is longer than a gap that
// stops a run, the arms' own controllers stop the arms.
int Supervisor::TicksPassed(const TickData& data) const noexcept {
  if (!rules_.arms_move_between_ticks) return 1;
  return 1 + std::min(static_cast<int>(data.missed), Monitor::kMissedDeadlines);
}

// ---- motion ------------------------------------------------------------------------------------

MotionOrder Supervisor::Order(const TickPlan& plan, const TickData& data) const noexcept {
  MotionOrder order;
  order.cap = Cap();
  switch (states_.state()) {
    case RunState::kRun:
    case RunState::kAlign:
      order.motion = Motion::kFollow;
      order.holds = aligned_ || plan.waiting;
      break;
    case RunState::kStopping:
      order.motion = Motion::kBrake;
      order.ticks = TicksPassed(data);
      break;
    case RunState::kRecovery:
      // When the key is released, the guard brings the arms to rest.
      order.motion = Motion::kRecover;
      order.holds = !Enabled() || plan.waiting;
      break;
    default:
      break;
  }
  return order;
}

void Supervisor::Brake(const MotionOrder& order, const StopGeometry& geometry,
                       std::array<JointVector, kHands>* v) noexcept {
  joints_jumped_ = joints_jumped_ || monitor_.jumped();
  if (joints_jumped_)
    stopper_.Next(v, order.ticks);
  else
    stopper_.Next(geometry, v, order.ticks);
}

void Supervisor::ObserveStop(const TickData& data) noexcept {
  stopper_.Observe({data.real[0].X_W, data.real[1].X_W}, InMotion(data.sample));
}

// ---- from state to state -----------------------------------------------------------------------

void Supervisor::EndTick(const TickPlan& plan) noexcept {
  if (plan.time_passes) run_time_ += dt_;
  for (HandInput& hand : hand_inputs_) hand.age += dt_;
  enabling_age_ += dt_;
  state_time_ += dt_;
  input_count_ = 0;
}

bool Supervisor::SelfTestEnds() const noexcept {
  return states_.state() == RunState::kSelfTest &&
         (direct_ || state_time_ >= std::max(kTareTime, kMinTareTicks * dt_));
}

bool Supervisor::Advance(const TickData& data, Beyond beyond,
                         const std::optional<Status>& self_test) noexcept {
  const RunState state = states_.state();
  aligned_ = state == RunState::kAlign && Aligned(data);
  bool changed = false;
  if (state == RunState::kInit) {
    // Samples that queued up while the devices were being connected are old at first.
    if (healthy_time_ == 0 && state_time_ < kInitPatience) return false;
    changed = states_.Handle(RunEvent::kStarted);
  } else if (state == RunState::kSelfTest && self_test) {
    if (self_test->ok())
      tared_ = changed = states_.Handle(RunEvent::kSelfTestPassed);
    else
      HandleFault(*self_test, data.sent);
  } else if (state == RunState::kAlign && aligned_ && !InMotion(data.sample)) {
    changed = states_.Handle(RunEvent::kAligned);
  } else if (state == RunState::kStopping && (direct_ || stopper_.done())) {
    // Arms that continue to move although they were commanded to rest must not be held with power.
    if (rules_.cuts_power_of_moving_arms && stopper_.timed_out())
      EscalateToPowerOff(StillMoving(data));
    changed = states_.Handle(RunEvent::kStandstill);
  } else if (state == RunState::kRecovery && Recovered(data, beyond)) {
    changed = states_.Handle(RunEvent::kRecovered);
  }
  if (changed) state_time_ = 0;
  return state == RunState::kInit;
}

// Returns whether the distance of each handle from its virtual handle is at most this large [m],
// [rad]. The result is valid only in states in which the virtual world is paused.
bool Supervisor::Within(double position, double rotation, const TickData& data) const noexcept {
  for (const int i : hands_) {
    const Pose &goal = data.after->handle[i].X_W, &real = data.real[i].X_W;
    if (!((goal.p - real.p).norm() <= position && RotationError(goal.q, real.q).norm() <= rotation))
      return false;
  }
  return true;
}

// Returns whether the handles are at their virtual handles. Once the errors of the handles have
// been small, the handles may move within the tolerance while the arms come to rest.
bool Supervisor::Aligned(const TickData& data) const noexcept {
  if (!Within(safety_.align_tolerance, safety_.align_tolerance_rotation, data)) return false;
  if (aligned_) return true;
  if (!Within(kAlignedWell, kAlignedWellRotation, data) && state_time_ <= kAlignPatience)
    return false;
  return data.sent.may_rest_next;  // in ARMED nothing moves, not even to brake
}

// Returns whether RECOVERY may end. The arms must be at rest, no part may be beyond its limit, and
// with real arms the key must be released. After a stop, RECOVERY may end earlier, because the
// reset checks these conditions again.
bool Supervisor::Recovered(const TickData& data, Beyond beyond) const noexcept {
  for (const JointVector& v : data.sent.v)
    if ((v.array() != 0).any()) return false;
  if (InMotion(data.sample)) return false;
  if (rules_.needs_enabling && Enabled()) return false;
  return states_.level() == StopLevel::kHold || beyond == Beyond::kNothing;
}

}  // namespace predictor
