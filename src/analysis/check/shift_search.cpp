#include "analysis/check/shift_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/object_model.h"

namespace predictor {
namespace {

constexpr double kDegree = std::numbers::pi / 180;  // [rad]
constexpr int kMaxSweeps = 6;                       // sweeps over the coordinates per step width
struct StepWidth {
  double length, angle;  // [m], [rad]
};
constexpr std::array<StepWidth, 3> kWidths = {
    {{0.1, 20 * kDegree}, {0.05, 10 * kDegree}, {0.025, 5 * kDegree}}};
// The initial positions of the bases behind (or, if negative, in front of) and below the handles
// [m].
constexpr std::array<double, 6> kStartsBehind = {0.35, 0.45, 0.55, -0.35, -0.45, -0.55};
constexpr std::array<double, 4> kStartsBelow = {0.2, 0.3, 0.4, 0.5};

Quaternion Turn(double yaw) { return PoseFromXyzRpy(Vector3::Zero(), {0, 0, yaw}).q; }

class ShiftSearch {
 public:
  ShiftSearch(const Scenario& s, const TaskPathList& paths, const OnProgress& progress)
      : scenario_(s), paths_(Thinned(paths)), progress_(progress) {
    const double arms = s.hands().count();
    for (const int i : s.hands()) {
      bases_ += s.arm(i).base.xyz / arms;
      places_[static_cast<std::size_t>(i)] = HandlePose(s, i).p;
      handles_ += paths[0][0].X_WO * places_[static_cast<std::size_t>(i)] / arms;
    }
  }

  PoseSpec Run(const PoseSpec& present) {
    const double yaw = present.rpy.z();
    best_ = Placed(yaw, Turn(-yaw) * (bases_ - present.xyz) - handles_);
    for (const double start : StartYaws(yaw))
      for (const double behind : kStartsBehind)
        for (const double below : kStartsBelow) Try(start, {-behind, 0, -below});
    for (const StepWidth& width : kWidths)
      for (int sweep = 0; sweep < kMaxSweeps && Sweep(width); ++sweep) {
      }
    progress_(1);
    return ShiftOf(best_.yaw, best_.offset);
  }

 private:
  struct Candidate {
    double yaw = 0;                    // of W in R [rad]
    Vector3 offset = Vector3::Zero();  // middle of the bases relative to that of the handles, at
                                       // the start, in W [m]
    double comfort = 0;
  };

  std::vector<double> StartYaws(double present) const {
    constexpr double kShortLine = 0.05;  // a line between the handles that is shorter than this,
                                         // seen from above, has no reliable direction [m]
    if (scenario_.hands().count() < kHands) {
      std::vector<double> turns;
      for (int quarter = 0; quarter < 4; ++quarter)
        turns.push_back(present + quarter * std::numbers::pi / 2);
      return turns;
    }
    const Vector3 bases = scenario_.arm(1).base.xyz - scenario_.arm(0).base.xyz;
    const Vector3 handles = paths_[0][0].X_WO.q * Vector3(places_[1] - places_[0]);
    if (bases.head<2>().norm() < kShortLine || handles.head<2>().norm() < kShortLine)
      return {present};
    return {present, std::atan2(bases.y(), bases.x()) - std::atan2(handles.y(), handles.x())};
  }

  PoseSpec ShiftOf(double yaw, const Vector3& offset) const {
    constexpr double kRoundLength = 0.005;  // [m]
    const double turn = kDegree * std::round(std::remainder(yaw, 2 * std::numbers::pi) / kDegree);
    const Vector3 p = bases_ - Turn(turn) * (offset + handles_);
    PoseSpec shift;
    shift.xyz = (p / kRoundLength).array().round().matrix() * kRoundLength;
    shift.rpy.z() = turn;
    shift.xyz += Vector3::Zero();  // no "-0.000"
    return shift;
  }

  Candidate Placed(double yaw, const Vector3& offset) {
    constexpr double kWork = 150;  // approximate number of placements tried
    progress_(std::min(0.99, ++done_ / kWork));
    Scenario moved = scenario_;
    moved.environment.shift = ShiftOf(yaw, offset);
    const Reach reach = DeviceReach(moved).Over(paths_, {Vector3::Zero(), Vector3::Zero()}, true);
    return {yaw, offset, Comfort(reach, moved.rendering)};
  }

  bool Try(double yaw, const Vector3& offset) {
    constexpr double kBetter = 1e-6;
    const Candidate candidate = Placed(yaw, offset);
    if (candidate.comfort <= best_.comfort + kBetter) return false;
    best_ = candidate;
    return true;
  }

  // Tries one step in both directions of each coordinate. Returns whether the result improved.
  bool Sweep(const StepWidth& width) {
    bool better = false;
    for (const double sign : {1.0, -1.0}) {
      for (int axis = 0; axis < 3; ++axis)
        better = Try(best_.yaw, best_.offset + sign * width.length * Vector3::Unit(axis)) || better;
      better = Try(best_.yaw + sign * width.angle, best_.offset) || better;
    }
    return better;
  }

  const Scenario& scenario_;
  TaskPathList paths_;
  const OnProgress& progress_;
  Vector3 bases_ = Vector3::Zero();     // their middle, in R [m]
  std::array<Vector3, kHands> places_;  // of the existing handles in O [m]
  Vector3 handles_ = Vector3::Zero();   // their middle at the start, in W [m]
  Candidate best_;
  double done_ = 0;
};

}  // namespace

ShiftProposal SearchShift(const Scenario& scenario, const TaskPathList& paths,
                          const OnProgress& progress) {
  ShiftProposal proposal;
  proposal.shift =
      ShiftSearch(scenario, paths, progress).Run(scenario.environment.shift.value_or(PoseSpec()));
  Scenario moved = scenario;
  moved.environment.shift = proposal.shift;
  proposal.reach = DeviceReach(moved).Over(paths);
  proposal.comfort = Comfort(proposal.reach, scenario.rendering);
  return proposal;
}

}  // namespace predictor
