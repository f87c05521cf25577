#include "person/posture_tasks.h"

#include <algorithm>
#include <cmath>

namespace predictor::person {
namespace {

constexpr double kElbowWeight = 1;    // [1/m²]
constexpr double kHeadWeight = 0.3;   // [1/m²]; times kRotationLength² [1/rad²]
constexpr double kDifference = 1e-6;  // step of numerical differentiation [m]

// The points of an arm in S [m].
struct ArmPoints {
  Vector3 shoulder, elbow, wrist;
};

// Returns the displacement of the elbow [m] outward about the line from shoulder to wrist that is
// needed to reach `swivel` [rad]. The displacement fades to zero as the reference direction of the
// angle becomes parallel to that line.
double MissingSwivel(const ArmPoints& arm, int hand, double swivel) {
  const double side = hand == 0 ? 1 : -1;
  const Vector3 line = arm.wrist - arm.shoulder;
  const Vector3 n = line.normalized();
  const Vector3 radial = arm.elbow - arm.shoulder - n * (arm.elbow - arm.shoulder).dot(n);
  const double radius = radial.norm();
  if (!(radius > 1e-9)) return 0;
  const Vector3 behind_down(-0.5, 0, -std::sqrt(0.75));
  const Vector3 down = behind_down - n * behind_down.dot(n);  // 0 if n is parallel to behind_down
  const Vector3 goal = std::cos(swivel) * down + std::sin(swivel) * side * n.cross(down);
  return goal.dot(n.cross(radial));
}

Eigen::Matrix<double, 1, 9> SwivelGradient(const ArmPoints& arm, int hand, double swivel) {
  Eigen::Matrix<double, 1, 9> gradient;
  for (int i = 0; i < 9; ++i) {
    double value[2];
    for (int s = 0; s < 2; ++s) {
      ArmPoints moved = arm;
      Vector3& point = i < 3 ? moved.shoulder : i < 6 ? moved.elbow : moved.wrist;
      point[i % 3] += s == 0 ? -kDifference : kDifference;
      value[s] = MissingSwivel(moved, hand, swivel);
    }
    gradient[i] = (value[1] - value[0]) / (2 * kDifference);
  }
  return gradient;
}

template <class Jacobian, class Error>
void Append(double scale, const Jacobian* J, const Error& e, TaskRows* rows) {
  const int n = static_cast<int>(e.size());
  rows->e.segment(rows->count, n) = scale * e;
  if (J != nullptr) rows->J.middleRows(rows->count, n) = scale * *J;
  rows->count += n;
}

}  // namespace

PostureTasks::PostureTasks(const BodyModel& model, const Stance& stance,
                           const std::array<Grip, kHands>& grips, const PosturePrior& prior,
                           const BodySample& sample)
    : model_(model), prior_(prior), head_turn_counts_(sample.head_rotation_measured) {
  const Pose X_SW = stance.X_WS.Inverse();
  for (int hand = 0; hand < kHands; ++hand) {
    const auto k = static_cast<std::size_t>(hand);
    X_JG_[k] = GripInHand(model.anthropometry(), hand, grips[k].kind);
    turns_[k] = grips[k].turns;
    if (sample.hands[k].present) grip_goal_[k] = X_SW * sample.hands[k].X_WD * grips[k].X_DG;
    if (sample.p_WElbow[k]) elbow_goal_[k] = X_SW * *sample.p_WElbow[k];
  }
  if (sample.X_WHead) head_goal_ = X_SW * *sample.X_WHead;
}

void PostureTasks::Rows(const BodyVector& q, bool hands_only, bool with_jacobian,
                        TaskRows* rows) const {
  rows->count = 0;
  const Placement at = Place(model_, q);
  for (int hand = 0; hand < kHands; ++hand) {
    AddHand(at, hand, hands_only, with_jacobian, rows);
    if (hands_only) continue;
    AddElbow(at, hand, with_jacobian, rows);
    AddSwivel(at, hand, with_jacobian, rows);
  }
  if (!hands_only) AddHead(at, with_jacobian, rows);
}

Vector6 PostureTasks::HandError(const Placement& at, int hand) const {
  const auto k = static_cast<std::size_t>(hand);
  const Pose& goal = *grip_goal_[k];
  const Pose now = at.FrameOf(Of(hand, ArmJoint::kWristDeviation)) * X_JG_[k];
  Vector6 error;
  error.head<3>() = goal.q.conjugate() * (goal.p - now.p);
  if (turns_[k]) {
    // The error concerns only the direction of the bar, and is measured by the chord between the
    // unit vectors.
    error.tail<3>() = Vector3::UnitX() - goal.q.conjugate() * (now.q * Vector3::UnitX());
  } else {
    error.tail<3>() = goal.q.conjugate() * RotationError(goal.q, now.q);
  }
  return error;
}

void PostureTasks::AddHand(const Placement& at, int hand, bool hands_only, bool with_jacobian,
                           TaskRows* rows) const {
  const auto k = static_cast<std::size_t>(hand);
  if (!grip_goal_[k]) return;
  const int count = turns_[k] && hands_only ? 3 : 6;
  const double rotation = turns_[k] ? std::sqrt(kObliqueWeight) : kRotationLength;
  Vector6 e = HandError(at, hand);
  e.tail<3>() *= rotation;
  rows->e.segment(rows->count, count) = e.head(count);
  if (with_jacobian) {
    const int joint = Of(hand, ArmJoint::kWristDeviation);
    BodyJacobian J = JacobianAt(model_, at, joint, at.FrameOf(joint) * X_JG_[k].p);
    const Matrix3 to_goal = grip_goal_[k]->q.conjugate().toRotationMatrix();
    J.topRows<3>() = to_goal * J.topRows<3>();
    J.bottomRows<3>() = rotation * to_goal * J.bottomRows<3>();
    if (turns_[k]) {
      const Vector3 bar = Vector3::UnitX() - HandError(at, hand).tail<3>();
      J.bottomRows<3>() = -Skew(bar) * J.bottomRows<3>();
    }
    rows->J.middleRows(rows->count, count) = J.topRows(count);
  }
  rows->count += count;
}

void PostureTasks::AddElbow(const Placement& at, int hand, bool with_jacobian,
                            TaskRows* rows) const {
  const auto k = static_cast<std::size_t>(hand);
  if (!elbow_goal_[k]) return;
  const int joint = Of(hand, ArmJoint::kElbowFlexion);
  const Vector3 p = at.p[static_cast<std::size_t>(joint)];
  const Vector3 e = *elbow_goal_[k] - p;
  Eigen::Matrix<double, 3, kBodyJoints> J;
  if (with_jacobian) J = JacobianAt(model_, at, joint, p).topRows<3>();
  Append(std::sqrt(kElbowWeight), with_jacobian ? &J : nullptr, e, rows);
}

void PostureTasks::AddSwivel(const Placement& at, int hand, bool with_jacobian,
                             TaskRows* rows) const {
  const auto k = static_cast<std::size_t>(hand);
  if (!grip_goal_[k] || elbow_goal_[k]) return;
  const int joints[3] = {Of(hand, ArmJoint::kShoulderRotation), Of(hand, ArmJoint::kElbowFlexion),
                         Of(hand, ArmJoint::kPronation)};
  const auto point = [&](int i) { return at.p[static_cast<std::size_t>(joints[i])]; };
  const ArmPoints arm{point(0), point(1), point(2)};
  Eigen::Matrix<double, 1, 1> e(MissingSwivel(arm, hand, prior_.swivel[k]));
  Eigen::Matrix<double, 1, kBodyJoints> J;
  if (with_jacobian) {
    const Eigen::Matrix<double, 1, 9> gradient = SwivelGradient(arm, hand, prior_.swivel[k]);
    J.setZero();
    for (int i = 0; i < 3; ++i)
      J -= gradient.segment<3>(3 * i) * JacobianAt(model_, at, joints[i], point(i)).topRows<3>();
  }
  Append(std::sqrt(prior_.swivel_weight), with_jacobian ? &J : nullptr, e, rows);
}

void PostureTasks::AddHead(const Placement& at, bool with_jacobian, TaskRows* rows) const {
  if (!head_goal_) return;
  const Pose now =
      at.FrameOf(kNeckTwist) * Pose{model_.anthropometry().eyes, Quaternion::Identity()};
  Vector6 e = PoseError(*head_goal_, now);
  const double rotation = head_turn_counts_ ? kRotationLength : 0;
  e.tail<3>() *= rotation;
  BodyJacobian J;
  if (with_jacobian) {
    J = JacobianAt(model_, at, kNeckTwist, now.p);
    J.bottomRows<3>() *= rotation;
  }
  Append(std::sqrt(kHeadWeight), with_jacobian ? &J : nullptr, e, rows);
}

void PostureTasks::Judge(Posture* posture) const {
  const Placement at = Place(model_, posture->q);
  posture->reached = true;
  for (int hand = 0; hand < kHands; ++hand) {
    const auto k = static_cast<std::size_t>(hand);
    if (elbow_goal_[k]) {
      const auto elbow = static_cast<std::size_t>(Of(hand, ArmJoint::kElbowFlexion));
      posture->elbow_error[k] = (*elbow_goal_[k] - at.p[elbow]).norm();
    }
    if (!grip_goal_[k]) continue;
    const Vector6 error = HandError(at, hand);
    posture->position_error[k] = error.head<3>().norm();
    posture->rotation_error[k] = error.tail<3>().norm();
    if (turns_[k]) {
      posture->oblique[k] = 2 * std::asin(std::min(1.0, posture->rotation_error[k] / 2));
      posture->rotation_error[k] = std::max(0.0, posture->oblique[k] - kMaxOblique);
    }
    // The condition is written as a negated comparison so that it also holds if measurements are
    // not finite.
    if (!(posture->position_error[k] <= 1e-6 && posture->rotation_error[k] <= 1e-6))
      posture->reached = false;
  }
  if (head_goal_)
    posture->head_error =
        (head_goal_->p - at.FrameOf(kNeckTwist) * model_.anthropometry().eyes).norm();
}

}  // namespace predictor::person
