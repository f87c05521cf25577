#include "evaluation/summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/words.h"

namespace predictor {
namespace {

Vector3 Force(const std::array<double, 6>& w) { return {w[0], w[1], w[2]}; }
Vector3 Torque(const std::array<double, 6>& w) { return {w[3], w[4], w[5]}; }

// Measured poses of the handles; poses of absent handles are constant.
std::array<Pose, kHands> HandlesOf(const TickRecord& record) {
  std::array<Pose, kHands> X_WH;
  for (std::size_t i = 0; i < kHands; ++i)
    if (record.hands[i].present) X_WH[i] = FromRecord(record.hands[i].real.pose);
  return X_WH;
}

// Adds the errors of one tick.
void AddErrors(const TickRecord& record, TrackingStatistics* t) {
  std::array<Pose, kHands> real, goal;
  int present = 0;
  for (std::size_t i = 0; i < kHands; ++i) {
    const HandRecord& hand = record.hands[i];
    if (!hand.present) continue;
    ++present;
    real[i] = FromRecord(hand.real.pose);
    goal[i] = FromRecord(hand.virtual_.pose);
    t->hands[i].translation.Add((real[i].p - goal[i].p).norm());
    t->hands[i].rotation.Add(RotationError(goal[i].q, real[i].q).norm());
  }
  if (present < 2) return;
  const Vector3 p = real[0].q.conjugate() * (real[1].p - real[0].p);
  const Vector3 p_goal = goal[0].q.conjugate() * (goal[1].p - goal[0].p);
  t->relative.translation.Add(std::abs(p.norm() - p_goal.norm()));
  t->relative.rotation.Add(
      RotationError(goal[0].q.conjugate() * goal[1].q, real[0].q.conjugate() * real[1].q).norm());
  t->right_from_left.Add((p - p_goal).norm());
}

}  // namespace

bool DidNotRest(const StopSummary& stop) {
  return SaysRestless(stop.cause, stop.quantity) ||
         SaysRestless(stop.harder.cause, stop.harder.quantity);
}

SummaryBuilder::SummaryBuilder(const Scenario& scenario)
    : force_(scenario.safety.force), torque_(scenario.safety.torque), dt_(1 / scenario.rate) {
  summary_.scenario = scenario.name;
  summary_.seed = scenario.seed;
  summary_.link_distance_min = std::numeric_limits<double>::infinity();
  force_crossed_.fill(-1);
  torque_crossed_.fill(-1);
}

void SummaryBuilder::Add(const TickRecord& record) {
  FollowTime(record);
  FollowThresholds(record);
  FollowStops(record);
  if (!record.ran) return;
  Summary& s = summary_;
  ++s.ticks;
  s.duration = static_cast<double>(s.ticks) * dt_;
  AddTracking(record);
  for (int i = 0; i < kHands; ++i) {
    const HandRecord& hand = record.hands[static_cast<std::size_t>(i)];
    s.present[i] = hand.present;
    if (!hand.present) continue;
    s.wrench[i].translation.Add(Force(hand.wrench).norm());
    s.wrench[i].rotation.Add(Torque(hand.wrench).norm());
  }
  s.link_distance_min = std::min(s.link_distance_min, record.link_distance);
  const double height = record.object.pose.p[2];
  if (first_) s.height_initial = s.height_min = s.height_max = height;
  first_ = false;
  s.height_min = std::min(s.height_min, height);
  s.height_max = std::max(s.height_max, height);
  s.height_final = height;
  s.qp_failed += record.qp_failed;
  s.qp_relaxed += record.qp_relaxed && !record.qp_failed;
  s.qp_solved += record.rendered && !record.qp_failed;
  for (int k = 0; k < kStages; ++k)
    s.timing[static_cast<std::size_t>(k)].Add(record.stage_us[static_cast<std::size_t>(k)]);
}

void SummaryBuilder::AddTracking(const TickRecord& record) {
  int present = 0;
  for (const HandRecord& hand : record.hands) present += hand.present;
  const bool gripping = record.hands_gripping >= present;
  AddErrors(record, gripping ? &summary_.gripping : &summary_.released);
  AddErrors(record, &summary_.whole_run);
  if (!gripping) ++summary_.released_ticks;
}

// A reset sets the run's own time to zero.
void SummaryBuilder::FollowTime(const TickRecord& record) {
  if (record.run_time < run_time_) before_ += run_time_;
  run_time_ = record.run_time;
}

void SummaryBuilder::FollowThresholds(const TickRecord& record) {
  for (std::size_t i = 0; i < kHands; ++i) {
    const HandRecord& hand = record.hands[i];
    const auto follow = [&](double value, double threshold, double* crossed) {
      if (value <= threshold)
        *crossed = -1;
      else if (*crossed < 0)
        *crossed = record.run_time;
    };
    follow(Force(hand.true_wrench).norm(), force_, &force_crossed_[i]);
    follow(Torque(hand.true_wrench).norm(), torque_, &torque_crossed_[i]);
  }
}

StopSummary SummaryBuilder::StopOf(const TickRecord& record) const {
  StopSummary stop;
  stop.cause = record.cause;
  stop.hand = record.cause_hand >= 0 && record.cause_hand < kHands ? record.cause_hand : -1;
  stop.value = record.cause_value;
  stop.limit = record.cause_limit;
  stop.quantity = record.cause_quantity;
  stop.time = before_ + record.run_time;
  stop.harder = record.harder;
  const auto& crossed = stop.cause == StopCause::kForce ? force_crossed_ : torque_crossed_;
  if ((stop.cause == StopCause::kForce || stop.cause == StopCause::kTorque) && stop.hand >= 0 &&
      crossed[static_cast<std::size_t>(stop.hand)] >= 0)
    stop.detection = record.run_time - crossed[static_cast<std::size_t>(stop.hand)];
  return stop;
}

// A cause lasts until a reset. If RECOVERY stops for another cause, the new cause replaces it.
void SummaryBuilder::FollowStops(const TickRecord& record) {
  if (stopping_) {
    meter_.Add(record);
    summary_.stops.back().distance = meter_.distance();
    summary_.stops.back().duration = static_cast<double>(meter_.ticks()) * dt_;
    stopping_ = record.state == RunState::kStopping;
  }
  FollowEnd(record);
  const bool decided = record.cause != StopCause::kNone && record.cause != cause_;
  cause_ = record.cause;
  if (!decided) return;
  ++summary_.stop_count;
  stopping_ = record.state == RunState::kStopping && summary_.stops.size() < Summary::kMostStops;
  if (summary_.stops.size() == Summary::kMostStops) return;
  summary_.stops.push_back(StopOf(record));
  meter_.Begin(record);
}

// Before the reset, further faults may follow the cause of the stop.
void SummaryBuilder::FollowEnd(const TickRecord& record) {
  const bool same = record.cause == cause_ && cause_ != StopCause::kNone;
  if (same && summary_.stop_count == summary_.stops.size())
    summary_.stops.back().harder = record.harder;
}

void SummaryBuilder::StopMeter::Begin(const TickRecord& record) {
  *this = StopMeter();
  const std::array<Pose, kHands> X_WH = HandlesOf(record);
  odometer_.Start(X_WH);
  rest_.Start(X_WH);
}

void SummaryBuilder::StopMeter::Add(const TickRecord& record) {
  ++ticks_;
  const std::array<Pose, kHands> X_WH = HandlesOf(record);
  distance_ = std::max(distance_, odometer_.Add(X_WH));
  const bool in_motion = record.hands[0].arm_in_motion != 0 || record.hands[1].arm_in_motion != 0;
  if (rest_.Update(X_WH, in_motion)) moved_ = ticks_;
}

}  // namespace predictor
