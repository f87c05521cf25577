// Searches for base positions of the arms that suit the whole task.
#pragma once

#include <functional>

#include "analysis/check/reach.h"

namespace predictor {

// Receives the completed share of the work [0, 1].
using OnProgress = std::function<void(double)>;

using TaskPathList = std::vector<std::vector<IntendedSample>>;

// Returns the comfort of an arm or a link pair on its path. Each result is divided by a comfortable
// value (kComfortable... below), and the comfort is the smallest of these ratios. A value of at
// least 1 is comfortable. A negative value means that the path leaves the reach. The later the path
// leaves the reach, the closer the value is to 0.
double Comfort(const ArmReach& reach, const RenderingSpec& rendering);
double Comfort(const PairReach& pair, const RenderingSpec& rendering);
double Comfort(const Reach& reach, const RenderingSpec& rendering);  // the smallest of all

inline constexpr double kComfortableSingularValue = 0.08;  // [m]
inline constexpr double kComfortableJointSpeed = 0.5;      // as a share of the limit
// The comfortable distance of two links, as a multiple of rendering.security_distance.
inline constexpr double kComfortableLinkDistance = 4.0 / 3.0;

struct BaseProposal {
  std::array<Vector3, kHands> xyz = {Vector3::Zero(), Vector3::Zero()};  // bases in W [m]
  Reach reach;                                                           // with these bases
  double comfort = 0;                                                    // comfort of `reach`
};

// Returns the bases with the greatest comfort over the paths. The orientation of the bases stays
// the same. The right arm's base mirrors the left arm's base. The search starts with the best
// placement among the current one and a grid behind, beside and below the handles. The search then
// moves the bases along x, y and z in steps of 0.1, 0.05 and 0.025 m. The result is repeatable and
// rounded to 5 mm.
BaseProposal SearchBases(const Scenario& scenario, const DeviceReach& device,
                         const TaskPathList& paths, const OnProgress& progress);

// Returns a subset of the paths' samples that suffices to compare placements.
TaskPathList Thinned(const TaskPathList& paths);

}  // namespace predictor
