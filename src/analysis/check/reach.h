// Reach of the device over a path of the object: where the arms' joints go, and what is worst.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptics/limits.h"
#include "haptics/renderer.h"
#include "models/robot.h"
#include "rig/intended_path.h"
#include "scenario/scenario.h"

namespace predictor {

// A worst value, and when.
struct Extreme {
  double value = 0;
  double time = 0;  // of the run [s]
  int joint = -1;   // if it is a joint's

  static Extreme Smallest() { return {std::numeric_limits<double>::infinity(), 0, -1}; }
  void Lower(double v, double t, int j = -1) {
    if (v < value) *this = {v, t, j};
  }
  void Raise(double v, double t, int j = -1) {
    if (v > value) *this = {v, t, j};
  }
};

struct ArmReach {
  std::optional<double> lost;  // when the handle first cannot be where it should [s]
  double reached = 0;          // share of the path's samples up to there
  Extreme singular_value = Extreme::Smallest();  // smallest of the handle's Jacobian, rotation
                                                 // weighted by rendering.rotation_length [m]
  Extreme joint_margin = Extreme::Smallest();    // to the nearest position limit [rad]
  Extreme joint_speed;  // share of what limits of velocity and (near its end) position allow
};

struct PairReach {
  std::string name;
  Extreme distance = Extreme::Smallest();  // [m]
};

// Motion of the handles themselves.
struct HandleReach {
  Extreme speed;           // [m/s]
  Extreme rotation_speed;  // [rad/s]
};

struct Reach {
  std::array<std::optional<ArmReach>, kHands> arms;
  std::array<HandleReach, kHands> handles;
  std::vector<PairReach> pairs;
};

// One arm as it follows a path.
class ArmFollower {
 public:
  // Origins of the arm's links of the pairs, one list a sample.
  struct Track {
    ArmReach reach;
    std::vector<std::vector<Vector3>> links;
  };

  // Loads the arm. Throws InputError.
  ArmFollower(const Scenario& scenario, int hand);

  const std::shared_ptr<const RobotModel>& model() const { return model_; }
  // Links whose positions Follow keeps.
  void Watch(const std::vector<FrameId>& links) { links_ = links; }

  // Follows the object's path with the base moved by `shift` [m], from sample to sample by damped
  // least squares as rendering does by velocities: the smallest joint motion that does it. The
  // first posture is found as the emulator finds it. With `give_up` ends where the handle is lost.
  Track Follow(const std::vector<IntendedSample>& path, const Vector3& shift, bool give_up) const;

 private:
  void Judge(const JointVector& q, double time, RobotData* data, ArmReach* reach) const;
  void JudgeSpeed(const JointVector& from, const JointVector& to, double dt, double time,
                  ArmReach* reach) const;

  ArmSpec spec_;
  RenderingSpec rendering_;
  double start_offset_;  // where the arm is parked before it aligns [m]
  Pose X_OD_;
  std::shared_ptr<const RobotModel> model_;
  FrameId handle_;
  ArmLimits limits_;
  std::vector<FrameId> links_;
};

// The arms of a scenario that has a device; absent sides empty.
class DeviceReach {
 public:
  // Throws InputError.
  explicit DeviceReach(const Scenario& scenario);

  const std::optional<ArmFollower>& arm(int hand) const {
    return arms_[static_cast<std::size_t>(hand)];
  }
  int pairs() const { return static_cast<int>(pairs_.size()); }

  // Worst over all paths, bases moved by `shift` [m].
  Reach Over(const std::vector<std::vector<IntendedSample>>& paths,
             const std::array<Vector3, kHands>& shift = {Vector3::Zero(), Vector3::Zero()}) const;
  // Lowers the link pairs' distances, the first of `pairs`, by two tracks along the same path.
  void Distances(const ArmFollower::Track& left, const ArmFollower::Track& right,
                 const std::vector<IntendedSample>& path, std::vector<PairReach>* pairs) const;
  std::vector<PairReach> NoDistances() const;

 private:
  struct WatchedPair {
    struct Link {
      std::size_t arm, index;  // among the links that the arm's track keeps
    };
    std::string name;
    std::vector<Link> links;  // two
  };
  const Scenario& scenario_;
  std::array<std::optional<ArmFollower>, kHands> arms_;
  std::vector<WatchedPair> pairs_;
};

// Paths that a task may take from the object's start: if the script lets go and grips again, one
// with the object staying where it is and one with it back at its start, otherwise one.
std::vector<std::vector<IntendedSample>> TaskPaths(const Scenario& scenario, const Pose& X_WO,
                                                   double step);

}  // namespace predictor
