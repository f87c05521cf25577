// Computes set-points over time, which move from waypoint to waypoint with minimum jerk and from
// rest to rest.
#pragma once

#include <string>
#include <vector>

#include "core/messages.h"
#include "scenario/field_rules.h"
#include "scenario/scenario.h"
#include "scenario/trajectory_file.h"

namespace predictor {

// The parameters of a controller whose set-point can move.
struct SetPointParameters {
  std::vector<Waypoint> trajectory;  // empty: the set-point stays at the cobot's start
  std::string trajectory_file;       // empty after loading, which reads it into `trajectory`
};

template <class V>
void Fields(V& v, SetPointParameters& p) {
  v("trajectory", p.trajectory,
    List(Part("points that the set-point passes; none: it stays where the cobot starts"), 0,
         kMaxWaypoints));
  v("trajectory_file", p.trajectory_file,
    Word("CSV with these points, relative to this file: time [s], x, y, z [m], and optionally "
         "roll, pitch, yaw [rad]"));
}

// Moves a set-point by `shift`: a translation [m] and a rotation vector [rad] in W.
inline void ShiftPose(const Vector6& shift, Pose* X_W) noexcept {
  if (shift.isZero(0)) return;
  X_W->p += shift.head<3>();
  X_W->q = RotationFromVector(shift.tail<3>()) * X_W->q;
}

// Returns 1 for each axis with a stiffness [N/m], [N·m/rad], and 0 for the others.
inline Vector6 StiffAxes(const Vector6& stiffness) noexcept {
  return (stiffness.array() > 0).cast<double>();
}

class SetPointTrajectory {
 public:
  // `start` is the set-point before the first waypoint, to which the waypoints are relative.
  // Without waypoints, the set-point stays at `start`. Throws InputError if the times do not
  // increase from 0.
  SetPointTrajectory(const std::vector<Waypoint>& waypoints, const Pose& start);

  // Returns the pose, the twist and the acceleration of the set-point at time t [s], in W. Between
  // waypoints, position and rotation vector follow 10 s³ − 15 s⁴ + 6 s⁵ (Flash & Hogan 1985). The
  // rotation is about one axis of W. If `path` is not null, it receives PathAt(t).
  FrameMotion At(double t, Vector6* path = nullptr) const noexcept;
  // Returns the integral of the set-point's twist from the start to time t [m], [rad].
  Vector6 PathAt(double t) const noexcept;

 private:
  struct Segment {
    double start, end;    // [s]
    Pose from;            // X_W at the start of the segment
    Vector3 translation;  // in W [m]
    Vector3 rotation;     // rotation vector in W [rad]
    Vector6 before;       // sum of the translations and rotation vectors of the earlier segments
    double Share(double t) const noexcept;  // of the segment's time that has passed, from 0 to 1
    // Returns the path at a share of the segment's displacement.
    Vector6 Path(double position) const noexcept;
  };
  const Segment* SegmentAt(double t) const noexcept;  // the last that has begun, or null

  std::vector<Segment> segments_;
  Pose start_;
};

}  // namespace predictor
