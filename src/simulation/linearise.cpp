#include "simulation/linearise.h"

#include <algorithm>

namespace predictor {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPositionStep = 1e-6;  // [rad, m]
// [rad/s, m/s]; exact, because the forces are quadratic in it.
constexpr double kVelocityStep = 1e-4;
constexpr double kWrenchStep = 1e-2;  // [N, N·m]

class Linearisation {
 public:
  Linearisation(ControlledScene* scene, mjData* data, double t)
      : scene_(*scene),
        data_(data),
        time_(t),
        n_(static_cast<int>(scene->model()->nv)),
        qpos_(Eigen::Map<VectorXd>(data->qpos, scene->model()->nq)),
        disable_flags_(scene->model()->opt.disableflags) {
    scene_.model()->opt.disableflags |= mjDSBL_FRICTIONLOSS;
  }
  ~Linearisation() { scene_.model()->opt.disableflags = disable_flags_; }

  LinearModel Compute(const Hands& hands, const std::array<Pose, kHands>& X_OD) {
    MatrixXd J = MatrixXd::Zero(6 * kHands, n_);
    for (const int h : hands) J.middleRows(6 * h, 6) = HandleJacobian(X_OD[h]);
    LinearModel model;
    model.A.setZero(2 * n_, 2 * n_);
    model.A.topRightCorner(n_, n_).setIdentity();
    const VectorXd zero = VectorXd::Zero(n_);
    for (int i = 0; i < n_; ++i) {
      const VectorXd e = VectorXd::Unit(n_, i);
      model.A.block(n_, i, n_, 1) = Slope(kPositionStep, e, zero, zero);
      model.A.block(n_, n_ + i, n_, 1) = Slope(kVelocityStep, zero, e, zero);
    }
    model.B.setZero(2 * n_, J.rows());
    for (Eigen::Index i = 0; i < J.rows(); ++i) {
      model.B.block(n_, i, n_, 1) = Slope(kWrenchStep, zero, zero, J.row(i).transpose());
    }
    model.C.setZero(J.rows(), 2 * n_);
    model.C.rightCols(n_) = J;
    return model;
  }

 private:
  // Central difference of the accelerations along a direction of positions, velocities and forces.
  VectorXd Slope(double step, const VectorXd& dq, const VectorXd& v, const VectorXd& force) {
    const VectorXd ahead = Acceleration(step * dq, step * v, step * force);
    return (ahead - Acceleration(-step * dq, -step * v, -step * force)) / (2 * step);
  }

  VectorXd Acceleration(const VectorXd& dq, const VectorXd& v, const VectorXd& force) {
    Eigen::Map<VectorXd>(data_->qpos, qpos_.size()) = qpos_;
    mj_integratePos(scene_.model(), data_->qpos, dq.data(), 1);
    Eigen::Map<VectorXd>(data_->qvel, n_) = v;
    std::fill_n(data_->qacc_warmstart, n_, 0.0);
    std::fill_n(data_->qfrc_applied, n_, 0.0);
    std::fill_n(data_->xfrc_applied, 6 * scene_.model()->nbody, 0.0);
    scene_.Update(data_);
    scene_.ApplyController(time_, data_);
    Eigen::Map<VectorXd>(data_->qfrc_applied, n_) += force;
    mj_forwardSkip(scene_.model(), data_, mjSTAGE_VEL, 1);
    return Eigen::Map<VectorXd>(data_->qacc, n_);
  }

  // V_WD = J v.
  MatrixXd HandleJacobian(const Pose& X_OD) {
    const VectorXd zero = VectorXd::Zero(n_);
    Acceleration(zero, zero, zero);
    const Pose X_WD = scene_.Object(*data_).X_W * X_OD;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    RowMajor linear(3, n_), angular(3, n_);
    mj_jac(scene_.model(), data_, linear.data(), angular.data(), X_WD.p.data(),
           scene_.scene().object);
    MatrixXd J(6, n_);
    J << linear, angular;
    return J;
  }

  ControlledScene& scene_;
  mjData* data_;
  double time_;
  int n_;
  VectorXd qpos_;  // the posture about which the scene is linearised
  int disable_flags_;
};

}  // namespace

LinearModel Linearise(ControlledScene* scene, mjData* data, double t, const Hands& hands,
                      const std::array<Pose, kHands>& X_OD) {
  return Linearisation(scene, data, t).Compute(hands, X_OD);
}

}  // namespace predictor
