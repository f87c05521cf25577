// What is asked of Pinocchio, without its headers: they cost 6 s a translation unit.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/types.h"
#include "models/urdf.h"

namespace predictor {

struct EngineModel;
struct EngineData;

// Result of the engine's algorithms; frames of joints, 0 the base, 1.. the movable joints.
struct EngineState {
  JointVector v;  // [rad/s]
  std::array<Matrix3, kMaxJoints + 1> R_WJ;
  std::array<Vector3, kMaxJoints + 1> p_WJ;  // [m]
  Jacobian J_W;               // column k: twist of W's origin, as moved by joint k alone, axes of W
  JointMatrix M;              // [kg·m²]
  JointVector bias, gravity;  // [N·m]
};

// What a body's inertia is linear in: mass m [kg], m c [kg·m], then the inertia about the joint's
// frame, xx xy yy xz yz zz [kg·m²], all with that frame's axes.
inline constexpr int kInertialParameters = 10;

struct EngineRegressor;

// Builds the model. `body` and `X_JL` tell for each link which joint carries it, and where.
std::shared_ptr<const EngineModel> MakeEngineModel(const UrdfModel& urdf, const Pose& X_WB,
                                                   std::vector<int>* body, std::vector<Pose>* X_JL);
std::shared_ptr<EngineData> MakeEngineData(const EngineModel& model);

// R_WJ, p_WJ, J_W at q. No allocation.
void ComputeKinematics(const EngineModel& model, const JointVector& q, EngineData* data,
                       EngineState* state);
// The above and M, bias, gravity at (q, v); gravity [m/s²] along −z of W. No allocation.
void ComputeDynamics(const EngineModel& model, const JointVector& q, const JointVector& v,
                     double gravity, EngineData* data, EngineState* state);

// Parameters of the bodies that move, kInertialParameters each, in the order of their joints.
Eigen::VectorXd InertialParametersOf(const EngineModel& model);

// Workspace of the regressor under a gravity [m/s²] along −z of W.
std::shared_ptr<EngineRegressor> MakeEngineRegressor(const EngineModel& model, double gravity);
// Y of τ = Y(q, v, a) π: torques without friction [N·m] by the inertial parameters π.
const Eigen::MatrixXd& ComputeTorqueRegressor(const JointVector& q, const JointVector& v,
                                              const JointVector& a, EngineRegressor* regressor);

}  // namespace predictor
