#include "analysis/check/reach.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "emulator/placement.h"
#include "haptics/approach_speed.h"
#include "haptics/link_pairs.h"
#include "models/object_model.h"

namespace predictor {
namespace {

constexpr double kBlocked = 1e-9;  // allowed speed that counts as none [rad/s]
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Keeps the worse of two values.
void Merge(const ArmReach& other, ArmReach* reach) {
  if (other.lost && (!reach->lost || *other.lost < *reach->lost)) reach->lost = other.lost;
  reach->reached = std::min(reach->reached, other.reached);
  const auto lower = [](const Extreme& a, Extreme* b) {
    if (a.value < b->value) *b = a;
  };
  const auto raise = [](const Extreme& a, Extreme* b) {
    if (a.value > b->value) *b = a;
  };
  lower(other.singular_value, &reach->singular_value);
  lower(other.joint_margin, &reach->joint_margin);
  raise(other.joint_speed, &reach->joint_speed);
}

double SmallestSingularValue(Jacobian J, double characteristic_length) {
  J.bottomRows<3>() *= characteristic_length;
  return std::sqrt(std::max(0.0, SymmetricEigenvaluesOf(J * J.transpose())[0]));
}

bool SamePose(const Pose& a, const Pose& b) { return a.p == b.p && a.q.coeffs() == b.q.coeffs(); }

}  // namespace

ArmFollower::ArmFollower(const Scenario& s, int hand)
    : spec_(s.arm(hand)),
      rendering_(s.rendering),
      start_offset_(s.rig.start_offset),
      X_OD_(HandlePose(s, hand)),
      model_(LoadArm(s, hand)),
      handle_(model_->Frame(spec_.end_effector, spec_.handle.ToPose())),
      limits_(LimitsOf(spec_, *model_)) {}

ArmFollower::Track ArmFollower::Follow(const std::vector<IntendedSample>& path,
                                       const Vector3& shift, bool give_up) const {
  Track track;
  track.links.reserve(path.size());
  RobotData data(*model_);
  // The base of the model is fixed. Instead of the base, the goals are shifted in the opposite
  // direction.
  const auto goal = [&](std::size_t k) {
    Pose X = path[k].X_WO * X_OD_;
    X.p -= shift;
    return X;
  };
  JointVector q;
  PlaceArm(spec_, *model_, handle_, goal(0), start_offset_, &q);
  std::size_t good = 0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    const JointVector before = q;
    const bool rests = k > 0 && SamePose(path[k].X_WO, path[k - 1].X_WO);
    const bool reached = rests || SolveInverseKinematics(*model_, handle_, goal(k), before, 0, &q);
    if (!reached && !track.reach.lost) track.reach.lost = path[k].time;
    if (track.reach.lost && give_up) break;
    if (!track.reach.lost) ++good;
    // A posture that misses its goal provides no information, and neither does the motion to this
    // posture.
    if (!rests && !track.reach.lost) {
      if (k > 0) JudgeSpeed(before, q, path[k].time - path[k - 1].time, path[k].time, &track.reach);
      Judge(q, path[k].time, &data, &track.reach);
    }
    if (!rests) data.UpdateKinematics(*model_, q, JointVector::Zero(q.size()));
    track.links.emplace_back();
    for (const FrameId& link : links_)
      track.links.back().push_back(data.FramePose(*model_, link).p + shift);
  }
  track.reach.reached =
      path.empty() ? 1 : static_cast<double>(good) / static_cast<double>(path.size());
  return track;
}

void ArmFollower::Judge(const JointVector& q, double time, RobotData* data, ArmReach* reach) const {
  data->UpdateKinematics(*model_, q, JointVector::Zero(q.size()));
  Jacobian J;
  data->FrameJacobian(*model_, handle_, &J);
  reach->singular_value.Lower(SmallestSingularValue(J, rendering_.characteristic_length), time);
  for (int j = 0; j < q.size(); ++j)
    reach->joint_margin.Lower(std::min(q[j] - limits_.lower[j], limits_.upper[j] - q[j]), time, j);
}

