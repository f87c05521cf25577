#include "simulation/linearise.h"

#include <algorithm>
#include <vector>

namespace predictor {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPositionStep = 1e-6;  // [rad, m]
// The step of the velocities is in [rad/s, m/s]. The result is exact, because the forces are
// quadratic in the velocities.
constexpr double kVelocityStep = 1e-4;
constexpr double kWrenchStep = 1e-2;  // [N, N·m]
constexpr double kMemoryStep = 1e-6;  // of a controller

class Linearisation {
 public:
  Linearisation(ControlledScene* scene, Engine* engine, double t, bool contacts)
      : scene_(*scene),
        engine_(*engine),
        time_(t),
        n_(engine->dof()),
        sensed_(scene->has_wrist_sensor() ? 6 : 0),
        positions_(engine->positions()),
        filtered_(scene->wrist().filtered()),
        memory_(scene->memory().begin(), scene->memory().end()),
        options_(engine->options()) {
    engine_.SetOptions({.coulomb_friction = false,
                        .tolerance = options_.tolerance,
                        .movables_touch = false,
                        .cobot_touches = false,
                        .contacts = contacts});
  }
  ~Linearisation() {
    engine_.SetOptions(options_);
    SetInner(VectorXd::Zero(inner()));
  }

  LinearModel Compute(const Hands& hands, const std::array<Pose, kHands>& X_OD) {
    MatrixXd J = MatrixXd::Zero(6 * kHands, n_);
    for (const int h : hands) J.middleRows(6 * h, 6) = HandleJacobian(X_OD[h]);
    const int states = 2 * n_ + inner();
    LinearModel model;
    model.dof = n_;
    model.A.setZero(states, states);
    model.A.block(0, n_, n_, n_).setIdentity();
    const MatrixXd slopes = SlopesByState();
    model.A.bottomRows(n_ + inner()) = slopes.topRows(n_ + inner());
    model.B.setZero(states, J.rows());
    for (const int h : hands)
      for (int i = 0; i < 6; ++i)
        model.B.block(n_, 6 * h + i, n_ + inner(), 1) =
            EffectOfWrench(J.row(6 * h + i), X_OD[h], i);
    model.C.setZero(J.rows(), states);
    model.C.middleCols(n_, n_) = J;
    if (scene_.timing().mean_delay() > 0) AddDelay(slopes.bottomRows(dof()), &model);
    return model;
  }

  SceneSlopes Slopes() {
    const MatrixXd slopes = SlopesByState();
    return {slopes.topRows(n_ + inner()), SlopesByTorque(), slopes.bottomRows(dof()), sensed_,
            sensed_ > 0 ? WristRate() : 0};
  }

 private:
  int dof() const { return static_cast<int>(scene_.torque().size()); }
  // Returns the number of states of the wrist sensor's filter and the controller's memory together.
  int inner() const { return sensed_ + static_cast<int>(memory_.size()); }

  // Returns the derivatives of the rates and, in the rows below, those of the controller's torques.
  MatrixXd SlopesByState() {
    MatrixXd slopes(n_ + inner() + dof(), 2 * n_ + inner());
    const VectorXd zero = VectorXd::Zero(n_), same = VectorXd::Zero(inner());
    for (int i = 0; i < n_; ++i) {
      const VectorXd e = VectorXd::Unit(n_, i);
      slopes.col(i) = Slope(kPositionStep, e, zero, zero, same);
      slopes.col(n_ + i) = Slope(kVelocityStep, zero, e, zero, same);
    }
    for (int i = 0; i < inner(); ++i)
      slopes.col(2 * n_ + i) = Slope(i < sensed_ ? kWrenchStep : kMemoryStep, zero, zero, zero,
                                     VectorXd::Unit(inner(), i));
    return slopes;
  }

  // Returns the derivatives of the rates.
  MatrixXd SlopesByTorque() {
    MatrixXd slopes(n_ + inner(), dof());
    const VectorXd zero = VectorXd::Zero(n_), same = VectorXd::Zero(inner());
    for (int j = 0; j < dof(); ++j) {
      const VectorXd e = VectorXd::Unit(n_, engine_.layout().v[static_cast<std::size_t>(j)]);
      slopes.col(j) = Slope(kWrenchStep, zero, zero, e, same).head(n_ + inner());
    }
    return slopes;
  }

  // Returns the rates caused by component `i` of a wrench on a handle whose velocity is `row` times
  // v.
  VectorXd EffectOfWrench(const Eigen::RowVectorXd& row, const Pose& X_OD, int i) {
    const VectorXd zero = VectorXd::Zero(n_), same = VectorXd::Zero(inner());
    if (sensed_ == 0) {
      return Slope(kWrenchStep, zero, zero, row.transpose(), same).head(n_ + inner());
    }
    // The wrist sensor senses wrenches on the object, but not forces on joints.
    on_object_ = AtCenterOfMass(X_OD, Vector6::Unit(i));
    const VectorXd rates = Slope(kWrenchStep, zero, zero, zero, same).head(n_ + inner());
    on_object_.setZero();
    return rates;
  }

