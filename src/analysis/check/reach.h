// Computes the reach of the device along a path of the object, that is, the motion of the arms'
// joints and the worst values on the path.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/arm_limits.h"
#include "models/robot.h"
#include "rig/intended_path.h"
#include "scenario/scenario.h"

namespace predictor {

// A worst value and the time at which it occurs.
struct Extreme {
  double value = 0;
  double time = 0;  // run time [s]
  int joint = -1;   // joint concerned, if any

  static Extreme Smallest() { return {std::numeric_limits<double>::infinity(), 0, -1}; }
  void Lower(double v, double t, int j = -1) {
    if (v < value) *this = {v, t, j};
  }
  void Raise(double v, double t, int j = -1) {
    if (v > value) *this = {v, t, j};
  }
};

struct ArmReach {
  std::optional<double> lost;  // first time at which the handle cannot be at its pose [s]
  double reached = 0;          // share of the path's samples before that time
  // The smallest singular value of the handle's Jacobian, with rotation weighted by
  // rendering.characteristic_length [m].
  Extreme singular_value = Extreme::Smallest();
  Extreme joint_margin = Extreme::Smallest();  // distance to the nearest position limit [rad]
  Extreme joint_speed;  // share of the speed that the velocity limit and (near its end) the
                        // position limit allow; infinite where they allow none
};

struct PairReach {
  std::string name;
  Extreme distance = Extreme::Smallest();  // [m]
};

// The largest speeds of a handle on the path.
struct HandleReach {
  Extreme speed;           // [m/s]
  Extreme rotation_speed;  // [rad/s]
};

struct Reach {
  std::array<std::optional<ArmReach>, kHands> arms;
  std::array<HandleReach, kHands> handles;
  std::vector<PairReach> pairs;
};

// An arm that follows a path.
class ArmFollower {
 public:
  // For each sample, the origins of those links of the arm that occur in the link pairs.
  struct Track {
    ArmReach reach;
    std::vector<std::vector<Vector3>> links;
  };

  // Loads the arm. Throws InputError.
  ArmFollower(const Scenario& scenario, int hand);

  const std::shared_ptr<const RobotModel>& model() const { return model_; }
  const Pose& handle_pose() const { return X_OD_; }
  // Sets the links whose positions Follow stores.
  void Watch(const std::vector<FrameId>& links) { links_ = links; }

  // Follows the object's path sample by sample with damped least squares. The base is moved by
  // `shift` [m]. As in rendering, the joints move as little as possible. The first posture is found
  // as in the emulator. If `give_up` is true, the function returns as soon as the handle is lost.
  Track Follow(const std::vector<IntendedSample>& path, const Vector3& shift, bool give_up) const;

 private:
  void Judge(const JointVector& q, double time, RobotData* data, ArmReach* reach) const;
  void JudgeSpeed(const JointVector& from, const JointVector& to, double dt, double time,
                  ArmReach* reach) const;

  ArmSpec spec_;
  RenderingSpec rendering_;
  double start_offset_;  // distance at which the arm is parked before alignment [m]
  Pose X_OD_;
  std::shared_ptr<const RobotModel> model_;
  FrameId handle_;
  ArmLimits limits_;
  std::vector<FrameId> links_;
};

// The arms of a scenario that has a device. Absent sides are empty.
class DeviceReach {
 public:
  // Throws InputError.
  explicit DeviceReach(const Scenario& scenario);

  const std::optional<ArmFollower>& arm(int hand) const {
    return arms_[static_cast<std::size_t>(hand)];
  }

  // Returns the worst values over all paths, with the bases moved by `shift` [m]. If `give_up` is
  // true, a path ends as soon as a handle is lost.
  Reach Over(const std::vector<std::vector<IntendedSample>>& paths,
             const std::array<Vector3, kHands>& shift = {Vector3::Zero(), Vector3::Zero()},
             bool give_up = false) const;
  // Lowers the distances of the link pairs to the smallest distances that the links of two tracks
  // have along the same path. The distances of the first pair of links belong to the first element
  // of `pairs`.
  void Distances(const ArmFollower::Track& left, const ArmFollower::Track& right,
                 const std::vector<IntendedSample>& path, std::vector<PairReach>* pairs) const;
  std::vector<PairReach> NoDistances() const;

 private:
  struct WatchedPair {
    struct Link {
      std::size_t arm, index;  // index among the links that the arm's track stores
    };
    std::string name;
    std::vector<Link> links;  // two links
  };
  std::array<std::optional<ArmFollower>, kHands> arms_;
  std::vector<WatchedPair> pairs_;
};

inline constexpr double kPathStep = 0.02;  // usual interval of a path's samples [s]

// Returns the paths that a task may take from the object's start. If the operator's script lets go
// and grips again, there are two paths: either the object stays where the hands released it, or the
// object returns to its start. Otherwise there is one.
std::vector<std::vector<IntendedSample>> TaskPaths(const Scenario& scenario, const Pose& X_WO,
                                                   double step);

}  // namespace predictor
