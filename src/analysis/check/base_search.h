// Where the arms should stand: a search for base positions that serve the whole task.
#pragma once

#include <functional>

#include "analysis/check/reach.h"

namespace predictor {

// Called with the share [0, 1] of the work that is done.
using OnProgress = std::function<void(double)>;

// How comfortable an arm, or a pair of links, is on its path: the least of its figures, each over
// what is comfortable (kComfortable... below). 1 and more: comfortable; negative: the path leaves
// the reach, the nearer to 0 the later.
double Comfort(const ArmReach& reach, const RenderingSpec& rendering);
double Comfort(const PairReach& pair, const RenderingSpec& rendering);
double Comfort(const Reach& reach, const RenderingSpec& rendering);  // the least of all

inline constexpr double kComfortableSingularValue = 0.08;      // [m]
inline constexpr double kComfortableJointSpeed = 0.5;          // share of what is allowed
inline constexpr double kComfortableLinkDistance = 4.0 / 3.0;  // times rendering.security_distance

struct BaseProposal {
  std::array<Vector3, kHands> xyz = {Vector3::Zero(), Vector3::Zero()};  // bases in W [m]
  Reach reach;                                                           // with these bases
  double comfort = 0;                                                    // of it
};

// Bases (orientation as it is) of the greatest comfort over the paths, the right arm's the left
// one's mirrored: the best of the present ones and a grid behind, beside and below the handles,
// then along x, y and z by steps of 0.1, 0.05 and 0.025 m. The same result each time. Rounded to 5
// mm.
BaseProposal SearchBases(const Scenario& scenario, const DeviceReach& device,
                         const std::vector<std::vector<IntendedSample>>& paths,
                         const OnProgress& progress);

}  // namespace predictor
