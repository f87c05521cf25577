#include "evaluation/summary.h"

#include <cmath>
#include <limits>

namespace predictor {
namespace {

Vector3 Force(const std::array<double, 6>& w) { return {w[0], w[1], w[2]}; }
Vector3 Torque(const std::array<double, 6>& w) { return {w[3], w[4], w[5]}; }

}  // namespace

SummaryBuilder::SummaryBuilder(const Scenario& scenario)
    : force_(scenario.safety.force), torque_(scenario.safety.torque), dt_(1 / scenario.rate) {
  summary_.scenario = scenario.name;
  summary_.seed = scenario.seed;
  summary_.elbow_distance_min = std::numeric_limits<double>::infinity();
  force_crossed_.fill(-1);
  torque_crossed_.fill(-1);
}

void SummaryBuilder::Add(const TickRecord& record) {
  FollowStop(record);
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
  s.elbow_distance_min = std::min(s.elbow_distance_min, record.elbow_distance);
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
  TrackingStatistics& t = gripping ? summary_.gripping : summary_.released;
  if (!gripping) ++summary_.released_ticks;
  std::array<Pose, kHands> real, goal;
  for (std::size_t i = 0; i < kHands; ++i) {
    const HandRecord& hand = record.hands[i];
    if (!hand.present) continue;
    real[i] = FromRecord(hand.real.pose);
    goal[i] = FromRecord(hand.virtual_.pose);
    t.hands[i].translation.Add((real[i].p - goal[i].p).norm());
    t.hands[i].rotation.Add(RotationError(goal[i].q, real[i].q).norm());
  }
  if (present < 2) return;
  const double distance = (real[1].p - real[0].p).norm() - (goal[1].p - goal[0].p).norm();
  t.relative.translation.Add(std::abs(distance));
  t.relative.rotation.Add(
      RotationError(goal[0].q.conjugate() * goal[1].q, real[0].q.conjugate() * real[1].q).norm());
}

void SummaryBuilder::FollowStop(const TickRecord& record) {
  if (summary_.stop) return;
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
  if (record.cause == StopCause::kNone) return;
  StopSummary stop;
  stop.cause = record.cause;
  stop.hand = record.cause_hand >= 0 && record.cause_hand < kHands ? record.cause_hand : -1;
  stop.value = record.cause_value;
  stop.limit = record.cause_limit;
  stop.quantity = record.cause_quantity;
  stop.time = record.run_time;
  const auto& crossed = stop.cause == StopCause::kForce ? force_crossed_ : torque_crossed_;
  if ((stop.cause == StopCause::kForce || stop.cause == StopCause::kTorque) && stop.hand >= 0 &&
      crossed[static_cast<std::size_t>(stop.hand)] >= 0)
    stop.detection = record.run_time - crossed[static_cast<std::size_t>(stop.hand)];
  summary_.stop = stop;
}

}  // namespace predictor
