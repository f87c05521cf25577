// Writes the tasks of inverse kinematics as rows of a least-squares problem.
#pragma once

#include <array>
#include <optional>

#include "person/posture_solver.h"

namespace predictor::person {

inline constexpr double kRotationLength = 0.2;  // weighs rotation against translation [m/rad]
// The weight of the oblique angle between the bar and a hand that can turn about the bar [1/rad²],
// and the largest such angle (D).
inline constexpr double kObliqueWeight = 5e-3, kMaxOblique = 0.7;
inline constexpr int kMaxTaskRows = 28;

// The error e = goal - value and the Jacobian of the value. Each row is scaled by the square root
// of its weight.
struct TaskRows {
  Eigen::Matrix<double, kMaxTaskRows, kBodyJoints, Eigen::RowMajor> J;
  Eigen::Matrix<double, kMaxTaskRows, 1> e;
  int count = 0;

  auto jacobian() const { return J.topRows(count); }
  auto error() const { return e.head(count); }
};

// The goals of a sample in S, and the tasks' rows at a posture.
class PostureTasks {
 public:
  PostureTasks(const BodyModel& model, const Stance& stance, const std::array<Grip, kHands>& grips,
               const PosturePrior& prior, const BodySample& sample);

  // Computes the rows of the hands alone (for a hand that turns, only its position), or of all
  // tasks. Jacobians are computed only on request.
  void Rows(const BodyVector& q, bool hands_only, bool with_jacobian, TaskRows* rows) const;
  // Writes the errors of all tasks.
  void Judge(Posture* posture) const;

 private:
  Vector6 HandError(const Placement& at, int hand) const;  // [m], [rad], in the goal's axes
  void AddHand(const Placement& at, int hand, bool hands_only, bool with_jacobian,
               TaskRows* rows) const;
  void AddElbow(const Placement& at, int hand, bool with_jacobian, TaskRows* rows) const;
  void AddSwivel(const Placement& at, int hand, bool with_jacobian, TaskRows* rows) const;
  void AddHead(const Placement& at, bool with_jacobian, TaskRows* rows) const;

  const BodyModel& model_;
  const PosturePrior& prior_;
  std::array<std::optional<Pose>, kHands> grip_goal_;  // X_SG
  std::array<Pose, kHands> X_JG_;
  std::array<bool, kHands> turns_ = {};
  std::array<std::optional<Vector3>, kHands> elbow_goal_;
  std::optional<Pose> head_goal_;
  bool head_turn_counts_;
};

}  // namespace predictor::person
