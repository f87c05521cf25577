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
    segments_.push_back({time, waypoint.time, from, to.p - from.p, RotationError(to.q, from.q)});
    time = waypoint.time;
    from = to;
  }
}

FrameMotion SetPointTrajectory::At(double t) const noexcept {
  FrameMotion motion;
  motion.X_W = start_;
  const Segment* segment = nullptr;
  for (const Segment& s : segments_) {
    if (t >= s.start) segment = &s;
  }
  if (segment == nullptr) return motion;
  const double duration = segment->end - segment->start;
  const double s = std::clamp((t - segment->start) / duration, 0.0, 1.0);
  const double position = MinimumJerk(s);
  const double speed = MinimumJerkRate(s) / duration;
  const double acceleration = 60 * s * (1 - s) * (1 - 2 * s) / (duration * duration);
  motion.X_W.p = segment->from.p + position * segment->translation;
  motion.X_W.q = (RotationFromVector(position * segment->rotation) * segment->from.q).normalized();
  motion.V_W << speed * segment->translation, speed * segment->rotation;
  motion.A_W << acceleration * segment->translation, acceleration * segment->rotation;
  return motion;
}

}  // namespace predictor
