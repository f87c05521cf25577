// Computes the distance of the carried object from the links of the cobot.
#pragma once

#include <memory>
#include <string>

#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

inline constexpr double kFarthestLink = 2;  // no larger distance is computed [m]

// The nearest of the given links.
struct LinkGap {
  std::string link;                 // "" if none is nearer than kFarthestLink
  double distance = kFarthestLink;  // to the object; negative: depth by which they overlap [m]
};

struct ObjectGaps {
  LinkGap hand;   // of the end-effector, the links fixed to it, and those that they carry
  LinkGap links;  // of all other links
};

// The shapes of a scenario's cobot and object. The engine replaces each mesh by its convex hull.
// The shapes of a link are its collision shapes or, if it has none, its visual shapes. A link that
// has no shapes, or whose meshes the engine cannot read, is represented by bars of the radius
// kBarRadius from its joint to the next joints.
class LinkGaps {
 public:
  static constexpr double kBarRadius = 0.03;  // [m]

  explicit LinkGaps(const Scenario& scenario);
  ~LinkGaps();
  LinkGaps(LinkGaps&&) noexcept;
  LinkGaps& operator=(LinkGaps&&) noexcept;

  // `q` contains the positions of the cobot's joints [rad], [m]. X_WO is the pose of the object.
  ObjectGaps At(const JointVector& q, const Pose& X_WO) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
