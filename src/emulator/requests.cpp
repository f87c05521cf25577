// What people, pages and enabling devices put into a run, and what of it is granted.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/motion.h"
#include "emulator/emulator_impl.h"

namespace predictor {
namespace {

constexpr double kEnablingSigns = 0.02;  // between signs of an enabling device [s]

}  // namespace

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
  if (end && FollowsTask(states.state())) return BeginStop(latched, RunEvent::kStopRequested);
  for (const RunEvent event : {RunEvent::kReset, RunEvent::kRecoverRequested,
                               RunEvent::kAlignRequested, RunEvent::kStartRequested})
    if (has(event)) Obey(event);
}

// A cause that is known already stays the cause.
void Emulator::Impl::StopOnRequest(RunEvent stop) noexcept {
  const bool at_rest = states.state() == RunState::kHeld || states.state() == RunState::kUnpowered;
  if (!latched.ok())
    Escalate({StopCause::kOperator}, stop);
  else if (!at_rest)
    latched = {StopCause::kOperator};
  BeginStop(latched, stop);
}

bool Emulator::Impl::HandsFree() const noexcept {
  for (int i = 0; i < kHands; ++i)
    if (present[i] && (wrench[i].F_H_W.head<3>().norm() > kFreeForce ||
                       wrench[i].F_H_W.tail<3>().norm() > kFreeTorque))
      return false;
  return true;
}

bool Emulator::Impl::ArmsStand() const noexcept {
  for (int i = 0; i < kHands; ++i)
    if (present[i] && !(HandleSpeed(real[i].V_W) < kStandstillSpeed)) return false;
  return true;
}

// What stands in the way of a request that the table would grant.
Refusal Emulator::Impl::WhyNot(RunEvent event) const noexcept {
  const RunState state = states.state();
  if (event == RunEvent::kReset) {
    if (setup.simulated || (state != RunState::kHeld && state != RunState::kUnpowered))
      return Refusal::kNone;
    if (!HandsFree()) return Refusal::kHandLoaded;
    if (!ArmsStand()) return Refusal::kMoves;
    return well_time < kCauseAbsent ? Refusal::kCauseRemains : Refusal::kNone;
  }
  if (!Enabled()) return Refusal::kNotEnabled;
  if (event == RunEvent::kStartRequested && state == RunState::kArmed && !setup.simulated &&
      !Within(scenario.safety.align_tolerance, scenario.safety.align_tolerance_rotation))
    return Refusal::kNotAligned;
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

Status Emulator::Impl::CheckEnabling() const noexcept {
  const RunState state = states.state();
  if (Enabled() || (state != RunState::kAlign && state != RunState::kRun)) return Status::Ok();
  // Let go of: no time has been waited for.
  if (!std::isfinite(enabling_age)) return {StopCause::kEnabling, -1, 0, 0, Quantity::kNone};
  return {StopCause::kEnabling, -1, enabling_age, kEnablingSilence};
}

// Its signs are inputs of the next tick, as a key's are: so they are recorded. One that is pressed
// when the program begins, or still is after a stop, may be jammed or taped: it counts once it has
// been let go, silent during the stop or not. In silence no sign comes, and the time-out lets go.
void Emulator::Impl::FollowEnablingDevice() noexcept {
  const Enabling now = device ? device->enabling() : Enabling::kNone;
  if (states.state() == RunState::kStopping) was_released = false;
  if (now == Enabling::kNone || now == Enabling::kSilent) return;
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

}  // namespace predictor
