#include "assessment/measured_head.h"

#include <cmath>
#include <utility>

namespace predictor::assessment {
namespace {

// Limits of possible positions, as shares of the person's height (design choices). These limits
// only need to reveal a wrong unit, frame or marker.
constexpr double kLowest = 0.1, kHighest = 1.25, kFarthest = 1.0;

// Number of heads that are kept during a run: at least four seconds.
constexpr std::size_t kKept = 256;

}  // namespace

void AppendMeasured(const HeadRecord& head, double time, tracks::PartTrack* track) {
  if (!track->times.empty() && time <= track->times.back()) return;
  const auto& [p, q] = std::pair(head.p, head.q);
  track->times.push_back(time);
  track->p.emplace_back(p[0], p[1], p[2]);
  track->q.push_back(Quaternion(q[0], q[1], q[2], q[3]));
}

bool IsPossible(const PersonSetup& setup, const Vector3& p_W) {
  const Vector3 p = setup.stance.X_WS.Inverse() * p_W;
  const double height = setup.body.height;
  return p.z() > kLowest * height && p.z() < kHighest * height &&
         std::hypot(p.x(), p.y()) < kFarthest * height;
}

HeadSource AddHeadAt(double time, const tracks::PartTrack& head, const PersonSetup& setup,
                     PersonSample* sample, PositionCount* count) {
  const auto p = head.PositionAt(time);
  if (!p) return HeadSource::kModelled;
  ++count->measured;
  if (!IsPossible(setup, *p)) {
    ++count->impossible;
    return HeadSource::kImpossible;
  }
  const auto q = head.RotationAt(time);
  sample->body.X_WHead = Pose{*p, q.value_or(Quaternion::Identity())};
  sample->body.head_rotation_measured = q.has_value();
  return HeadSource::kMeasured;
}

void LiveHead::Take(const HeadRecord& head, std::uint64_t newest_ns) {
  if (!IsCredible(head, newest_ns)) return;
  if (head.registration != registration_) count_ = {};
  registration_ = head.registration;
  AppendMeasured(head, Seconds(head.wall_ns), &track_);
  if (track_.times.size() < 2 * kKept) return;
  const auto drop = [](auto* x) { x->erase(x->begin(), x->end() - kKept); };
  drop(&track_.times);
  drop(&track_.p);
  drop(&track_.q);
}

bool LiveHead::IsAwaited(std::uint64_t tick_ns, std::uint64_t newest_ns) const {
  if (track_.times.empty()) return false;
  const double last = track_.times.back();
  return last < Seconds(tick_ns) &&
         Seconds(newest_ns) <= last + tracks::PartTrack::kMaxGap + kLongestHeadDelay;
}

HeadSource LiveHead::AddTo(PersonSample* sample, double clock, const PersonSetup& setup) {
  PersonSample with = *sample;
  const HeadSource source = AddHeadAt(clock, track_, setup, &with, &count_);
  if (source == HeadSource::kModelled) return source;
  if (count_.MostlyImpossible()) return HeadSource::kImpossible;
  *sample = std::move(with);
  return source;
}

}  // namespace predictor::assessment
