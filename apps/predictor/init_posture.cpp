#include "init_posture.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <random>

#include "core/types.h"

namespace predictor {
namespace {

constexpr double kMaxLoad = 0.6;  // maximum load of a joint at rest, relative to its limit
constexpr std::size_t kMaxPostures = 40;
constexpr int kStarts = 600, kIterations = 60;
constexpr double kUsedRange = 0.9;           // share of the joints' ranges, about their middle
constexpr double kLargestAngle = 2.8;        // of a joint from its middle [rad] or [m]
constexpr double kPositionTolerance = 1e-3;  // [m]
constexpr double kAngleTolerance = 5e-3;     // [rad]
constexpr double kDamping = 0.05;            // of the least squares
constexpr double kArm = 0.3;                 // length that compares angles with distances [m]
constexpr double kMaxStep = 0.3;             // of a joint in an iteration [rad] or [m]
constexpr double kLinkHeight = 0.05;         // least height of the joints beyond the second one [m]

// Permitted positions of the end-effector in W [m].
struct Zone {
  Vector3 low, high;

  explicit Zone(double lowest)
      : low(0.25, -0.1, lowest), high(0.8, 0.1, std::max(0.9, lowest + 0.3)) {}
  Vector3 Nearest(const Vector3& p) const { return p.cwiseMax(low).cwiseMin(high); }
};

// Returns the direction that leans from straight down by `tilt`, away from the base's axis.
Vector3 Target(double tilt, const Vector3& p) {
  Vector3 away(p.x(), p.y(), 0);
  away = away.norm() > 1e-3 ? Vector3(away.normalized()) : Vector3::UnitX();
  return std::sin(tilt) * away - std::cos(tilt) * Vector3::UnitZ();
}

// Returns the rotation vector that rotates the unit vector u onto t [rad].
Vector3 Turn(const Vector3& u, const Vector3& t) {
  const Vector3 axis = u.cross(t);
  const double sine = axis.norm(), angle = std::atan2(sine, u.dot(t));
  return sine > 1e-6 ? Vector3(angle / sine * axis) : Vector3(angle * u.unitOrthogonal());
}

// Moves a posture towards the demanded pose, within the joints' ranges.
class Search {
 public:
  Search(const RobotModel& model, const FrameId& end_effector, const PostureDemand& demand)
      : model_(model),
        end_effector_(end_effector),
        demand_(demand),
        zone_(demand.lowest),
        data_(model),
        rest_(JointVector::Zero(model.dof())),
        low_(rest_),
        high_(rest_),
        J_(6, model.dof()) {
    for (int j = 0; j < model.dof(); ++j) {
      const double low = model.position_lower()[j], high = model.position_upper()[j];
      const bool is_limited = std::isfinite(low) && std::isfinite(high);
      const double middle = is_limited ? (low + high) / 2 : 0;
      const double half = is_limited ? std::min((high - low) / 2, kLargestAngle) : kLargestAngle;
      low_[j] = middle - kUsedRange * half;
      high_[j] = middle + kUsedRange * half;
    }
    for (const std::string& link : model.link_names())
      if (const FrameId frame = model.Frame(link); frame.body > 2) links_.push_back(frame);
  }

  // Returns whether a posture was found from a random start.
  bool Try(std::mt19937* random, InitPosture* found) {
    std::uniform_real_distribution<double> share(0, 1);
    found->q = rest_;
    for (int j = 0; j < model_.dof(); ++j)
      found->q[j] = low_[j] + share(*random) * (high_[j] - low_[j]);
    for (int i = 0; i < kIterations; ++i)
      if (Improve(&found->q)) return Judge(found);
    return false;
  }

 private:
  // Makes one step of damped least squares. At the demanded pose, makes no step and returns true.
  bool Improve(JointVector* q) {
    data_.UpdateKinematics(model_, *q, rest_);
    data_.FrameJacobian(model_, end_effector_, &J_);
    const Pose X_WE = data_.FramePose(model_, end_effector_);
    const Vector3 u = X_WE.q * demand_.outward;
    Vector6 error;
    error << zone_.Nearest(X_WE.p) - X_WE.p, kArm * Turn(u, Target(demand_.tilt, X_WE.p));
    if (error.head<3>().norm() < kPositionTolerance &&
        error.tail<3>().norm() < kArm * kAngleTolerance)
      return true;
    Eigen::MatrixXd J = J_;
    for (int i = 0; i < 3; ++i)
      if (error[i] == 0) J.row(i).setZero();  // free to move within the zone
    // A rotation about the last link does not matter.
    J.bottomRows<3>() = kArm * (Matrix3::Identity() - u * u.transpose()) * J.bottomRows<3>();
    const Eigen::Matrix<double, 6, 6> A =
        J * J.transpose() + kDamping * kDamping * Eigen::Matrix<double, 6, 6>::Identity();
    JointVector step = rest_;
    step += J.transpose() * A.llt().solve(error);
    *q = (*q + step * std::min(1.0, kMaxStep / step.lpNorm<Eigen::Infinity>()))
             .cwiseMax(low_)
             .cwiseMin(high_);
    return false;
  }

  // Completes a posture at the demanded pose. Returns whether the cobot can carry the object in
  // this posture.
  bool Judge(InitPosture* posture) {
    data_.UpdateDynamics(model_, posture->q, rest_, kStandardGravity);
    data_.FrameJacobian(model_, end_effector_, &J_);
    for (int j = 0; j < model_.dof(); ++j) {
      const double torque = data_.gravity()[j] + demand_.mass * kStandardGravity * J_(2, j);
      if (std::abs(torque) > kMaxLoad * model_.effort_limit()[j]) return false;
    }
    for (const FrameId& link : links_)
      if (data_.FramePose(model_, link).p.z() < kLinkHeight) return false;
    posture->X_WE = data_.FramePose(model_, end_effector_);
    posture->suitability =
        Eigen::JacobiSVD<Eigen::MatrixXd>(Eigen::MatrixXd(J_)).singularValues().minCoeff();
    return posture->suitability > 0;
  }

  const RobotModel& model_;
  const FrameId end_effector_;
  const PostureDemand& demand_;
  const Zone zone_;
  RobotData data_;
  const JointVector rest_;
  JointVector low_, high_;      // [rad] or [m]
  std::vector<FrameId> links_;  // that must stay above the floor
  Jacobian J_;
};

}  // namespace

std::vector<InitPosture> FindPostures(const RobotModel& model, const FrameId& end_effector,
                                      const PostureDemand& demand) {
  std::mt19937 random(1);
  Search search(model, end_effector, demand);
  std::vector<InitPosture> best;
  InitPosture trial;
  for (int k = 0; k < kStarts; ++k) {
    if (!search.Try(&random, &trial)) continue;
    best.insert(std::ranges::upper_bound(best, trial.suitability, std::greater(),
                                         &InitPosture::suitability),
                trial);
    if (best.size() > kMaxPostures) best.pop_back();
  }
  return best;
}

}  // namespace predictor
