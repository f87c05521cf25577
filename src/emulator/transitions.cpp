// From state to state: what is wrong becomes a stop, a stop ends, and what follows by itself.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/motion.h"
#include "emulator/emulator_impl.h"

namespace predictor {
namespace {

constexpr double kInitPatience = 0.2;                        // until all samples are fresh [s]
constexpr double kTareTime = 0.3;                            // sensors are averaged, hands off [s]
constexpr int kTareTicks = HandEstimator::kTareSamples + 1;  // at least
constexpr double kAlignedWell = 1e-4;  // aligning ends early below this [m], and half of it as
constexpr double kAlignedWellRotation = 1e-3;  // an angle [rad]
constexpr double kAlignPatience = 3;           // or when within tolerance after this time [s]
constexpr double kTrustedAge = 0.010;          // of a sample by which a stop follows an arm [s]

}  // namespace

// Acts on what the monitor found: the first doubt stops the arms, in this tick. At rest after a run
// that ended without a cause, what could be held is left to the reset.
void Emulator::Impl::Judge(const Status& wrong, RunEvent stop) noexcept {
  if (wrong.power_off) stop = RunEvent::kStopAndPowerOff;
  if (wrong.ok()) return;
  if (!latched.ok() && !FollowsTask(states.state())) return Escalate(wrong, stop);
  const RunState state = states.state();
  if (state == RunState::kInit || state == RunState::kUnpowered) return;
  if (state == RunState::kHeld && stop != RunEvent::kStopAndPowerOff) return;
  latched = wrong;
  BeginStop(wrong, stop);
}

// What comes on top of a stop's cause can only make its end harder; where a run ended without a
// cause it is one.
void Emulator::Impl::Escalate(const Status& why, RunEvent stop) noexcept {
  if (stop != RunEvent::kStopAndPowerOff || states.level() != StopLevel::kHold) return;
  states.Handle(stop);
  Status& told = latched.ok() ? latched : harder;
  told = why;
  told.power_off = true;
}

// A stop under way goes on as it is; its cause may come to be known late, its end be made harder.
void Emulator::Impl::BeginStop(const Status& cause, RunEvent stop) noexcept {
  if (states.Handle(stop)) state_time = 0;
  if (states.state() != RunState::kStopping) return;
  if (!stopper.active()) doubtful = false;
  stopper.Begin(cause, run_time, guard.last(), handle_speed, handle_rate, &handle_twist);
}

// Of the arm that was seen to move last, or else is led by its driver still: with its speed, where
// that alone says so now.
Status Emulator::Impl::Restless() const noexcept {
  const int hand = stopper.mover() >= 0 ? stopper.mover() : sample.arms[0].in_motion ? 0 : 1;
  const double speed = HandleSpeed(real[hand].V_W);
  constexpr double kMost = StopController::kRest / StopController::kRestTime;
  const auto side = static_cast<std::int8_t>(hand);
  if (speed > kMost) return {StopCause::kDevice, side, speed, kMost, Quantity::kSpeed};
  return {StopCause::kDevice, side, stopper.report().duration, StopController::kPatience,
          Quantity::kTime};
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
    const bool fresh = !measured.fault && measured.arm_age <= kTrustedAge;
    geometry.measured = geometry.measured && fresh;
    if (fresh)
      arm.LookAhead(guard.last()[i]);
    else
      arm.GoOn(guard.last()[i], TicksPassed() * dt);
    arm.ahead().FrameJacobian(*arm.model(), arm.handle_frame(), &geometry.J[i]);
    geometry.p_WH[i] = arm.ahead().FramePose(*arm.model(), arm.handle_frame()).p;
  }
  doubtful = doubtful || monitor.jumped();
  if (doubtful) return stopper.Next(&command.v, TicksPassed());
  stopper.Next(geometry, &command.v, TicksPassed());
}

// No handle is further from where it belongs than this [m], [rad], where simulated time stands
// still.
bool Emulator::Impl::Within(double position, double rotation) const noexcept {
  for (int i = 0; i < kHands; ++i) {
    const Pose &wanted = world.state().handle[i].X_W, &is = real[i].X_W;
    if (present[i] &&
        !((wanted.p - is.p).norm() <= position && RotationError(wanted.q, is.q).norm() <= rotation))
      return false;
  }
  return true;
}

// The handles are where they belong. Once they were well, they may stray within what is tolerated
// while the arms come to rest.
bool Emulator::Impl::Aligned() const noexcept {
  if (!Within(scenario.safety.align_tolerance, scenario.safety.align_tolerance_rotation))
    return false;
  if (aligned) return true;
  if (!Within(kAlignedWell, kAlignedWellRotation) && state_time <= kAlignPatience) return false;
  return guard.MayRestNext();  // ARMED moves nothing, not even to brake
}

// Whatever they were told: where nothing may move they must not be led to rest yet.
bool Emulator::Impl::InMotion() const noexcept {
  return sample.arms[0].in_motion || sample.arms[1].in_motion;
}

// Arms are to move, and one cannot yet: its controller is beginning to. Neither goes alone, and
// what is emulated stands still until both obey.
bool Emulator::Impl::Waits() const noexcept {
  return FollowsTask(states.state()) && (sample.arms[0].waits || sample.arms[1].waits);
}

// What follows by itself from a tick: time, and the steps between states that need no person.
void Emulator::Impl::Advance() noexcept {
  const RunState state = states.state();
  if (ran) run_time += dt;
  for (HandInput& hand : hand_inputs) hand.age += dt;
  enabling_age += dt;
  input_count = 0;
  state_time += dt;
  aligned = state == RunState::kAlign && Aligned();
  bool changed = false;
  if (state == RunState::kInit) {
    // What stood in line while everything was connected to is old at first.
    if (well_time == 0 && state_time < kInitPatience) return;
    changed = states.Handle(RunEvent::kStarted);
    BeginTare();
  } else if (state == RunState::kSelfTest &&
             (direct || state_time >= std::max(kTareTime, kTareTicks * dt))) {
    Status quiet;
    for (int i = 0; i < kHands; ++i) {
      const Status side = arms[i] ? arms[i]->FinishTare() : Status::Ok();
      if (side.ok() || !quiet.ok()) continue;
      quiet = side;
      quiet.hand = static_cast<std::int8_t>(i);
    }
    if (quiet.ok())
      tared = changed = states.Handle(RunEvent::kSelfTestPassed);
    else
      Judge(quiet);
  } else if (state == RunState::kAlign && aligned && !InMotion()) {
    changed = states.Handle(RunEvent::kAligned);
  } else if (state == RunState::kStopping && (direct || stopper.done())) {
    // Arms that move on though they were told to rest must not be held.
    if (!setup.simulated && stopper.restless()) Escalate(Restless(), RunEvent::kStopAndPowerOff);
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
  if (InMotion()) return false;
  if (!setup.simulated && Enabled()) return false;
  return states.level() == StopLevel::kHold || recovery->Find(View()) == Beyond::kNothing;
}

void Emulator::Impl::BeginTare() noexcept {
  for (auto& arm : arms)
    if (arm) arm->BeginTare();
}

// Back to the scenario's start; nothing moves by it.
void Emulator::Impl::ResetRun() noexcept {
  latched = harder = Status::Ok();
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

}  // namespace predictor