void ArmFollower::JudgeSpeed(const JointVector& from, const JointVector& to, double dt, double time,
                             ArmReach* reach) const {
  // These bounds are the same as in rendering, equations (13) to (15).
  const double gain =
      rendering_.joint_gain / (rendering_.joint_influence - rendering_.joint_security);
  for (int j = 0; j < to.size(); ++j) {
    const double v = (to[j] - from[j]) / dt;
    const double distance = v > 0 ? limits_.upper[j] - from[j] : from[j] - limits_.lower[j];
    const double approach =
        ApproachSpeed(distance - rendering_.joint_security, gain, limits_.acceleration[j]);
    const double allowed = std::min(limits_.velocity[j], approach);
    // If a limit is already violated, tiny motions away from this limit do not count as speed.
    if (std::fabs(v) > 1e-6)
      reach->joint_speed.Raise(allowed > kBlocked ? std::fabs(v) / allowed : kInfinite, time, j);
  }
}

DeviceReach::DeviceReach(const Scenario& s) {
  std::array<std::shared_ptr<const RobotModel>, kHands> models;
  for (const int i : s.hands()) {
    const auto h = static_cast<std::size_t>(i);
    arms_[h].emplace(s, i);
    models[h] = arms_[h]->model();
  }
  std::array<std::vector<FrameId>, kHands> links;
  for (const LinkPair& pair : LinkPairs(s, models)) {
    WatchedPair watched;
    watched.name = pair.name;
    for (const auto& [arm, frame] :
         {std::pair(pair.arm_a, pair.a), std::pair(pair.arm_b, pair.b)}) {
      std::vector<FrameId>& of_arm = links[static_cast<std::size_t>(arm)];
      watched.links.push_back({static_cast<std::size_t>(arm), of_arm.size()});
      of_arm.push_back(frame);
    }
    pairs_.push_back(std::move(watched));
  }
  for (std::size_t h = 0; h < kHands; ++h)
    if (arms_[h]) arms_[h]->Watch(links[h]);
}

std::vector<PairReach> DeviceReach::NoDistances() const {
  std::vector<PairReach> pairs;
  for (const WatchedPair& pair : pairs_) pairs.push_back({pair.name, Extreme::Smallest()});
  return pairs;
}

void DeviceReach::Distances(const ArmFollower::Track& left, const ArmFollower::Track& right,
                            const std::vector<IntendedSample>& path,
                            std::vector<PairReach>* pairs) const {
  const std::array<const ArmFollower::Track*, kHands> tracks = {&left, &right};
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const WatchedPair::Link &a = pairs_[p].links[0], &b = pairs_[p].links[1];
    const auto &at = tracks[a.arm]->links, &bt = tracks[b.arm]->links;
    for (std::size_t k = 0; k < std::min(at.size(), bt.size()); ++k)
      (*pairs)[p].distance.Lower((at[k][a.index] - bt[k][b.index]).norm(), path[k].time);
  }
}

Reach DeviceReach::Over(const std::vector<std::vector<IntendedSample>>& paths,
                        const std::array<Vector3, kHands>& shift, bool give_up) const {
  Reach reach;
  reach.pairs = NoDistances();
  for (const auto& path : paths) {
    std::array<ArmFollower::Track, kHands> track;
    for (std::size_t h = 0; h < kHands; ++h) {
      if (!arms_[h]) continue;
      track[h] = arms_[h]->Follow(path, shift[h], give_up);
      if (reach.arms[h])
        Merge(track[h].reach, &*reach.arms[h]);
      else
        reach.arms[h] = track[h].reach;
      const Vector3& p_OD = arms_[h]->handle_pose().p;
      for (const IntendedSample& sample : path) {
        if (!sample.held) continue;
        const Twist V = ShiftTwist(sample.V_WO, sample.X_WO.q * p_OD);
        reach.handles[h].speed.Raise(V.head<3>().norm(), sample.time);
        reach.handles[h].rotation_speed.Raise(V.tail<3>().norm(), sample.time);
      }
    }
    Distances(track[0], track[1], path, &reach.pairs);
  }
  return reach;
}

std::vector<std::vector<IntendedSample>> TaskPaths(const Scenario& s, const Pose& X_WO,
                                                   double step) {
  std::vector<std::vector<IntendedSample>> paths = {
      IntendedPath(s, X_WO, AfterRelease::kReturns, step)};
  if (GripsAgain(s)) paths.push_back(IntendedPath(s, X_WO, AfterRelease::kStays, step));
  return paths;
}

}  // namespace predictor
