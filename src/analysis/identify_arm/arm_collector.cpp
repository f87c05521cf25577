#include "analysis/identify_arm/arm_collector.h"

#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

constexpr double kBaseline = 0.04;   // before the onset, whose mean is subtracted [s]
constexpr double kComplete = 0.999;  // share of the amplitude that a complete displacement reaches

Vector3 First3(const std::array<double, 6>& x) { return {x[0], x[1], x[2]}; }

}  // namespace

ArmCollector::ArmCollector(const Scenario& scenario, int hand, const std::array<Vector3, 2>& plane,
                           double dt)
    : hand_(hand),
      plane_(plane),
      dt_(dt),
      amplitude_(scenario.perturbation ? scenario.perturbation->amplitude : 0),
      before_(static_cast<std::size_t>(std::lround(kBefore / dt))),
      after_(static_cast<std::size_t>(std::lround(kAfter / dt))),
      low_pass_(scenario.arm(hand).sensor.cutoff_frequency, dt, Eigen::Vector4d::Zero()),
      delay_ticks_(scenario.arm(hand).sensor.delay / dt) {}

void ArmCollector::Abandon() {
  if (is_open_) ++spoiled_;
  is_open_ = false;
}

void ArmCollector::Add(const TickRecord& record) {
  const HandRecord& h = record.hands[static_cast<std::size_t>(hand_)];
  const bool follows = record.ran && h.present && !h.sensor_saturated;
  if (!follows || record.tick != tick_ + 1) {
    Abandon();
    past_.clear();
    started_ = displaced_ = false;
  }
  tick_ = record.tick;
  if (!follows) return;

  const Vector3 p = {h.real.pose.p[0], h.real.pose.p[1], h.real.pose.p[2]};
  Eigen::Vector4d motion;
  motion << InPlane(p), InPlane(First3(h.real.twist));
  const Eigen::Vector2d force = InPlane(First3(h.wrench));
  if (!motion.allFinite() || !force.allFinite()) {
    Abandon();
    past_.clear();
    started_ = false;
    return;
  }
  if (!started_) {
    low_pass_.Reset(motion);
    delay_.Reset(delay_ticks_, motion);
    started_ = true;
  }
  const Eigen::Vector4d late = delay_.Update(low_pass_.Update(motion));
  const Sample sample = {late.head<2>(), late.tail<2>(), force};

  const Vector3 commanded = {record.perturbation[0], record.perturbation[1],
                             record.perturbation[2]};
  const bool displaced = commanded.norm() > 0;
  if (displaced && !displaced_) {
    is_open_ = past_.size() == before_;
    if (is_open_) open_.samples.assign(past_.begin(), past_.end());
    if (!is_open_) ++spoiled_;
  }
  displaced_ = displaced;
  past_.push_back(sample);
  if (past_.size() > before_) past_.pop_front();
  if (!is_open_) return;
  open_.samples.push_back(sample);
  largest_force_ = std::max(largest_force_, First3(h.wrench).norm());
  if (open_.samples.size() < before_ + after_ + 1) return;
  if (commanded.norm() < kComplete * amplitude_) return Abandon();
  open_.direction = InPlane(commanded).normalized();
  windows_.push_back(open_);
  is_open_ = false;
}

ArmResponses ArmCollector::responses() const {
  ArmResponses r;
  r.dt = dt_;
  r.before = static_cast<int>(before_);
  const auto times = static_cast<Eigen::Index>(before_ + after_);
  const auto count = static_cast<Eigen::Index>(windows_.size());
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (PlaneSignal* signal : {&r.position, &r.velocity, &r.acceleration, &r.force})
      (*signal)[axis].setZero(times, count);
  r.direction.resize(count, 2);
  const auto baseline = static_cast<Eigen::Index>(std::lround(kBaseline / dt_));
  for (Eigen::Index i = 0; i < count; ++i) {
    const Window& window = windows_[static_cast<std::size_t>(i)];
    r.direction.row(i) = window.direction;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      for (Eigen::Index t = 0; t < times; ++t) {
        const auto k = static_cast<std::size_t>(t);
        const Sample &now = window.samples[k], &next = window.samples[k + 1];
        r.position[axis](t, i) = now.position[a];
        r.velocity[axis](t, i) = now.velocity[a];
        r.force[axis](t, i) = now.force[a];
        if (k > 0)
          r.acceleration[axis](t, i) =
              (next.velocity[a] - window.samples[k - 1].velocity[a]) / (2 * dt_);
      }
      for (PlaneSignal* signal : {&r.position, &r.velocity, &r.acceleration, &r.force}) {
        auto column = (*signal)[axis].col(i);
        column.array() -= column.segment(r.before - baseline, baseline).mean();
      }
    }
  }
  return r;
}

}  // namespace predictor
