#include "simulation/attachment.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"

namespace predictor {
namespace {

constexpr double kCorrection = 200;  // of the place where the grip holds [1/s]
constexpr int kMaxTurns = 100;       // between force and torque
constexpr double kConverged = 1e-12;
constexpr int kMaxPasses = 8;  // of Newton's method with contacts and friction
constexpr double kSettled = 1e-9;

// Returns the x with |x| ≤ radius that minimises ½ xᵀ A x + bᵀ x, for a positive definite A. For a
// multiplier μ ≥ 0, x satisfies (A + μ) x = −b. Newton's method on 1/|x| finds μ (Moré & Sorensen
// 1983).
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

Attachment::Attachment(const AttachmentSpec& spec, Engine* engine)
    : engine_(*engine),
      p_OA_(spec.on_object.xyz),
      is_fixed_(spec.joint == JointType::kFixed),
      damping_(spec.joint == JointType::kSpherical ? spec.damping : 0),
      first_(spec.on_end_effector.xyz),
      start_(spec.on_end_effector.xyz,
             (spec.on_end_effector.ToPose() * spec.on_object.ToPose().Inverse()).q) {
  const int nv = engine_.dof();
  if (nv > kMaxDof) {
    throw InputError::At("cobot.model", "cobot.model has " + std::to_string(nv - 6) +
                                            " movable joints; an event of the attachment needs " +
                                            "at most " + std::to_string(kMaxCobotJoints) +
                                            ". Remove links with cobot.remove_links.");
  }
  J_.setZero(6, nv);
  other_.setZero(6, nv);
  M_.setZero(nv, nv);
}

// Returns X_EA with the rotation of O instead of that of A.
Pose Attachment::Place() const noexcept {
  const Pose X_EO = PoseOf(SceneBody::kEndEffector).Inverse() * PoseOf(SceneBody::kObject);
  return {X_EO * p_OA_, X_EO.q};
}

void Attachment::Grip() noexcept {
  grip_ = Place();
  first_ = grip_.p;
  limits_ = wanted_;
  lost_ = slides_ = turns_ = released_ = missed_ = false;
  tried_ = HUGE_VAL;
  wrench_.setZero();
  load_.setZero();
}

void Attachment::Command(const GripperCommands& commands) noexcept {
  if (commands.is_open()) {
    released_ = true;
    missed_ = false;
    tried_ = HUGE_VAL;
    return;
  }
  const bool is_new = commands.grasped < tried_;
  tried_ = commands.grasped;
  if (!released_ || !is_new) return;
  missed_ = !IsNear(commands);
  if (missed_) return;
  released_ = lost_ = false;
  grip_ = Place();
  first_ = grip_.p;
  limits_.force = limits_.torque = 0;  // it tightens from here
}

bool Attachment::IsNear(const GripperCommands& commands) const noexcept {
  const Pose now = Place();
  return (now.p - start_.p).norm() <= commands.distance &&
         (!is_fixed_ || RotationError(now.q, start_.q).norm() <= commands.angle);
}

AttachmentState Attachment::state() const noexcept {
  if (missed_) return AttachmentState::kMissed;
  if (is_open()) return AttachmentState::kOpen;
  return slides_ || turns_ ? AttachmentState::kSlips : AttachmentState::kHolds;
}

// Lower limits apply at once. A limit at which the object slid in the last step rises by at most
// its rate times the step.
void Attachment::Tighten() noexcept {
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

bool Attachment::Hold() noexcept {
  Tighten();
  slides_ = turns_ = false;
  Engine::Values applied = engine_.joint_forces();
  applied.segment<6>(engine_.layout().object_v).setZero();
  if (is_open()) {
    wrench_.setZero();
    load_.setZero();
    return true;
  }
  Prepare();
  const DofVector others = applied;
  const auto apply = [&] {
    applied = others;
    applied.noalias() += J_.transpose().lazyProduct(wrench_);
  };
  // The attachment affects contacts and joint friction, which in turn affect the attachment.
  // Newton's method solves both together.
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    apply();
    if (engine_.has_reactions() && !engine_.ComputeAccelerations(false)) return false;
    const Wrench before = wrench_;
    UpdateMobility();
    wrench_ = Solve();
    if (!engine_.has_reactions() || (wrench_ - before).norm() <= kSettled * (1 + wrench_.norm()))
      break;
  }
  apply();
  load_ = ShiftWrench(wrench_, p_WA_ - PoseOf(SceneBody::kEndEffector).p);
  return true;
}

// Computes the Jacobian, its rate and the inertia in the present state.
void Attachment::Prepare() noexcept {
  p_WA_ = PoseOf(SceneBody::kObject) * p_OA_;
  engine_.JacobianRate(SceneBody::kEndEffector, p_WA_, J_);
  engine_.JacobianRate(SceneBody::kObject, p_WA_, other_);
  J_ -= other_;
  bias_ = J_.lazyProduct(engine_.velocities());
  engine_.Jacobian(SceneBody::kEndEffector, p_WA_, J_);
  engine_.Jacobian(SceneBody::kObject, p_WA_, other_);
  J_ -= other_;
  engine_.StepMatrix(M_);
  factor_.compute(M_);
}

// Computes G, which includes the contacts and the friction that are active at present.
void Attachment::UpdateMobility() noexcept {
  holding_ = M_;
  engine_.AddReactions(holding_);
  holding_factor_.compute(holding_);
  for (int i = 0; i < 6; ++i) {
    const DofVector column = holding_factor_.solve(DofVector(J_.row(i).transpose()));
    G_.col(i) = J_.lazyProduct(column);
  }
}

// Returns the wrench on E about A. The function assumes that contacts and friction react to the
// change from the present wrench_ as UpdateMobility determined.
Wrench Attachment::Solve() noexcept {
  const double dt = engine_.step();
  DofVector force(engine_.dof());
  engine_.Forces(force);
  const DofVector v = engine_.velocities() + dt * DofVector(factor_.solve(force));
  const Pose E = PoseOf(SceneBody::kEndEffector);
  Vector6 error;  // of the object from the place where the grip holds
  error << p_WA_ - E * grip_.p, RotationError(PoseOf(SceneBody::kObject).q, E.q * grip_.q);
  if (!is_fixed_) error.tail<3>().setZero();
  // In the step, the relative position changes by dt J v + ½ dt² J̇ v.
  Vector6 b = (J_.lazyProduct(v) + dt / 2 * bias_ - kCorrection * error) / dt - G_ * wrench_;
  if (!is_fixed_ && damping_ > 0) {
    b.tail<3>() -= bias_.tail<3>() / 2;  // a damper acts on the velocity
    G_.bottomRightCorner<3, 3>().diagonal().array() += 1 / (dt * damping_);
  } else if (!is_fixed_) {
    b.tail<3>().setZero();
    G_.topRightCorner<3, 3>().setZero();
    G_.bottomLeftCorner<3, 3>().setZero();
    G_.bottomRightCorner<3, 3>().setIdentity();
  }
  const Wrench wrench = -G_.llt().solve(b);
  const bool holds = wrench.head<3>().norm() <= limits_.force &&
                     (!is_fixed_ || wrench.tail<3>().norm() <= limits_.torque);
  slides_ = turns_ = false;
  return holds ? wrench : WithinLimits(b, wrench);
}

// Minimises ½ λᵀ G λ + bᵀ λ within the limits. It starts from a given λ and changes the force and
// the torque alternately.
Wrench Attachment::WithinLimits(const Vector6& b, Wrench wrench) noexcept {
  const double torque = is_fixed_ ? limits_.torque : HUGE_VAL;
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

void Attachment::Follow() noexcept {
  if (lost_) return;
  const Pose now = Place();
  const bool open = is_open();
  if (slides_ || open) grip_.p = now.p;
  if (turns_ || open) grip_.q = now.q;
  lost_ = (grip_.p - first_).norm() > limits_.reach;
}

}  // namespace predictor
