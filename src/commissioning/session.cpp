#include "commissioning/session.h"

#include <algorithm>

#include "core/error.h"
#include "core/format.h"

namespace predictor::commissioning {
namespace {

constexpr double kStands = 1e-4;  // a joint stands still if it moves less than this in kStandsFor
                                  // [rad]
constexpr double kStandsFor = 0.05;    // [s]
constexpr double kNew = 0.025;         // maximum age of the samples used [s]
constexpr double kRestPatience = 0.5;  // longest wait for the joints to stand still [s]
constexpr double kLeaving = 0.1;       // time in which an arm leaves its motion mode [s]

}  // namespace

// Waits until the next step of the clock is due, and not for a fixed duration. With a fixed
// duration, delays and computing time would lengthen every step. The program would then lose states
// of the robot, and the robot would miss commands. Missed steps are skipped.
std::string Session::Wait(bool moves) {
  constexpr std::uint64_t kPeriod = 1'000'000;  // kStep [ns]
  const std::uint64_t now = network_->Now(), late = now > due_ ? now - due_ : 0;
  due_ += (1 + late / kPeriod) * kPeriod;
  network_->Wait(1e-9 * static_cast<double>(due_ - now));
  return on_step_ ? on_step_(moves) : "";
}

void Session::Step() { Step(nullptr, {}); }

void Session::Step(Station* moving, const std::function<JointVector()>& command) {
  if (const std::string why = Wait(moving != nullptr); moving && !why.empty())
    throw DeviceError(why);
  for (Station* station : stations_)
    if (station == moving)
      station->Sense();
    else
      station->Watch();
  if (moving) {
    const JointVector v = command();
    moving->Move(v);
    commanded_ = v;
  }
  key_ = person_->Key();
  if (key_ == kGiveUp) throw InputError("Cancelled. The machine file was not changed any further.");
}

Session::Rest Session::SlowDown(Station* moving, double deceleration, double* time) {
  double speed = commanded_.cwiseAbs().maxCoeff();
  while (speed > 0) {
    commanded_ *= std::max(0.0, 1 - deceleration * kStep / speed);
    speed = commanded_.cwiseAbs().maxCoeff();
    Wait(true);
    *time += kStep;
    if (!moving->Slow(commanded_, true)) return Rest::kSilent;
  }
  return AwaitRest(moving);
}

// A sample that is not new provides no information.
Session::Rest Session::AwaitRest(Station* moving) {
  JointVector q = moving->reading().q;
  double since = Now();
  for (const double begin = since; Now() - since < kStandsFor;) {
    if (Now() - begin > kRestPatience) return Rest::kMoves;
    Wait(true);
    if (!moving->Slow(commanded_, true)) return Rest::kSilent;
    const ArmReading& reading = moving->reading();
    if (reading.age <= kNew && (reading.q - q).cwiseAbs().maxCoeff() <= kStands) continue;
    q = reading.q;
    since = Now();
  }
  for (const double begin = Now(); Now() - begin < kLeaving;) {
    Wait(false);
    static_cast<void>(moving->Slow(commanded_, false));
  }
  return Rest::kRests;
}

std::string Session::BringToRest(Station* moving, double deceleration) {
  const std::string arm = "The " + moving->name() + " arm ";
  if (commanded_.size() != moving->model().dof()) commanded_.setZero(moving->model().dof());
  double time = 0;
  switch (SlowDown(moving, deceleration, &time)) {
    case Rest::kSilent:
      return arm + Formatted(
                       "no longer accepts commands. The arm brakes by itself within %.0f ms after "
                       "the last command. Check that the arm stands still; otherwise, use the "
                       "emergency stop.",
                       1e3 * moving->facts().watchdog);
    case Rest::kMoves:
      return arm +
             "was commanded to stop, but does not report a standstill. USE THE EMERGENCY STOP.";
    case Rest::kRests:
      break;
  }
  return time > 0 ? arm + Formatted("was brought to rest within %.0f ms.", 1e3 * time)
                  : arm + "is at rest.";
}

char Session::Ask(const std::string& prompt, const std::string& keys) {
  Show(prompt);
  for (;;) {
    Step();
    if (key_ != 0 && keys.find(key_) != std::string::npos) return key_;
  }
}

}  // namespace predictor::commissioning
