#include "analysis/check/base_search.h"

#include <algorithm>

#include "models/object_model.h"

namespace predictor {
namespace {

constexpr int kSweeps = 6;  // maximum number of sweeps over the arms per step width
constexpr std::array<double, 3> kSteps = {0.1, 0.05, 0.025};  // [m]
// The initial positions of the bases behind, beside and below the handle [m].
constexpr std::array<double, 3> kBehind = {0.35, 0.45, 0.55};
constexpr std::array<double, 3> kOutside = {-0.05, 0.1, 0.25};
constexpr std::array<double, 4> kBelow = {0.2, 0.3, 0.4, 0.5};

// A placement of both arms in which the base of each arm has the same position relative to its
// handle.
struct Placed {
  Vector3 offset = Vector3::Zero();  // position of the left base relative to its handle; mirrored
                                     // for the right arm [m]
  double comfort = 0;
};

class Search {
 public:
  Search(const Scenario& s, const DeviceReach& device, const TaskPathList& paths,
         const OnProgress& progress)
      : s_(s), device_(device), paths_(Thinned(paths)), progress_(progress) {
    for (const int i : s.hands())
      handles_[static_cast<std::size_t>(i)] = paths_[0][0].X_WO * HandlePose(s, i).p;
  }

  std::array<Vector3, kHands> Run() {
    best_ = Place(Present());
    for (const double behind : kBehind)
      for (const double outside : kOutside)
        for (const double below : kBelow) Try({-behind, outside, -below});
    for (const double step : kSteps)
      for (int sweep = 0; sweep < kSweeps && Sweep(step); ++sweep) {
      }
    progress_(1);
    return Bases(best_.offset);
  }

 private:
  const Vector3& Handle(int hand) const { return handles_[static_cast<std::size_t>(hand)]; }

  // Returns rounded positions, mirrored for the right arm.
  std::array<Vector3, kHands> Bases(const Vector3& offset) const {
    std::array<Vector3, kHands> xyz = {Vector3::Zero(), Vector3::Zero()};
    for (const int i : s_.hands()) {
      const Vector3 base = Handle(i) + Mirrored(offset, i);
      xyz[static_cast<std::size_t>(i)] = (base / kRounding).array().round().matrix() * kRounding;
      xyz[static_cast<std::size_t>(i)] += Vector3::Zero();  // no "-0.000"
    }
    return xyz;
  }

  // Returns the mean of the arms' current base positions.
  Vector3 Present() const {
    Vector3 sum = Vector3::Zero();
    int arms = 0;
    for (const int i : s_.hands()) {
      sum += Mirrored(s_.arm(i).base.xyz - Handle(i), i);
      ++arms;
    }
    return sum / std::max(arms, 1);
  }

  static Vector3 Mirrored(const Vector3& offset, int hand) {
    return {offset.x(), hand == 0 ? offset.y() : -offset.y(), offset.z()};
  }

  Placed Place(const Vector3& offset) {
    progress_(std::min(0.99, ++done_ / kWork));
    return {offset, ComfortAt(Bases(offset))};
  }

  double ComfortAt(const std::array<Vector3, kHands>& xyz) const {
    // The bases must not collide with each other.
    std::vector<PairReach> pairs = device_.NoDistances();
    if (s_.Has(0) && s_.Has(1)) pairs.push_back({"bases", {(xyz[0] - xyz[1]).norm(), 0, -1}});
    double comfort = std::numeric_limits<double>::infinity();
    for (const auto& path : paths_) {
      std::array<ArmFollower::Track, kHands> track;
      for (const int i : s_.hands()) {
        const auto h = static_cast<std::size_t>(i);
        track[h] = device_.arm(i)->Follow(path, xyz[h] - s_.arm(i).base.xyz, true);
        comfort = std::min(comfort, Comfort(track[h].reach, s_.rendering));
      }
      if (comfort < 0) return comfort;
      device_.Distances(track[0], track[1], path, &pairs);
    }
    for (const PairReach& pair : pairs) comfort = std::min(comfort, Comfort(pair, s_.rendering));
    return comfort;
  }

  bool Try(const Vector3& offset) {
    constexpr double kBetter = 1e-6;
    const Placed placed = Place(offset);
    if (placed.comfort <= best_.comfort + kBetter) return false;
    best_ = placed;
    return true;
  }

  // Tries one step in both directions of each coordinate. Returns whether one of the steps improved
  // the result.
  bool Sweep(double step) {
    bool better = false;
    for (int axis = 0; axis < 3; ++axis)
      better = Try(best_.offset + step * Vector3::Unit(axis)) ||
               Try(best_.offset - step * Vector3::Unit(axis)) || better;
    return better;
  }

  static constexpr double kRounding = 0.005;  // [m]
  static constexpr double kWork = 80;         // approximate number of positions tried
  const Scenario& s_;
  const DeviceReach& device_;
  TaskPathList paths_;
  std::array<Vector3, kHands> handles_;  // at the start, in W [m]
  const OnProgress& progress_;
  Placed best_;
  double done_ = 0;
};

}  // namespace

TaskPathList Thinned(const TaskPathList& paths) {
  constexpr std::size_t kEvery = 5;  // every n-th sample is sufficient for comparing placements
  TaskPathList thin;
  for (const auto& path : paths) {
    thin.emplace_back();
    for (std::size_t k = 0; k < path.size(); k += kEvery) thin.back().push_back(path[k]);
  }
  return thin;
}

double Comfort(const ArmReach& r, const RenderingSpec& rendering) {
  if (r.lost) return r.reached - 1;
  return std::min({r.singular_value.value / kComfortableSingularValue,
                   r.joint_margin.value / rendering.joint_influence,
                   kComfortableJointSpeed / std::max(r.joint_speed.value, 1e-3)});
}

double Comfort(const PairReach& pair, const RenderingSpec& rendering) {
  return pair.distance.value /
         (kComfortableLinkDistance * std::max(rendering.security_distance, 1e-3));
}

double Comfort(const Reach& reach, const RenderingSpec& rendering) {
  double comfort = std::numeric_limits<double>::infinity();
  for (const auto& arm : reach.arms)
    if (arm) comfort = std::min(comfort, Comfort(*arm, rendering));
  if (comfort < 0) return comfort;
  for (const PairReach& pair : reach.pairs) comfort = std::min(comfort, Comfort(pair, rendering));
  return comfort;
}

BaseProposal SearchBases(const Scenario& scenario, const DeviceReach& device,
                         const TaskPathList& paths, const OnProgress& progress) {
  BaseProposal proposal;
  proposal.xyz = Search(scenario, device, paths, progress).Run();
  std::array<Vector3, kHands> shift = {Vector3::Zero(), Vector3::Zero()};
  for (int i = 0; i < kHands; ++i) {
    const auto h = static_cast<std::size_t>(i);
    if (scenario.Has(i)) shift[h] = proposal.xyz[h] - scenario.arm(i).base.xyz;
  }
  proposal.reach = device.Over(paths, shift);
  proposal.comfort = Comfort(proposal.reach, scenario.rendering);
  return proposal;
}

}  // namespace predictor
