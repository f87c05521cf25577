// Detects whether the handles move. The stops and the summary of the stops use this.
#pragma once

#include <array>

#include "core/motion.h"
#include "core/types.h"

namespace predictor {

// Detects whether any handle moves.
class RestDetector {
 public:
  // A handle moves if its distance from its last pose at rest is larger than this value [m].
  // Rotation is multiplied by kHandleLength.
  static constexpr double kMaxMotion = 5e-5;

  // `X_WH` contains the poses of the handles in W. The poses of absent handles must be constant.
  void Start(const std::array<Pose, kHands>& X_WH) noexcept {
    still_ = X_WH;
    mover_ = -1;
  }
  // Returns whether a handle moved. `in_motion` states whether a driver reports that its arm still
  // moves.
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
