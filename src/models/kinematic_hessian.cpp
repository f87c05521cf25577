// Computes the kinematic Hessian, and from it the gradient of manipulability (Haviland & Corke
// 2021).
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "models/robot.h"

namespace predictor {

void KinematicHessian(const Jacobian& J, std::vector<Jacobian>* H) {
  const int n = static_cast<int>(J.cols());
  H->assign(static_cast<std::size_t>(n), Jacobian::Zero(6, n));
  for (int i = 0; i < n; ++i) {
    Jacobian& Hi = (*H)[static_cast<std::size_t>(i)];
    const Vector3 v_i = J.col(i).head<3>();
    const Vector3 w_i = J.col(i).tail<3>();
    for (int j = 0; j < n; ++j) {
      const Vector3 v_j = J.col(j).head<3>();
      const Vector3 w_j = J.col(j).tail<3>();
      if (i <= j) {  // joint i rotates joint j's axis and lever arm
        Hi.col(j).head<3>() = w_i.cross(v_j);
        Hi.col(j).tail<3>() = w_i.cross(w_j);
      } else {  // joint i moves the frame relative to joint j's axis
        Hi.col(j).head<3>() = w_j.cross(v_i);
      }
    }
  }
}

void RobotData::ManipulabilityGradient(const RobotModel& model, const FrameId& frame, double* m,
                                       JointVector* gradient) const {
  Jacobian J;
  FrameJacobian(model, frame, &J);
  const int n = static_cast<int>(J.cols());
  gradient->setZero(n);
  Matrix3 A = Matrix3::Zero();  // J_v J_vᵀ
  for (int k = 0; k < n; ++k) A += J.col(k).head<3>() * J.col(k).head<3>().transpose();
  *m = std::sqrt(std::max(0.0, A.determinant()));
  if (*m < 1e-9) return;
  // dm/dq_i = m Σ_j b_j · H_i,j, where b_j are the columns of A^-1 J_v. By the triple product, the
  // sum over j ≥ i is w_i · Σ v_j × b_j, and the sum over j < i is v_i · Σ b_j × w_j. Two sweeps
  // compute these sums.
  const Matrix3 A_inverse = A.inverse();
  Vector3 before = Vector3::Zero();
  for (int i = 0; i < n; ++i) {
    (*gradient)(i) = *m * before.dot(J.col(i).head<3>());
    before += (A_inverse * J.col(i).head<3>()).cross(J.col(i).tail<3>());
  }
  Vector3 after = Vector3::Zero();
  for (int i = n - 1; i >= 0; --i) {
    after += J.col(i).head<3>().cross(A_inverse * J.col(i).head<3>());
    (*gradient)(i) += *m * after.dot(J.col(i).tail<3>());
  }
}

}  // namespace predictor
