// Names the bodies that cobot.touches allows to collide.
#pragma once

#include <string>

namespace predictor {

// Whether two bodies collide, or why they do not.
enum class PairState {
  kCanTouch,
  kOverlaps,  // they overlap at cobot.posture, or are closer than 1 mm
  kJoint,     // a joint connects them, or several joints with links without shapes in between
  kOneBody,   // they are rigidly connected
  kHolds,     // the link belongs to the hand that holds the object
};

// A link of the cobot that has collision shapes, and another link or the carried object.
struct ContactPair {
  std::string link, other;  // other: empty for the object
  PairState state = PairState::kCanTouch;
  double distance = 0;  // at the present positions, at most kFarthestPair; negative: depth of the
                        // overlap; 0 except for kCanTouch and kOverlaps [m]
};
inline constexpr double kFarthestPair = 2;  // [m]

}  // namespace predictor
