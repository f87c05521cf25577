#include "simulation/controllers/set_point.h"

#include <algorithm>
#include <string>

#include "core/error.h"
#include "core/minimum_jerk.h"
#include "core/text.h"

namespace predictor {

SetPointTrajectory::SetPointTrajectory(const std::vector<Waypoint>& waypoints, const Pose& start)
    : start_(start) {
  double time = 0;
  Pose from = start;
  Vector6 before = Vector6::Zero();
  for (const Waypoint& waypoint : waypoints) {
    if (!(waypoint.time > time)) {
      const std::string key =
          "cobot.controller.trajectory." + std::to_string(segments_.size()) + ".time";
      throw InputError::At(
          key, key + " is " + FormatNumber(waypoint.time) + " s, which does not come after " +
                   FormatNumber(time) +
                   " s. Give increasing times, of which the first is greater than 0.");
    }
    const Pose offset = PoseFromXyzRpy(waypoint.xyz, waypoint.rpy);
    const Pose to = {start.p + offset.p, (offset.q * start.q).normalized()};
    segments_.push_back(
        {time, waypoint.time, from, to.p - from.p, RotationError(to.q, from.q), before});
    before.head<3>() += segments_.back().translation;
    before.tail<3>() += segments_.back().rotation;
    time = waypoint.time;
    from = to;
  }
}

double SetPointTrajectory::Segment::Share(double t) const noexcept {
  return std::clamp((t - start) / (end - start), 0.0, 1.0);
}

const SetPointTrajectory::Segment* SetPointTrajectory::SegmentAt(double t) const noexcept {
  const Segment* segment = nullptr;
  for (const Segment& s : segments_) {
    if (t >= s.start) segment = &s;
  }
  return segment;
}

Vector6 SetPointTrajectory::Segment::Path(double position) const noexcept {
  Vector6 path = before;
  path.head<3>() += position * translation;
  path.tail<3>() += position * rotation;
  return path;
}

Vector6 SetPointTrajectory::PathAt(double t) const noexcept {
  const Segment* segment = SegmentAt(t);
  return segment ? segment->Path(MinimumJerk(segment->Share(t))) : Vector6(Vector6::Zero());
}

FrameMotion SetPointTrajectory::At(double t, Vector6* path) const noexcept {
  FrameMotion motion;
  motion.X_W = start_;
  if (path) path->setZero();
  const Segment* segment = SegmentAt(t);
  if (segment == nullptr) return motion;
  const double duration = segment->end - segment->start;
  const double s = segment->Share(t);
  const double position = MinimumJerk(s);
  const double speed = MinimumJerkRate(s) / duration;
  const double acceleration = 60 * s * (1 - s) * (1 - 2 * s) / (duration * duration);
  if (path) *path = segment->Path(position);
  motion.X_W.p = segment->from.p + position * segment->translation;
  motion.X_W.q = (RotationFromVector(position * segment->rotation) * segment->from.q).normalized();
  motion.V_W << speed * segment->translation, speed * segment->rotation;
  motion.A_W << acceleration * segment->translation, acceleration * segment->rotation;
  return motion;
}

}  // namespace predictor
