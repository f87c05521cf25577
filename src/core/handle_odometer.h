// Measures how far the handles have moved and when they last moved, for stops and their reports.
#pragma once

#include <algorithm>
#include <array>

#include "core/motion.h"
#include "core/types.h"

namespace predictor {

// Path lengths of the handles. They are measured in steps of kStep because the encoders'
// quantisation would otherwise add up.
class HandleOdometer {
 public:
  static constexpr double kStep = 1e-4;  // [m]

  // X_WH: poses of the handles; the poses of absent handles must be constant.
  void Start(const std::array<Pose, kHands>& X_WH) noexcept {
    path_ = {};
    for (std::size_t i = 0; i < kHands; ++i) corner_[i] = X_WH[i].p;
  }
  // Returns the longer of the two handles' paths so far [m].
  double Add(const std::array<Pose, kHands>& X_WH) noexcept {
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

 private:
  friend class StopController;  // saves and loads the state

  // End of the last step of each path.
  std::array<Vector3, kHands> corner_ = {Vector3::Zero(), Vector3::Zero()};
  std::array<double, kHands> path_ = {};  // length up to the corner [m]
};

// Detects whether any handle moves.
class RestDetector {
 public:
  // A handle moves if it is further than this from its last position at rest. Rotation is
  // multiplied by kHandleLength [m].
  static constexpr double kMaxMotion = 5e-5;

  // X_WH: poses of the handles; the poses of absent handles must be constant.
  void Start(const std::array<Pose, kHands>& X_WH) noexcept {
    still_ = X_WH;
    mover_ = -1;
  }
  // Returns whether a handle has moved. in_motion: a driver reports that its arm still moves.
  bool Update(const std::array<Pose, kHands>& X_WH, bool in_motion) noexcept {
    bool moved = in_motion;
    for (std::size_t i = 0; i < kHands; ++i) {
      if (!Differ(still_[i], X_WH[i])) continue;
      moved = true;
      mover_ = static_cast<int>(i);
    }
    if (moved) still_ = X_WH;
    return moved;
  }
  int mover() const noexcept { return mover_; }  // the hand that was last seen moving; −1: none

 private:
  friend class StopController;  // saves and loads the state

  static bool Differ(const Pose& from, const Pose& to) noexcept {
    return (to.p - from.p).norm() > kMaxMotion ||
           kHandleLength * RotationError(to.q, from.q).norm() > kMaxMotion;
  }

  std::array<Pose, kHands> still_;
  int mover_ = -1;
};

}  // namespace predictor
