#include "analysis/base_search.h"

#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

using Paths = std::vector<std::vector<IntendedSample>>;

constexpr std::size_t kEvery = 5;  // of the paths' samples are enough to compare bases
constexpr int kSweeps = 6;         // over the arms, at most, for a step width
constexpr std::array<double, 3> kSteps = {0.1, 0.05, 0.025};  // [m]
// Bases to begin with, behind, outside and below the handle [m].
constexpr std::array<double, 3> kBehind = {0.35, 0.45, 0.55};
constexpr std::array<double, 3> kOutside = {-0.05, 0.1, 0.25};
constexpr std::array<double, 4> kBelow = {0.2, 0.3, 0.4, 0.5};

Paths Thinned(const Paths& paths) {
  Paths thin;
  for (const auto& path : paths) {
    thin.emplace_back();
    for (std::size_t k = 0; k < path.size(); k += kEvery) thin.back().push_back(path[k]);
  }
  return thin;
}

// One arm with its base somewhere, over all paths.
struct Placed {
  Vector3 xyz = Vector3::Zero();
  std::vector<ArmFollower::Track> tracks;
  double comfort = -1;  // of the arm alone
};

class Search {
 public:
  Search(const Scenario& s, const DeviceReach& device, const Paths& paths, const OnProgress& progress)
      : s_(s), device_(device), paths_(Thinned(paths)), progress_(progress) {
    for (int i = 0; i < kHands; ++i)
      if (s.Has(i)) hands_.push_back(i);
    const double grid = kBehind.size() * kOutside.size() * kBelow.size();
    work_ = static_cast<double>(hands_.size()) * (grid + 60);
  }

  std::array<Vector3, kHands> Run() {
    for (const int i : hands_) best_[Index(i)] = Place(i, s_.arm(i).base.xyz);
    for (const int i : hands_) TryGrid(i);
    for (const double step : kSteps)
      for (int sweep = 0; sweep < kSweeps && Sweep(step); ++sweep) {
      }
    progress_(1);
    return {best_[0].xyz, best_[1].xyz};
  }

 private:
  static std::size_t Index(int hand) { return static_cast<std::size_t>(hand); }

  Placed Place(int hand, const Vector3& xyz) {
    Placed placed;
    placed.xyz = xyz;
    const Vector3 shift = xyz - s_.arm(hand).base.xyz;
    double comfort = std::numeric_limits<double>::infinity();
    for (const auto& path : paths_) {
      placed.tracks.push_back(device_.arm(hand)->Follow(path, shift, true));
      comfort = std::min(comfort, Comfort(placed.tracks.back().reach, s_.rendering));
      if (comfort < 0) break;
    }
    placed.comfort = comfort;
    progress_(std::min(0.99, ++done_ / work_));
    return placed;
  }

  // Comfort of an arm beside the other one as it stands.
  double Together(int hand, const Placed& placed) const {
    double comfort = placed.comfort;
    const Placed& other = best_[Index(1 - hand)];
    if (comfort < 0 || hands_.size() < 2 || other.comfort < 0) return comfort;
    const Placed& left = hand == 0 ? placed : other;
    const Placed& right = hand == 0 ? other : placed;
    std::vector<PairReach> pairs = device_.NoDistances();
    for (std::size_t p = 0; p < paths_.size(); ++p)
      device_.Distances(left.tracks[p], right.tracks[p], paths_[p], &pairs);
    // The bases themselves may not stand in one another either.
    pairs.push_back({"bases", {(left.xyz - right.xyz).norm(), 0, -1}});
    for (const PairReach& pair : pairs) comfort = std::min(comfort, Comfort(pair, s_.rendering));
    return comfort;
  }

  bool Try(int hand, const Vector3& xyz) {
    constexpr double kBetter = 1e-6;
    Placed placed = Place(hand, xyz);
    if (Together(hand, placed) <= Together(hand, best_[Index(hand)]) + kBetter) return false;
    best_[Index(hand)] = std::move(placed);
    return true;
  }

  void TryGrid(int hand) {
    const Pose X_WD = paths_[0][0].X_WO * s_.handle(hand).pose.ToPose();
    const double side = hand == 0 ? 1 : -1;  // outside: the left arm's left
    for (const double behind : kBehind)
      for (const double outside : kOutside)
        for (const double below : kBelow) {
          const Vector3 xyz = X_WD.p + Vector3(-behind, side * outside, -below);
          Try(hand, (xyz / kRounding).array().round().matrix() * kRounding);
        }
  }

  // One step to either side of each coordinate; whether anything was better.
  bool Sweep(double step) {
    bool better = false;
    for (const int hand : hands_)
      for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0})
          if (Try(hand, best_[Index(hand)].xyz + sign * step * Vector3::Unit(axis))) {
            better = true;
            break;
          }
    return better;
  }

  static constexpr double kRounding = 0.005;  // [m]
  const Scenario& s_;
  const DeviceReach& device_;
  Paths paths_;
  const OnProgress& progress_;
  std::vector<int> hands_;
  std::array<Placed, kHands> best_;
  double done_ = 0;
  double work_ = 1;  // placements, roughly
};

}  // namespace

double Comfort(const ArmReach& r, const RenderingSpec& rendering) {
  if (r.lost) return r.reached - 1;
  return std::min({r.singular_value.value / kComfortableSingularValue,
                   r.joint_margin.value / rendering.joint_influence,
                   kComfortableJointSpeed / std::max(r.joint_speed.value, 1e-3)});
}

double Comfort(const PairReach& pair, const RenderingSpec& rendering) {
  return pair.distance.value / (kComfortableLinkDistance * std::max(rendering.security_distance, 1e-3));
}

double Comfort(const Reach& reach, const RenderingSpec& rendering) {
  double comfort = std::numeric_limits<double>::infinity();
  for (const auto& arm : reach.arms)
    if (arm) comfort = std::min(comfort, Comfort(*arm, rendering));
  if (comfort < 0) return comfort;
  for (const PairReach& pair : reach.pairs) comfort = std::min(comfort, Comfort(pair, rendering));
  return comfort;
}

BaseProposal SearchBases(const Scenario& scenario, const DeviceReach& device, const Paths& paths,
                         const OnProgress& progress) {
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