  // Delays the controller's torques by two first-order all-pass sections per joint (as the loop's
  // other delays, haptics/stability.cpp). If z' = c (input − z), the output of a section is 2 z −
  // input. The torques that act differ from the computed ones by 2 z_2 − 2 z_1.
  void AddDelay(const MatrixXd& torque, LinearModel* model) {
    const Eigen::Index states = model->A.rows(), joints = dof();
    const double c = 4 / scene_.timing().mean_delay();
    const MatrixXd by_torque = SlopesByTorque();
    MatrixXd A = MatrixXd::Zero(states + 2 * joints, states + 2 * joints);
    A.topLeftCorner(states, states) = model->A;
    A.block(n_, states, n_ + inner(), joints) = -2 * by_torque;
    A.block(n_, states + joints, n_ + inner(), joints) = 2 * by_torque;
    A.block(states, 0, joints, states) = c * torque;
    A.block(states, states, joints, joints).diagonal().setConstant(-c);
    A.block(states + joints, 0, joints, states) = -c * torque;
    A.block(states + joints, states, joints, joints).diagonal().setConstant(2 * c);
    A.block(states + joints, states + joints, joints, joints).diagonal().setConstant(-c);
    model->A = A;
    model->B.conservativeResizeLike(MatrixXd::Zero(A.rows(), model->B.cols()));
    model->C.conservativeResizeLike(MatrixXd::Zero(model->C.rows(), A.rows()));
  }

  // Returns the central difference of the rates along a direction of positions, velocities, forces,
  // and states of sensor and controller. `on_object_` is part of the direction.
  VectorXd Slope(double step, const VectorXd& dq, const VectorXd& v, const VectorXd& force,
                 const VectorXd& in) {
    const VectorXd ahead = Rates(step * dq, step * v, step * force, step * in, step);
    return (ahead - Rates(-step * dq, -step * v, -step * force, -step * in, -step)) / (2 * step);
  }

  void SetInner(const VectorXd& change) {
    if (sensed_ > 0) scene_.wrist().SetFiltered(filtered_ + change.head(sensed_));
    const std::span<double> memory = scene_.memory();
    for (std::size_t i = 0; i < memory.size(); ++i)
      memory[i] = memory_[i] + change[sensed_ + static_cast<Eigen::Index>(i)];
  }

  // Returns the accelerations, the rates of the sensor's and the controller's states, and the
  // controller's torques.
  VectorXd Rates(const VectorXd& dq, const VectorXd& v, const VectorXd& force, const VectorXd& in,
                 double step) {
    engine_.positions() = positions_;
    engine_.Displace(dq.data(), 1);
    engine_.velocities() = v;
    engine_.ForgetSolution();
    engine_.joint_forces().setZero();
    engine_.SetObjectWrench(step * on_object_);
    SetInner(in);
    scene_.Update(&engine_);
    scene_.ApplyController(time_, &engine_);
    engine_.joint_forces() += force;
    engine_.ComputeAccelerations(sensed_ > 0);
    VectorXd rates(n_ + inner() + dof());
    rates << engine_.accelerations(), InnerRates(), scene_.torque();
    return rates;
  }

  // Returns the cutoff of the wrist sensor [rad/s], which accounts for the lag of sampling. On
  // average, a reading is half a sub-step old. The integration of the memory is explicit, which
  // delays the memory by half a period.
  double WristRate() {
    const double lag = 0.5 * (engine_.step() + scene_.timing().period_time());
    return 1 / (1 / scene_.wrist().cutoff() + lag);
  }

  VectorXd InnerRates() {
    VectorXd rates(inner());
    if (sensed_ > 0)
      rates.head(sensed_) = WristRate() * (scene_.WristWrench(engine_) - scene_.wrist().filtered());
    const std::span<double> memory = scene_.memory();
    const auto size = static_cast<Eigen::Index>(memory.size());
    const VectorXd before = Eigen::Map<VectorXd>(memory.data(), size);
    const double dt = scene_.timing().period_time();
    scene_.Advance(time_, dt);
    rates.tail(size) = (Eigen::Map<VectorXd>(memory.data(), size) - before) / dt;
    return rates;
  }

  // Converts a wrench on a handle to a wrench about the object's centre of mass.
  Wrench AtCenterOfMass(const Pose& X_OD, const Wrench& F_D) {
    const VectorXd zero = VectorXd::Zero(n_);
    Rates(zero, zero, zero, VectorXd::Zero(inner()), 0);
    const Vector3 p_WD = engine_.PoseOf(SceneBody::kObject) * X_OD.p;
    return ShiftWrench(F_D, p_WD - engine_.object_com());
  }

  // Returns J with V_WD = J v.
  MatrixXd HandleJacobian(const Pose& X_OD) {
    const VectorXd zero = VectorXd::Zero(n_);
    Rates(zero, zero, zero, VectorXd::Zero(inner()), 0);
    const Vector3 p_WD = engine_.PoseOf(SceneBody::kObject) * X_OD.p;
    Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor> J(6, n_);
    engine_.Jacobian(SceneBody::kObject, p_WD, J);
    return J;
  }

  ControlledScene& scene_;
  Engine& engine_;
  double time_;
  int n_, sensed_;
  VectorXd positions_;  // the posture about which the scene is linearised
  Wrench on_object_ = Wrench::Zero();
  Wrench filtered_;  // states of sensor and controller there
  std::vector<double> memory_;
  Engine::Options options_;
};

}  // namespace

LinearModel Linearise(ControlledScene* scene, Engine* engine, double t, const Hands& hands,
                      const std::array<Pose, kHands>& X_OD, bool contacts) {
  return Linearisation(scene, engine, t, contacts).Compute(hands, X_OD);
}

SceneSlopes SlopesOf(ControlledScene* scene, Engine* engine, double t) {
  return Linearisation(scene, engine, t, true).Slopes();
}

}  // namespace predictor
