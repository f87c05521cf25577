#include "assessment/safety/cobot_margins.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

#include "assessment/hand_samples.h"
#include "models/robot.h"

namespace predictor::assessment {
namespace {

JointVector FirstOf(const std::array<double, kMaxCobotJoints>& values, int count) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), count);
}

// Returns the smallest singular value that is not zero for every posture, because J has as many
// singular values as rows or, if there are fewer, as moving joints.
double SmallestSingularValueOf(Jacobian J, int moving, double length) {
  J.bottomRows<3>() *= length;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd{Eigen::MatrixXd(J)};
  return svd.singularValues()[std::min(moving, 6) - 1];
}

double ManipulabilityOf(const Jacobian& J) {
  const Matrix3 A = J.topRows<3>() * J.topRows<3>().transpose();
  return std::sqrt(std::max(0.0, A.determinant()));
}

}  // namespace

CobotMargins::CobotMargins(const Scenario& scenario, std::shared_ptr<const RobotModel> cobot)
    : cobot_(std::move(cobot)),
      data_(cobot_ ? std::make_shared<RobotData>(*cobot_) : nullptr),
      end_effector_(scenario.cobot.end_effector),
      length_(scenario.rendering.characteristic_length),
      stride_(TicksPerSample(scenario.rate)) {
  smallest_.fill({HUGE_VAL, 0, -1});
}

void CobotMargins::Add(const TickRecord& record) {
  if (!record.ran) return;
  Lower(kLinkPair, record.link_distance, record.run_time);
  if (cobot_ && record.cobot_dof == cobot_->dof() && count_++ % stride_ == 0) Judge(record);
}

void CobotMargins::Lower(Kind kind, double value, double time, int joint) {
  if (value < smallest_[kind].value) smallest_[kind] = {value, time, joint};
}

void CobotMargins::Judge(const TickRecord& record) {
  const int dof = cobot_->dof();
  const JointVector q = FirstOf(record.cobot_q, dof);
  data_->UpdateKinematics(*cobot_, q, JointVector::Zero(dof));
  Jacobian J(6, dof);
  data_->FrameJacobian(*cobot_, cobot_->Frame(end_effector_), &J);
  int moving = 0;
  for (int j = 0; j < dof; ++j) {
    if (J.col(j).isZero()) continue;  // a joint of the gripper
    ++moving;
    Lower(cobot_->is_prismatic(j) ? kSliding : kRotating,
          std::min(q[j] - cobot_->position_lower()[j], cobot_->position_upper()[j] - q[j]),
          record.run_time, j);
  }
  if (moving == 0) return;
  Lower(kSingularValue, SmallestSingularValueOf(J, moving, length_), record.run_time);
  Lower(kManipulability, ManipulabilityOf(J), record.run_time);
}

std::vector<Margin> CobotMargins::results() const {
  constexpr Unit kAngle = {"rad", "°", kDegrees, 1};
  constexpr Unit kLength = {"m", "mm", 1e3, 0};
  constexpr Unit kFine = {"m", "m", 1, 3};
  constexpr Unit kVolume = {"m^3", "m³", 1, 3};
  constexpr Unit kMixed = {"", "", 1, 3};  // a sliding joint has another unit
  struct Row {
    const char* what;
    Unit unit;
  };
  bool slides = false;
  for (int j = 0; cobot_ && j < cobot_->dof(); ++j) slides = slides || cobot_->is_prismatic(j);
  const Row kRows[kKinds] = {{"distance of a rotating joint from its limit", kAngle},
                             {"distance of a sliding joint from its limit", kLength},
                             {"smallest singular value of the Jacobian", kFine},
                             {"translational manipulability", slides ? kMixed : kVolume},
                             {"distance of the nearest link pair of the arms", kLength}};
  std::vector<Margin> margins;
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    const Smallest& s = smallest_[kind];
    if (!std::isfinite(s.value)) continue;
    margins.push_back({kRows[kind].what, kRows[kind].unit, s.value, s.time,
                       s.joint < 0 ? "" : cobot_->joint_name(s.joint)});
  }
  return margins;
}

}  // namespace predictor::assessment
