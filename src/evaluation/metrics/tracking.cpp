// Measures the errors of the real handles relative to the poses that they should follow. These
// poses are the poses of the virtual handles plus the displacement that a perturbation commands.
#include <cmath>

#include "core/handle_target.h"
#include "core/motion.h"
#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

struct TrackingErrors {
  std::array<Statistics, kHands> translation, rotation;
  Statistics distance, angle, right_from_left;

  void Add(const TickRecord& record) noexcept;
};

void TrackingErrors::Add(const TickRecord& record) noexcept {
  std::array<Pose, kHands> real, goal;
  int present = 0;
  for (std::size_t i = 0; i < kHands; ++i) {
    const HandRecord& hand = record.hands[i];
    if (!hand.present) continue;
    ++present;
    real[i] = FromRecord(hand.real.pose);
    goal[i] = HandleTarget(record, i);
    translation[i].Add((real[i].p - goal[i].p).norm());
    rotation[i].Add(RotationError(goal[i].q, real[i].q).norm());
  }
  if (present < 2) return;
  const Vector3 p = real[0].q.conjugate() * (real[1].p - real[0].p);
  const Vector3 p_goal = goal[0].q.conjugate() * (goal[1].p - goal[0].p);
  distance.Add(std::abs(p.norm() - p_goal.norm()));
  angle.Add(
      RotationError(goal[0].q.conjugate() * goal[1].q, real[0].q.conjugate() * real[1].q).norm());
  right_from_left.Add((p - p_goal).norm());
}

class Tracking final : public Metric {
 public:
  explicit Tracking(const Scenario&) {}

  void Add(const TickRecord& record) noexcept override {
    if (!record.ran) return;
    int present = 0;
    for (const HandRecord& hand : record.hands) present += hand.present;
    const bool gripping = record.hands_gripping >= present;
    (gripping ? gripping_ : released_).Add(record);
    ++(gripping ? gripping_ticks_ : released_ticks_);
    whole_run_.Add(record);
  }

  void AppendTo(std::vector<Result>* results) const override {
    Append(gripping_, "", "While gripping", ", while all hands grip", results);
    Append(released_, "released.", "While released", ", while not all hands grip", results);
    const std::size_t whole_run = results->size();
    Append(whole_run_, "whole_run.", "Whole run", ", in the whole run", results);
    for (std::size_t k = whole_run; k < results->size(); ++k)
      (*results)[k].shown = gripping_ticks_ > 0 && released_ticks_ > 0;
  }

 private:
  static void Append(const TrackingErrors& errors, const std::string& phase, const char* group,
                     const char* when, std::vector<Result>* results) {
    const auto add = [&](const std::string& key, const std::string& label, bool rotation,
                         const char* meaning, const Statistics& values) {
      results->push_back({.path = "tracking." + phase + key,
                          .group = group,
                          .label = label,
                          .column = rotation ? "rotation" : "translation",
                          .unit = rotation ? units::kDegree : units::kMillimetre,
                          .meaning = std::string(meaning) + when,
                          .value = values,
                          .compared = phase.empty()});
    };
    for (std::size_t i = 0; i < kHands; ++i) {
      const std::string hand = kHandNames[i];
      add(hand + ".translation_m", hand + " handle", false,
          "distance of the real handle from the virtual one", errors.translation[i]);
      add(hand + ".rotation_rad", hand + " handle", true,
          "angle between the real and the virtual handle", errors.rotation[i]);
    }
    add("relative.distance_m", "distance between the handles", false,
        "error of the distance between the handles, | |p| − |p^d| |", errors.distance);
    add("relative.angle_rad", "right handle seen from the left", true,
        "error of the rotation between the handles", errors.angle);
    add("relative.right_from_left_m", "right handle seen from the left", false,
        "error of the right handle's position in the frame of the left one, |p − p^d|",
        errors.right_from_left);
  }

  TrackingErrors gripping_, released_, whole_run_;
  std::uint64_t gripping_ticks_ = 0, released_ticks_ = 0;
};

}  // namespace

const MetricKind kTracking = {.chapter = Chapter::kTracking, .make = MakeMetric<Tracking>};

}  // namespace predictor::metrics
