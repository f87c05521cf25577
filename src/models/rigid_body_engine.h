// Interface to Pinocchio without its headers, which cost 6 s per translation unit.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/types.h"
#include "models/urdf.h"

namespace predictor {

struct EngineModel;
struct EngineData;

// Results of the engine's algorithms. Joint frames: 0 is the base, 1 and above are the movable
// joints.
struct EngineState {
  JointVector v;  // [rad/s]
  std::array<Matrix3, kMaxJoints + 1> R_WJ;
  std::array<Vector3, kMaxJoints + 1> p_WJ;  // [m]
  Jacobian J_W;               // column k: twist of W's origin caused by joint k alone, axes of W
  JointMatrix M;              // [kg·m²]
  JointVector bias, gravity;  // [N·m]
};

// Parameters in which a body's inertia is linear: mass m [kg], m c [kg·m], then the inertia about
// the joint's frame, xx xy yy xz yz zz [kg·m²], all in the axes of that frame.
inline constexpr int kInertialParameters = 10;

struct EngineRegressor;

// Builds the model. `body` and `X_JL` give, for each link, the joint that carries it and its pose
// in that joint's frame.
std::shared_ptr<const EngineModel> MakeEngineModel(const UrdfModel& urdf, const Pose& X_WB,
                                                   std::vector<int>* body, std::vector<Pose>* X_JL);
std::shared_ptr<EngineData> MakeEngineData(const EngineModel& model);

// R_WJ, p_WJ, J_W at q. No allocation.
void ComputeKinematics(const EngineModel& model, const JointVector& q, EngineData* data,
                       EngineState* state);
// Computes the above and M, bias and gravity torques at (q, v). gravity [m/s²] acts along −z of W.
// No allocation.
void ComputeDynamics(const EngineModel& model, const JointVector& q, const JointVector& v,
                     double gravity, EngineData* data, EngineState* state);

// Parameters of the moving bodies, kInertialParameters each, in the order of their joints.
Eigen::VectorXd InertialParametersOf(const EngineModel& model);

// Workspace of the regressor with gravity [m/s²] along −z of W.
std::shared_ptr<EngineRegressor> MakeEngineRegressor(const EngineModel& model, double gravity);
// Y of τ = Y(q, v, a) π: torques without friction [N·m] as a function of the inertial parameters π.
const Eigen::MatrixXd& ComputeTorqueRegressor(const JointVector& q, const JointVector& v,
                                              const JointVector& a, EngineRegressor* regressor);

}  // namespace predictor
