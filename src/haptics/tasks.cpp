#include "haptics/tasks.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

// Vector part of the quaternion that turns `from` into `to`, nearer hemisphere: half the angle for
// small rotations. This is η ε^d − η^d ε − S(ε^d) ε of (9).
Vector3 QuaternionError(const Quaternion& to, const Quaternion& from) {
  const Quaternion d = to * from.conjugate();
  return d.w() < 0 ? Vector3(-d.vec()) : Vector3(d.vec());
}

}  // namespace

Tracking::Tracking(const RenderingSpec& spec, double lead, double dt) : spec_(spec), lead_(lead) {
  acceleration_.fill(LowPass<Vector6>(spec.lead_cutoff, dt, Vector6::Zero()));
}

void Tracking::Reset() noexcept {
  for (auto& a : acceleration_) a.Reset(Vector6::Zero());
}

void Tracking::Advance(const RenderTarget& target) noexcept {
  for (int i = 0; i < kHands; ++i) acceleration_[i].Update(target.handle[i].A_W);
}

void Tracking::AddTo(const RenderState& state, Qp* qp) noexcept {
  const bool aligning = state.target.aligning;
  const double kp = aligning ? kAlignGain : spec_.kp;
  const double ko = aligning ? 2 * kAlignGain : spec_.ko;
  double scale = 1;
  for (int i = 0; i < kHands; ++i) {
    if (!state.arms[i].present) continue;
    const FrameMotion& D = state.target.handle[i];
    Twist& v = reference_[i];
    v = D.V_W;
    if (!aligning) v += lead_ * acceleration_[i].value();
    v.head<3>() += kp * (D.X_W.p - state.X_WH[i].p);
    v.tail<3>() += ko * QuaternionError(D.X_W.q, state.X_WH[i].q);
    // One factor for both handles, so that the cap does not tear them apart.
    scale = std::min({scale, state.target.speed_cap / std::max(1e-12, v.head<3>().norm()),
                      state.target.rotation_cap / std::max(1e-12, v.tail<3>().norm())});
  }
  const double w_rotation = spec_.rotation_length * spec_.rotation_length;
  Vector6 weight;
  weight << 1, 1, 1, w_rotation, w_rotation, w_rotation;
  auto H = qp->H();
  auto f = qp->f();
  for (int i = 0; i < kHands; ++i) {
    if (!state.arms[i].present) continue;
    reference_[i] *= scale;
    const Jacobian& J = state.J[i];
    const int o = state.offset[i];
    for (int c = 0; c < J.cols(); ++c) {
      const Vector6 weighted = weight.cwiseProduct(J.col(c));
      f[o + c] -= weighted.dot(reference_[i]);
      for (int r = 0; r <= c; ++r) {
        const double h = weighted.dot(J.col(r));
        H(o + r, o + c) += h;
        if (r != c) H(o + c, o + r) += h;
      }
    }
  }
}

void RelativePose::Evaluate(const RenderState& state) noexcept {
  const Pose X_D1D2 = state.target.handle[0].X_W.Inverse() * state.target.handle[1].X_W;
  const Pose X_W2_goal =
      state.X_WH[0] * X_D1D2;  // where the real left handle carries the right one
  const Vector3 lever = state.X_WH_ahead[0].q * X_D1D2.p;

  // d/dt of (goal − right): left's rigid motion at the goal, less right's.
  const int n0 = static_cast<int>(state.J[0].cols());
  const int n1 = static_cast<int>(state.J[1].cols());
  A_.resize(6, n0 + n1);
  for (int c = 0; c < n0; ++c) {
    A_.col(c).head<3>() = state.J[0].col(c).head<3>() + state.J[0].col(c).tail<3>().cross(lever);
    A_.col(c).tail<3>() = state.J[0].col(c).tail<3>();
  }
  for (int c = 0; c < n1; ++c) A_.col(n0 + c) = -state.J[1].col(c);
  rate_.head<3>() = -spec_.relative_kp * (X_W2_goal.p - state.X_WH[1].p);
  rate_.tail<3>() = -spec_.relative_ko * QuaternionError(X_W2_goal.q, state.X_WH[1].q);
  // Handles far from where they belong to one another come together no faster than a handle may go.
  rate_ *= std::min({1.0, state.target.speed_cap / std::max(1e-12, rate_.head<3>().norm()),
                     state.target.rotation_cap / std::max(1e-12, rate_.tail<3>().norm())});

  const double w_rotation = spec_.rotation_length * spec_.rotation_length;
  weight_ << 1, 1, 1, w_rotation, w_rotation, w_rotation;
  weight_ *= kRelativeWeight;
}

