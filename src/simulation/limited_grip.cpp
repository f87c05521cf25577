#include "simulation/limited_grip.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

constexpr double kCorrection = 200;  // of the place where the grip holds [1/s]
constexpr int kMaxTurns = 100;       // between force and torque
constexpr double kConverged = 1e-12;
constexpr int kMaxPasses = 8;  // of Newton's method with contacts and friction
constexpr double kSettled = 1e-9;

// Returns the x with |x| ≤ radius that minimises ½ xᵀ A x + bᵀ x, for a positive definite A. With a
// multiplier μ ≥ 0, (A + μ) x = −b. Newton's method on 1/|x| finds μ (Moré & Sorensen 1983).
Vector3 MinimumInBall(const Matrix3& A, const Vector3& b, double radius, bool* at_limit) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(A);
  const Vector3 a = eigen.eigenvalues(), c = eigen.eigenvectors().transpose() * b;
  const auto solution = [&](double mu) -> Vector3 { return -c.array() / (a.array() + mu); };
  Vector3 x = solution(0);
  *at_limit = x.norm() > radius;
  if (*at_limit && radius <= 0) return Vector3::Zero();
  double mu = 0;
  for (int i = 0; *at_limit && i < kMaxTurns; ++i) {
    const double size = x.norm();
    if (std::fabs(size - radius) <= kConverged * radius) break;
    const double slope = -(x.array().square() / (a.array() + mu)).sum() / size;
    mu += size * (1 - size / radius) / slope;
    x = solution(mu);
  }
  return eigen.eigenvectors() * x;
}

}  // namespace

LimitedGrip::LimitedGrip(SceneBody holder, GripJoint joint, Engine* engine, Eigen::Index velocities)
    : engine_(*engine), holder_(holder), joint_(joint) {
  J_.setZero(6, velocities);
  other_.setZero(6, velocities);
  M_.setZero(velocities, velocities);
}

void LimitedGrip::Close(SceneBody held, const Vector3& p_HA, bool tight) noexcept {
  held_ = held;
  p_HA_ = p_HA;
  place_ = Place();
  first_ = place_.p;
  limits_ = wanted_;
  if (!tight) limits_.force = limits_.torque = 0;
  is_lost_ = slides_ = turns_ = is_released_ = false;
  wrench_.setZero();
  load_.setZero();
}

Pose LimitedGrip::Place() const noexcept {
  const Pose X_BH = engine_.PoseOf(holder_).Inverse() * engine_.PoseOf(held_);
  return {X_BH * p_HA_, X_BH.q};
}

// Lower limits apply at once. What slid in the last step is held at most a step's share tighter.
void LimitedGrip::Tighten() noexcept {
  const double dt = engine_.step();
  const bool open = is_open();
  const auto next = [dt](bool loose, double now, double rate, double wanted) {
    return loose ? std::min(wanted, now + rate * dt) : wanted;
  };
  const bool slides = slides_ || open, turns = turns_ || open;
  limits_ = {next(slides, limits_.force, kForceRate, wanted_.force),
             next(turns, limits_.torque, kTorqueRate, wanted_.torque),
             next(slides, limits_.reach, 0, wanted_.reach)};
}

bool LimitedGrip::Hold(const Wrench& object_wrench) noexcept {
  Tighten();
  slides_ = turns_ = false;
  object_wrench_ = object_wrench;
  if (held_ == SceneBody::kObject) {
    Engine::Values applied = engine_.joint_forces();
    applied.segment<6>(engine_.layout().object_v).setZero();
    others_ = applied;
  } else {
    engine_.movable_forces().setZero();
  }
  if (is_open()) {
    wrench_.setZero();
    load_.setZero();
    return true;
  }
  Prepare();
  // The grip affects contacts and joint friction, and these affect the grip. Newton's method solves
  // both together.
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    Apply();
    if (engine_.has_reactions() && !engine_.ComputeAccelerations(false)) return false;
    const Wrench before = wrench_;
    UpdateMobility();
    wrench_ = Solve();
    if (!engine_.has_reactions() || (wrench_ - before).norm() <= kSettled * (1 + wrench_.norm()))
      break;
  }
  Apply();
  load_ = ShiftWrench(wrench_, p_WA_ - engine_.PoseOf(holder_).p);
  return true;
}

