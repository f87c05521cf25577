#include "devices/franka/fault_record.h"

namespace predictor::fci {
namespace {

std::string What(Fault fault, int detail) {
  switch (fault) {
    case Fault::kNone:
      return "";
    case Fault::kClosed:
      return "closed the connection";
    case Fault::kNonsense:
      return "sent an answer that does not belong to the Franka Control Interface";
    case Fault::kSilent:
      return "no longer sends states";
    case Fault::kMode:
      return Words(static_cast<RobotMode>(detail));
    case Fault::kError:
      return "reports an error";
    case Fault::kMove:
      return Words(static_cast<MoveStatus>(detail));
    case Fault::kNoStart:
      return "did not start its motion when commanded";
    case Fault::kNoEnd:
      return "did not end its motion when commanded";
  }
  return "";
}

const char* Advice(Fault fault) {
  switch (fault) {
    case Fault::kClosed:
    case Fault::kNonsense:
    case Fault::kSilent:
      return "Check the cable and the arm, then start again.";
    default:
      return "Check the arm, clear the cause in Desk, then start again.";
  }
}

}  // namespace

bool EndsWithoutPower(const FaultAndDetail& what) noexcept {
  const int detail = what.detail;
  switch (what.fault) {
    case Fault::kClosed:
    case Fault::kNonsense:
    case Fault::kSilent:
      return true;
    case Fault::kMode:
      return detail == static_cast<int>(RobotMode::kOther) ||
             detail == static_cast<int>(RobotMode::kUserStopped);
    case Fault::kMove:
      return detail == static_cast<int>(MoveStatus::kEmergencyAborted);
    default:
      return false;
  }
}

std::string FaultRecord::Describe(const Address& who) const {
  const auto [fault, detail] = latch_.first();
  std::string text = who.ToString() + " " + What(fault, detail);
  if (const Errors errors(errors_.load(std::memory_order_relaxed)); errors.any())
    text += " (" + ErrorWords(errors) + ")";
  if (const FaultAndDetail then = latch_.worse(); then.fault != Fault::kNone)
    return text + ". Since then it " + What(then.fault, then.detail) + ". " + Advice(then.fault);
  return text + ". " + Advice(fault);
}

}  // namespace predictor::fci
