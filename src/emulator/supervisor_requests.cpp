// Decides which inputs and requests of people, pages and enabling devices are granted.
#include <cmath>
#include <utility>

#include "core/choice.h"
#include "core/motion.h"
#include "emulator/supervisor.h"

namespace predictor {
namespace {

constexpr double kEnablingPeriod = 0.02;  // time between signs of an enabling device [s]
constexpr double kMaxHandDistance = 5;    // distance of a person's hand from the origin [m]

}  // namespace

bool Supervisor::Submit(const RunInput& input) noexcept {
  if (!HasRoomForInput() || !Accept(input)) return false;
  inputs_[static_cast<std::size_t>(input_count_++)] = input;
  return true;
}

void Supervisor::Request(RunEvent event) noexcept {
  requests_.fetch_or(1U << static_cast<int>(event), std::memory_order_release);
}

void Supervisor::RequestEnd() noexcept { end_requested_.store(true, std::memory_order_release); }

// An input may come from another process, so its content is not trusted.
bool Supervisor::Accept(const RunInput& input) noexcept {
  const auto request_if = [this](bool allowed, RunEvent event) {
    if (allowed) Request(event);
    return allowed;
  };
  switch (input.kind) {
    case InputKind::kStop:
      if (rules_.remote_start && input.value == kEndAsPlanned) {
        RequestEnd();
        return true;
      }
      return request_if(true, RunEvent::kStopRequested);
    case InputKind::kAlign:
      return request_if(rules_.remote_start, RunEvent::kAlignRequested);
    case InputKind::kStart:
      return request_if(rules_.remote_start, RunEvent::kStartRequested);
    case InputKind::kReset:
      return request_if(rules_.remote_start, RunEvent::kReset);
    case InputKind::kParameter:
      return parameters_.Set(input.parameter, input.value);
    case InputKind::kHand:
      return AcceptHand(input);
    case InputKind::kHeadset:
      return ReportFault({StopCause::kHeadset, -1, input.value, kHeadsetSilence});
    case InputKind::kWatchdog:
      return ReportFault({StopCause::kWatchdog, -1, input.value, kWatchdogSilence});
    case InputKind::kSuspended:
      return ReportFault({StopCause::kDeadline, -1, input.value, 0, Quantity::kTime});
    case InputKind::kEnable:
      if (!rules_.needs_enabling) return false;
      enabling_age_ = input.value > 0 ? 0 : HUGE_VAL;
      return true;
    case InputKind::kLatency:
    case InputKind::kMarker:
      return true;
    default:
      return false;
  }
}

// Only the first fault of a tick counts. If a requested fault has no duration, the request is
// refused.
bool Supervisor::ReportFault(const Status& fault) noexcept {
  if (!(fault.value > 0)) return false;
  if (reported_.ok()) reported_ = fault;
  return true;
}

bool Supervisor::AcceptHand(const RunInput& input) noexcept {
  if (!browser_operator_ || input.hand >= kHands || !hands_.Has(input.hand)) return false;
  double norm = 0;
  for (const double x : input.q) norm += x * x;
  double distance = 0;
  for (const double x : input.p) distance += x * x;
  if (!(std::abs(norm - 1) < 1e-3) || !(distance < kMaxHandDistance * kMaxHandDistance))
    return false;
  HandInput& hand = hand_inputs_[input.hand];
  hand.X_WH = FromRecord(PoseRecord{input.p, input.q});
  hand.X_WH.q.normalize();
  hand.grip = input.grip != 0;
  hand.age = 0;
  return true;
}

// ---- requests ----------------------------------------------------------------------------------

RunRequests Supervisor::TakeRequests() noexcept {
  RunRequests requests;
  requests.events = requests_.exchange(0, std::memory_order_acquire);
  requests.end = end_requested_.exchange(false, std::memory_order_acquire);
  return requests;
}

// Stops are processed first and in every state, beginning with the most severe stop. Other requests
// in the same tick as a stop are dropped.
bool Supervisor::HandleRequests(const TickData& data, Beyond beyond) noexcept {
  const RunRequests& requests = data.requests;
  refused_ = {};
  if (requests.Has(RunEvent::kStopAndPowerOff)) {
    StopOnRequest(RunEvent::kStopAndPowerOff, data.sent);
    return false;
  }
  HandleFault(std::exchange(reported_, Status::Ok()), data.sent);
  if (requests.Has(RunEvent::kStopRequested)) {
    StopOnRequest(RunEvent::kStopRequested, data.sent);
    return false;
  }
  if (requests.end && FollowsTask(states_.state())) {
    BeginStop(fault_, RunEvent::kStopRequested, data.sent);
    return false;
  }
  bool reset = false;
  for (const RunEvent event : {RunEvent::kReset, RunEvent::kRecoverRequested,
                               RunEvent::kAlignRequested, RunEvent::kStartRequested})
    if (requests.Has(event)) reset |= Grant(event, data, beyond);
  return reset;
}

// If the run already has a fault, this fault remains the cause of the stop.
void Supervisor::StopOnRequest(RunEvent stop, const SentMotion& sent) noexcept {
  const RunState state = states_.state();
  const bool at_rest = state == RunState::kHeld || state == RunState::kUnpowered;
  const bool power_off = stop == RunEvent::kStopAndPowerOff;
  if (!fault_.ok()) {
    if (power_off) EscalateToPowerOff({StopCause::kOperator});
  } else if (!at_rest) {
    fault_ = {StopCause::kOperator};
  }
  BeginStop(fault_, stop, sent);
}

bool Supervisor::HandsFree(const TickData& data) const noexcept {
  for (const int i : hands_)
    if (data.wrench[i].F_H_W.head<3>().norm() > kFreeForce ||
        data.wrench[i].F_H_W.tail<3>().norm() > kFreeTorque)
      return false;
  return true;
}

// In direct mode, there are no haptic arms. The handles are part of the object, and simulated time
// is paused.
bool Supervisor::ArmsStand(const TickData& data) const noexcept {
  if (direct_) return true;
  for (const int i : hands_)
    if (!(HandleSpeed(data.real[i].V_W) < kStandstillSpeed)) return false;
  return true;
}

// Returns the reason why an event is refused although the table of states allows it.
Refusal Supervisor::WhyRefused(RunEvent event, const TickData& data, Beyond beyond) const noexcept {
  const RunState state = states_.state();
  if (event == RunEvent::kReset) {
    if (state != RunState::kHeld && state != RunState::kUnpowered) return Refusal::kNone;
    if (!HandsFree(data)) return Refusal::kHandLoaded;
    if (!ArmsStand(data)) return Refusal::kMoves;
    return healthy_time_ < kCauseAbsent ? Refusal::kCauseRemains : Refusal::kNone;
  }
  if (!Enabled()) return Refusal::kNotEnabled;
  if (event == RunEvent::kStartRequested && state == RunState::kArmed &&
      rules_.rechecks_alignment &&
      !Within(safety_.align_tolerance, safety_.align_tolerance_rotation, data))
    return Refusal::kNotAligned;
  if (direct_ || event != RunEvent::kAlignRequested || state != RunState::kIdle)
    return Refusal::kNone;
  if (rules_.aligns_hands_free && !HandsFree(data)) return Refusal::kNotFree;
  return beyond == Beyond::kJoint   ? Refusal::kBeyondJoint
         : beyond == Beyond::kLinks ? Refusal::kBeyondLinks
                                    : Refusal::kNone;
}

// Returns whether the run was reset. If a request arrives in the wrong state, the table of states
// may convert the request into a stop.
bool Supervisor::Grant(RunEvent event, const TickData& data, Beyond beyond) noexcept {
  if (direct_ && event == RunEvent::kRecoverRequested) return false;  // no arms to recover
  if (const Refusal why = WhyRefused(event, data, beyond); why != Refusal::kNone) {
    refused_ = {static_cast<std::uint8_t>(1 + static_cast<int>(event)), why};
    return false;
  }
  if (!states_.Handle(event)) return false;
  state_time_ = 0;
  const RunState state = states_.state();
  if (state == RunState::kStopping) {
    fault_ = {StopCause::kOperator};
    BeginStop(fault_, RunEvent::kStopAndPowerOff, data.sent);
  } else if (event == RunEvent::kReset) {
    ResetRun();
    return true;
  } else if (state == RunState::kRecovery) {
    stopper_.Reset();
  }
  return false;
}

// Resets the run to the scenario's start without any motion.
void Supervisor::ResetRun() noexcept {
  fault_ = power_off_cause_ = Status::Ok();
  run_time_ = state_time_ = healthy_time_ = 0;
  parameters_.Reset();
  monitor_.SetThresholds(parameters_[Parameter::kForceThreshold],
                         parameters_[Parameter::kTorqueThreshold]);
  monitor_.Reset();
  hand_inputs_.fill(HandInput());
  stopper_.Reset();
}

// ---- enabling ----------------------------------------------------------------------------------

Status Supervisor::CheckEnabling() const noexcept {
  const RunState state = states_.state();
  if (Enabled() || (state != RunState::kAlign && state != RunState::kRun)) return Status::Ok();
  // The device was released and is not silent, so there is no duration to report.
  if (!std::isfinite(enabling_age_)) return {StopCause::kEnabling, -1, 0, 0, Quantity::kNone};
  return {StopCause::kEnabling, -1, enabling_age_, kEnablingSilence};
}

// The signals of the device are submitted as inputs of the next tick, like the signals of a key,
// and are therefore recorded. A device that is already pressed when the program starts, or is still
// pressed after a stop, may be jammed or taped down. Such a device enables motion only after it has
// been released, even if it was silent during the stop. While the device is silent, it sends no
// signals. After the time-out, the device counts as released.
void Supervisor::FollowEnablingDevice(Enabling now) noexcept {
  if (states_.state() == RunState::kStopping) device_was_released_ = false;
  if (now == Enabling::kNone || now == Enabling::kSilent) return;
  if (now == Enabling::kReleased) device_was_released_ = true;
  const bool pressed = now == Enabling::kPressed && device_was_released_;
  device_time_ += dt_;
  if (pressed == device_pressed_ && !(pressed && device_time_ >= kEnablingPeriod)) return;
  device_pressed_ = pressed;
  device_time_ = 0;
  RunInput sign;
  sign.kind = InputKind::kEnable;
  sign.value = pressed ? 1 : 0;
  Submit(sign);
}

}  // namespace predictor