// The wrench on an object that holds something is an external one, because the wrist sensor does
// not measure forces of joints.
void LimitedGrip::Apply() noexcept {
  if (held_ == SceneBody::kObject) {
    Engine::Values applied = engine_.joint_forces();
    applied = others_;
    applied.noalias() += J_.transpose().lazyProduct(wrench_);
    return;
  }
  engine_.SetObjectWrench(object_wrench_ + ShiftWrench(wrench_, p_WA_ - engine_.object_com()));
  Engine::Values applied = engine_.movable_forces();
  applied.noalias() = J_.rightCols(applied.size()).transpose().lazyProduct(wrench_);
}

// Computes the Jacobian, its rate and the inertia in the present state.
void LimitedGrip::Prepare() noexcept {
  p_WA_ = engine_.PoseOf(held_) * p_HA_;
  engine_.JacobianRate(holder_, p_WA_, J_);
  engine_.JacobianRate(held_, p_WA_, other_);
  J_ -= other_;
  bias_ = J_.lazyProduct(velocities());
  engine_.Jacobian(holder_, p_WA_, J_);
  engine_.Jacobian(held_, p_WA_, other_);
  J_ -= other_;
  engine_.StepMatrix(M_);
  factor_.compute(M_);
}

// Computes G, including the contacts and the friction that are active at present.
void LimitedGrip::UpdateMobility() noexcept {
  holding_ = M_;
  engine_.AddReactions(holding_);
  holding_factor_.compute(holding_);
  for (int i = 0; i < 6; ++i) {
    const DofVector column = holding_factor_.solve(DofVector(J_.row(i).transpose()));
    G_.col(i) = J_.lazyProduct(column);
  }
}

// Returns the wrench on B about A. It assumes that contacts and friction react to the change from
// the present wrench_ as UpdateMobility determined.
Wrench LimitedGrip::Solve() noexcept {
  const double dt = engine_.step();
  DofVector force(M_.rows());
  engine_.Forces(force);
  const DofVector v = velocities() + dt * DofVector(factor_.solve(force));
  const Pose B = engine_.PoseOf(holder_);
  Vector6 error;  // of H from the place where the grip holds
  error << p_WA_ - B * place_.p, RotationError(engine_.PoseOf(held_).q, B.q * place_.q);
  if (!joint_.is_fixed) error.tail<3>().setZero();
  // In the step, the relative position changes by dt J v + ½ dt² J̇ v.
  Vector6 b = (J_.lazyProduct(v) + dt / 2 * bias_ - kCorrection * error) / dt - G_ * wrench_;
  if (!joint_.is_fixed && joint_.damping > 0) {
    b.tail<3>() -= bias_.tail<3>() / 2;  // a damper acts on the velocity
    G_.bottomRightCorner<3, 3>().diagonal().array() += 1 / (dt * joint_.damping);
  } else if (!joint_.is_fixed) {
    b.tail<3>().setZero();
    G_.topRightCorner<3, 3>().setZero();
    G_.bottomLeftCorner<3, 3>().setZero();
    G_.bottomRightCorner<3, 3>().setIdentity();
  }
  const Wrench wrench = -G_.llt().solve(b);
  const bool holds = wrench.head<3>().norm() <= limits_.force &&
                     (!joint_.is_fixed || wrench.tail<3>().norm() <= limits_.torque);
  slides_ = turns_ = false;
  return holds ? wrench : WithinLimits(b, wrench);
}

// Minimises ½ λᵀ G λ + bᵀ λ within the limits, starting from a given λ, alternately over force and
// torque.
Wrench LimitedGrip::WithinLimits(const Vector6& b, Wrench wrench) noexcept {
  const double torque = joint_.is_fixed ? limits_.torque : HUGE_VAL;
  for (int i = 0; i < kMaxTurns; ++i) {
    const Wrench before = wrench;
    wrench.head<3>() = MinimumInBall(G_.topLeftCorner<3, 3>(),
                                     b.head<3>() + G_.topRightCorner<3, 3>() * wrench.tail<3>(),
                                     limits_.force, &slides_);
    wrench.tail<3>() = MinimumInBall(G_.bottomRightCorner<3, 3>(),
                                     b.tail<3>() + G_.bottomLeftCorner<3, 3>() * wrench.head<3>(),
                                     torque, &turns_);
    if ((wrench - before).norm() <= kConverged * (1 + wrench.norm())) break;
  }
  return wrench;
}

void LimitedGrip::Follow() noexcept {
  if (is_lost_) return;
  const Pose now = Place();
  const bool open = is_open();
  if (slides_ || open) place_.p = now.p;
  if (turns_ || open) place_.q = now.q;
  is_lost_ = (place_.p - first_).norm() > limits_.reach;
}

}  // namespace predictor
