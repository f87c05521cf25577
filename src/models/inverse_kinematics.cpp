// Solves inverse kinematics by damped least squares with limits and seeded restarts.
#include <Eigen/Cholesky>
#include <algorithm>

#include "core/random.h"
#include "models/robot.h"

namespace predictor {
namespace {

constexpr double kTolerance = 1e-6;    // [m] and [rad]
constexpr int kIterations = 200;       // iterations per start
constexpr double kLength = 0.2;        // weighs rotation against translation [m/rad]
constexpr double kLargestStep = 0.5;   // largest step of a joint in one iteration [rad] or [m]
constexpr double kMinDamping = 1e-12;  // [m²]
constexpr double kPi = 3.14159265358979323846;

class Solver {
 public:
  Solver(const RobotModel& model, const FrameId& frame, const Pose& X_WF)
      : model_(model), frame_(frame), goal_(X_WF), data_(model) {
    still_.setZero(model.dof());
  }

  // Returns the weighted error [m] at q. Sets error_ and updates the kinematics.
  double Error(const JointVector& q) {
    data_.UpdateKinematics(model_, q, still_);
    error_ = PoseError(goal_, data_.FramePose(model_, frame_));
    Vector6 weighted = error_;
    weighted.tail<3>() *= kLength;
    return weighted.norm();
  }

  bool Solved() const {
    return error_.head<3>().norm() < kTolerance && error_.tail<3>().norm() < kTolerance;
  }

  // Runs Levenberg-Marquardt from q. The damping falls after a good step and grows after a bad one.
  bool Descend(JointVector* q, double* best) {
    double damping = 1e-3;
    *best = Error(*q);
    for (int i = 0; i < kIterations && !Solved(); ++i) {
      const JointVector trial = *q + Step(*q, damping);
      const Vector6 error_before = error_;
      const double error = Error(trial);
      if (error < *best) {
        *q = trial;
        *best = error;
        damping = std::max(kMinDamping, damping * 0.1);
      } else {
        damping = damping * 10 + kMinDamping;
        if (damping > 1e6) return false;  // a local minimum
        error_ = error_before;
      }
    }
    Error(*q);
    return Solved();
  }

  JointVector Random(RandomStream* random) const {
    JointVector q(model_.dof());
    for (int j = 0; j < q.size(); ++j) {
      const double lower = std::max(model_.position_lower()(j), -kPi);
      const double upper = std::min(model_.position_upper()(j), kPi);
      q(j) = lower + (upper - lower) * random->Uniform();
    }
    return Clamp(q);
  }

  JointVector Clamp(const JointVector& q) const {
    return q.cwiseMax(model_.position_lower()).cwiseMin(model_.position_upper());
  }

 private:
  // Takes a damped least-squares step within the limits. A joint that would exceed a limit is set
  // to this limit, and the system is solved again for the other joints.
  JointVector Step(const JointVector& q, double damping) {
    data_.UpdateKinematics(model_, q, still_);
    Jacobian J;
    data_.FrameJacobian(model_, frame_, &J);
    J.bottomRows<3>() *= kLength;
    Vector6 e = error_;
    e.tail<3>() *= kLength;
    JointVector step = JointVector::Zero(q.size());
    for (int pass = 0; pass < q.size(); ++pass) {
      Matrix6 A = Matrix6::Identity() * damping;
      A.noalias() += J * J.transpose();
      const JointVector free = J.transpose() * A.ldlt().solve(e);
      bool is_inside = true;
      for (int j = 0; j < q.size(); ++j) {
        if (J.col(j).isZero(0)) continue;
        step(j) = std::clamp(free(j), -kLargestStep, kLargestStep);
        const double to_lower = model_.position_lower()(j) - q(j);
        const double to_upper = model_.position_upper()(j) - q(j);
        if (step(j) >= to_lower && step(j) <= to_upper) continue;
        step(j) = std::clamp(step(j), to_lower, to_upper);
        e -= J.col(j) * step(j);
        J.col(j).setZero();
        is_inside = false;
      }
      if (is_inside) break;
    }
    return step;
  }

  const RobotModel& model_;
  const FrameId& frame_;
  const Pose& goal_;
  RobotData data_;
  JointVector still_;
  Vector6 error_ = Vector6::Zero();
};

}  // namespace

bool SolveInverseKinematics(const RobotModel& model, const FrameId& frame, const Pose& X_WF,
                            const JointVector& start, int restarts, JointVector* q) {
  Solver solver(model, frame, X_WF);
  RandomStream random(1, "inverse kinematics");
  double best = 0;
  *q = solver.Clamp(start);
  if (solver.Descend(q, &best)) return true;
  for (int i = 0; i < restarts; ++i) {
    JointVector trial = solver.Random(&random);
    double error = 0;
    const bool solved = solver.Descend(&trial, &error);
    if (solved || error < best) {
      *q = trial;
      best = error;
    }
    if (solved) return true;
  }
  return false;
}

}  // namespace predictor
