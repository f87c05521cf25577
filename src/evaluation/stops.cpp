#include "evaluation/stops.h"

#include <algorithm>
#include <cmath>

#include "core/words.h"

namespace predictor {
namespace {

// Returns the measured poses of the handles. The poses of absent handles are constant.
std::array<Pose, kHands> HandlesOf(const TickRecord& record) {
  std::array<Pose, kHands> X_WH;
  for (std::size_t i = 0; i < kHands; ++i)
    if (record.hands[i].present) X_WH[i] = FromRecord(record.hands[i].real.pose);
  return X_WH;
}

}  // namespace

bool DidNotRest(const StopSummary& stop) {
  return SaysRestless(stop.cause, stop.quantity) ||
         SaysRestless(stop.harder.cause, stop.harder.quantity);
}

bool IsLimit(StopCause cause) {
  return cause == StopCause::kForce || cause == StopCause::kTorque ||
         cause == StopCause::kCoupling || cause == StopCause::kTracking;
}

void HandleOdometer::Start(const std::array<Pose, kHands>& X_WH) noexcept {
  path_ = {};
  for (std::size_t i = 0; i < kHands; ++i) corner_[i] = X_WH[i].p;
}

double HandleOdometer::Add(const std::array<Pose, kHands>& X_WH) noexcept {
  double longest = 0;
  for (std::size_t i = 0; i < kHands; ++i) {
    double step = (X_WH[i].p - corner_[i]).norm();
    if (step >= kStep) {
      path_[i] += step;
      corner_[i] = X_WH[i].p;
      step = 0;
    }
    longest = std::max(longest, path_[i] + step);
  }
  return longest;
}

StopLog::StopLog(const Scenario& scenario)
    : force_(scenario.safety.force), torque_(scenario.safety.torque), dt_(1 / scenario.rate) {
  force_crossed_.fill(-1);
  torque_crossed_.fill(-1);
  stops_.reserve(kMaxStops);
}

// A reset sets the run time to zero.
void StopLog::FollowTime(const TickRecord& record) {
  if (record.run_time < run_time_) before_ += run_time_;
  run_time_ = record.run_time;
}

void StopLog::FollowThresholds(const TickRecord& record) {
  for (std::size_t i = 0; i < kHands; ++i) {
    const std::array<double, 6>& w = record.hands[i].true_wrench;
    const auto follow = [&](double value, double threshold, double* crossed) {
      if (value <= threshold)
        *crossed = -1;
      else if (*crossed < 0)
        *crossed = record.run_time;
    };
    follow(Vector3(w[0], w[1], w[2]).norm(), force_, &force_crossed_[i]);
    follow(Vector3(w[3], w[4], w[5]).norm(), torque_, &torque_crossed_[i]);
  }
}

// A cause lasts until a reset. If RECOVERY stops for another cause, the new cause replaces it.
void StopLog::Add(const TickRecord& record) {
  FollowTime(record);
  FollowThresholds(record);
  if (stopping_) Measure(record);
  FollowEnd(record);
  const bool decided = record.cause != StopCause::kNone && record.cause != cause_;
  cause_ = record.cause;
  if (!decided) return;
  ++count_;
  stopping_ = record.state == RunState::kStopping && stops_.size() < kMaxStops;
  if (stops_.size() < kMaxStops) Begin(record);
}

// Before the reset, further faults may follow the cause of the stop.
void StopLog::FollowEnd(const TickRecord& record) {
  const bool same = record.cause == cause_ && cause_ != StopCause::kNone;
  if (same && count_ == stops_.size()) stops_.back().harder = record.harder;
}

namespace {

// Returns whether the quantity of a stop by the physics is that of a fault of the controller.
bool IsOfController(Quantity quantity) {
  return quantity == Quantity::kCount || quantity == Quantity::kTime ||
         quantity == Quantity::kAllocations;
}

// Returns −1 if no joint moves.
int FastestJoint(const TickRecord& record) {
  double fastest = 0;
  int joint = -1;
  for (int j = 0; j < std::min<int>(record.cobot_dof, kMaxCobotJoints); ++j) {
    const double speed = std::fabs(record.cobot_v[static_cast<std::size_t>(j)]);
    if (!(speed > fastest)) continue;
    fastest = speed;
    joint = j;
  }
  return joint;
}

}  // namespace

void StopLog::Begin(const TickRecord& record) {
  StopSummary stop;
  stop.cause = record.cause;
  stop.hand = record.cause_hand >= 0 && record.cause_hand < kHands ? record.cause_hand : -1;
  stop.value = record.cause_value;
  stop.limit = record.cause_limit;
  stop.quantity = record.cause_quantity;
  stop.time = before_ + record.run_time;
  stop.harder = record.harder;
  if (stop.cause == StopCause::kPhysics && !IsOfController(stop.quantity))
    stop.fastest_joint = FastestJoint(record);
  const auto& crossed = stop.cause == StopCause::kForce ? force_crossed_ : torque_crossed_;
  if ((stop.cause == StopCause::kForce || stop.cause == StopCause::kTorque) && stop.hand >= 0 &&
      crossed[static_cast<std::size_t>(stop.hand)] >= 0)
    stop.detection = record.run_time - crossed[static_cast<std::size_t>(stop.hand)];
  stops_.push_back(stop);
  const std::array<Pose, kHands> X_WH = HandlesOf(record);
  odometer_.Start(X_WH);
  rest_.Start(X_WH);
  ticks_ = 0;
}

void StopLog::Measure(const TickRecord& record) {
  ++ticks_;
  StopSummary& stop = stops_.back();
  const std::array<Pose, kHands> X_WH = HandlesOf(record);
  stop.distance = std::max(stop.distance, odometer_.Add(X_WH));
  const bool in_motion = record.hands[0].arm_in_motion != 0 || record.hands[1].arm_in_motion != 0;
  if (rest_.Update(X_WH, in_motion)) stop.duration = static_cast<double>(ticks_) * dt_;
  stopping_ = record.state == RunState::kStopping;
}

}  // namespace predictor
