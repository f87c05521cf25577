// Computes set-points over time, which move from waypoint to waypoint with minimum jerk and from
// rest to rest.
#pragma once

#include <vector>

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

class SetPointTrajectory {
 public:
  // `start` is the set-point before the first waypoint, to which the waypoints are relative.
  // Without waypoints, the set-point stays at `start`. Throws InputError if the times do not
  // increase from 0.
  SetPointTrajectory(const std::vector<Waypoint>& waypoints, const Pose& start);

  // Returns the pose, the twist and the acceleration of the set-point at time t [s], in W. Between
  // waypoints, position and rotation vector follow 10 s³ − 15 s⁴ + 6 s⁵ (Flash & Hogan 1985). The
  // rotation is about one axis of W.
  FrameMotion At(double t) const noexcept;

 private:
  struct Segment {
    double start, end;    // [s]
    Pose from;            // X_W at the start of the segment
    Vector3 translation;  // in W [m]
    Vector3 rotation;     // rotation vector in W [rad]
  };
  std::vector<Segment> segments_;
  Pose start_;
};

}  // namespace predictor
