// MuJoCo's vectors and matrices of all coordinates. The interface of an engine shows only the first
// coordinates, which are those of the cobot and its object.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "simulation/engine.h"
#include "simulation/mujoco/scene.h"

namespace predictor {

// Calls the engine's functions. If the caller's vector or matrix has room for all coordinates, the
// functions write to the caller's memory. This is always so without movable objects. Otherwise, the
// functions write only the first coordinates. This class does not use the heap after its
// construction.
class FullVectors {
 public:
  using Vector = Eigen::Ref<Eigen::VectorXd>;
  using Matrix = Eigen::Ref<Eigen::MatrixXd>;
  using JacobianOf = void (*)(const mjModel*, const mjData*, mjtNum*, mjtNum*, const mjtNum*, int);

  explicit FullVectors(const Scene& scene);

  void Jacobian(JacobianOf function, const mjModel* model, const mjData* data, const Vector3& p_W,
                int body, Engine::Jacobian6 J) noexcept;
  void MassMatrix(const mjModel* model, const mjData* data, Matrix M) const noexcept;
  void TimesMass(const mjModel* model, const mjData* data, const double* a,
                 double* force) const noexcept;
  // Adds the forces of a wrench at p_W on a body. `wrench` has six numbers and `p_W` has three.
  void AddWrench(const mjModel* model, mjData* data, const double* wrench, const double* p_W,
                 int body, Vector forces) noexcept;
  // Adds what the active constraints contribute to a matrix M with M · acceleration = force. The
  // coordinates of the movable objects on which these constraints act are eliminated (Schur
  // complement) unless M contains them.
  void AddReactions(const mjModel* model, const mjData* data, Matrix M) const noexcept;
  void Displace(const mjModel* model, mjData* data, const double* change, double scale) noexcept;

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Eigen::Index own_, all_;  // numbers of velocities
  bool same_;
  mutable Eigen::VectorXd from_, to_;
  RowMajor J_;
  mutable Eigen::MatrixXd M_, coupling_, eliminated_;
  mutable Eigen::LLT<Eigen::MatrixXd> factor_;  // of the movable objects' block
};

}  // namespace predictor