// While aligning nobody holds the handles, and each goes its own way: far from where they belong to
// one another, both ways could not be had at once.
bool RelativePose::Counts(const RenderState& state) noexcept {
  return state.arms[0].present && state.arms[1].present && !state.target.aligning;
}

void RelativePose::AddRowsTo(const RenderState& state, int row, int variable, Qp* qp) noexcept {
  if (!state.arms[0].present || !state.arms[1].present) return;
  if (!Counts(state)) {
    for (int k = 0; k < 6; ++k)
      qp->A()(row + k, variable + k) = qp->H()(variable + k, variable + k) = 1;
    for (int k = 0; k < 6; ++k) qp->b()[row + k] = qp->b_upper()[row + k] = 0;
    return;
  }
  Evaluate(state);
  for (int k = 0; k < 6; ++k) {
    for (int c = 0; c < A_.cols(); ++c) qp->A()(row + k, c) = A_(k, c);
    qp->A()(row + k, variable + k) = 1 / std::sqrt(weight_[k]);
    qp->H()(variable + k, variable + k) = 1;
    qp->b()[row + k] = qp->b_upper()[row + k] = rate_[k];
  }
}

void RelativePose::AddTo(const RenderState& state, Qp* qp) noexcept {
  if (!Counts(state)) return;
  Evaluate(state);
  auto H = qp->H();
  auto f = qp->f();
  for (int c = 0; c < A_.cols(); ++c) {
    const Vector6 weighted = weight_.cwiseProduct(A_.col(c));
    f[c] -= weighted.dot(rate_);
    for (int r = 0; r <= c; ++r) {
      const double h = weighted.dot(A_.col(r));
      H(r, c) += h;
      if (r != c) H(c, r) += h;
    }
  }
}

Vector6 RelativePose::Slack(const RenderState& state, const double* x) const noexcept {
  if (!Counts(state)) return Vector6::Zero();
  Vector6 slack = -rate_;
  for (int c = 0; c < A_.cols(); ++c) slack += A_.col(c) * x[c];
  return slack;
}

void Manipulability::AddTo(const RenderState& state, Qp* qp) noexcept {
  for (int i = 0; i < kHands; ++i) {
    const RenderArm& arm = state.arms[i];
    if (!arm.present) continue;
    if (weight_ == 0) {  // the value alone is cheap, and of interest to the record
      const auto J = state.J[i].topRows<3>();
      Matrix3 JJt = Matrix3::Zero();
      for (int c = 0; c < J.cols(); ++c) JJt += J.col(c) * J.col(c).transpose();
      value_[i] = std::sqrt(std::max(0.0, JJt.determinant()));
      continue;
    }
    JointVector gradient;
    arm.data->ManipulabilityGradient(*arm.model, arm.handle, &value_[i], &gradient);
    for (int c = 0; c < gradient.size(); ++c) qp->f()[state.offset[i] + c] -= weight_ * gradient[c];
  }
}

void Regularisation::AddTo(const RenderState& state, Qp* qp) noexcept {
  auto H = qp->H();
  Vector6 scale;
  scale << 1, 1, 1, spec_.rotation_length, spec_.rotation_length, spec_.rotation_length;
  for (int i = 0; i < kHands; ++i) {
    if (!state.arms[i].present) continue;
    const Jacobian& J = state.J[i];
    Matrix6 JJt = 1e-12 * Matrix6::Identity();
    for (int c = 0; c < J.cols(); ++c) {
      const Vector6 column = scale.cwiseProduct(J.col(c));
      JJt.noalias() += column * column.transpose();
    }
    // 1/tr((J Jᵀ)⁻¹) lies between σ_min²/6 and σ_min²: cheap, and smooth in q.
    const Matrix6 inverse = JJt.llt().solve(Matrix6::Identity());
    const double sigma = 1 / std::sqrt(inverse.trace());
    const double near = std::max(0.0, 1 - sigma / kSingularValue);
    const double epsilon = kRegularisation + kDamping * near * near;
    for (int c = 0; c < J.cols(); ++c) H(state.offset[i] + c, state.offset[i] + c) += epsilon;
  }
}

}  // namespace predictor
