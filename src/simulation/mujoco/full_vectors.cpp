#include "simulation/mujoco/full_vectors.h"

namespace predictor {

FullVectors::FullVectors(const Scene& scene)
    : own_(scene.own_dof), all_(static_cast<Eigen::Index>(scene.model->nv)), same_(own_ == all_) {
  if (same_) return;
  const Eigen::Index movable = all_ - own_;
  from_.setZero(all_);
  to_.setZero(all_);
  J_.setZero(6, all_);
  M_.setZero(all_, all_);
  coupling_.setZero(movable, own_);
  eliminated_.setZero(movable, own_);
  factor_ = Eigen::LLT<Eigen::MatrixXd>(movable);
}

void FullVectors::Jacobian(JacobianOf function, const mjModel* model, const mjData* data,
                           const Vector3& p_W, int body, Engine::Jacobian6 J) noexcept {
  if (J.cols() == all_)
    return function(model, data, J.data(), J.data() + 3 * J.outerStride(), p_W.data(), body);
  function(model, data, J_.data(), J_.data() + 3 * all_, p_W.data(), body);
  J = J_.leftCols(own_);
}

void FullVectors::MassMatrix(const mjModel* model, const mjData* data, Matrix M) const noexcept {
  // The matrix is symmetric, so the storage order does not matter.
  if (M.cols() == all_) return mj_fullM(model, data, M.data());
  mj_fullM(model, data, M_.data());
  M = M_.topLeftCorner(own_, own_);
}

void FullVectors::TimesMass(const mjModel* model, const mjData* data, const double* a,
                            double* force) const noexcept {
  if (same_) return mj_mulM(model, data, force, a);
  from_.head(own_) = Engine::ConstValues(a, own_);
  from_.tail(all_ - own_).setZero();
  mj_mulM(model, data, to_.data(), from_.data());
  Engine::Values(force, own_) = to_.head(own_);
}

void FullVectors::AddWrench(const mjModel* model, mjData* data, const double* wrench,
                            const double* p_W, int body, Vector forces) noexcept {
  if (forces.size() == all_)
    return mj_applyFT(model, data, wrench, wrench + 3, p_W, body, forces.data());
  to_.setZero();
  mj_applyFT(model, data, wrench, wrench + 3, p_W, body, to_.data());
  forces += to_.head(own_);
}

// Reactions of contacts that hold act like an inertia. Each reaction is a force of −efc_D times the
// acceleration along its row.
void FullVectors::AddReactions(const mjModel* model, const mjData* data, Matrix M) const noexcept {
  const Eigen::Index movable = all_ - own_;
  const bool is_whole = M.cols() == all_;
  if (!is_whole) {
    mj_fullM(model, data, M_.data());
    coupling_.setZero();
  }
  bool coupled = false;
  for (int i = 0; i < data->nefc; ++i) {
    if (data->efc_state[i] != mjCNSTRSTATE_QUADRATIC) continue;
    const Engine::ConstValues row(data->efc_J + i * all_, all_);
    const auto own = row.head(M.cols());
    M += data->efc_D[i] * own.lazyProduct(own.transpose());
    if (is_whole) continue;
    const auto other = row.tail(movable);
    M_.bottomRightCorner(movable, movable) += data->efc_D[i] * other.lazyProduct(other.transpose());
    coupling_ += data->efc_D[i] * other.lazyProduct(own.transpose());
    coupled = coupled || ((own.array() != 0).any() && (other.array() != 0).any());
  }
  if (!coupled) return;
  factor_.compute(M_.bottomRightCorner(movable, movable));
  eliminated_ = coupling_;
  factor_.solveInPlace(eliminated_);
  M -= coupling_.transpose().lazyProduct(eliminated_);
}

void FullVectors::Displace(const mjModel* model, mjData* data, const double* change,
                           double scale) noexcept {
  if (same_) return mj_integratePos(model, data->qpos, change, scale);
  from_.head(own_) = Engine::ConstValues(change, own_);
  from_.tail(all_ - own_).setZero();
  mj_integratePos(model, data->qpos, from_.data(), scale);
}

}  // namespace predictor
