// Writes the state that a fake Franka arm sends every millisecond.
#include <Eigen/Geometry>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include "fakes/franka/fake_franka.h"

namespace predictor {
namespace {

// Returns the pose of the end-effector in the flange for Franka's hand. The stiffness frame lies
// beyond the end-effector frame.
Eigen::Isometry3d FlangeToEndEffector() {
  return Eigen::Translation3d(0, 0, 0.1034) *
         Eigen::AngleAxisd(-std::numbers::pi / 4, Eigen::Vector3d::UnitZ());
}
Eigen::Isometry3d EndEffectorToStiffness() {
  return Eigen::Translation3d(0.01, -0.02, 0.05) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX());
}

// Computes the pose of the flange from the parameters that Franka publishes, in Craig's convention
// [m].
Eigen::Isometry3d BaseToFlange(const FrankaJoints& q, double flange) {
  constexpr double kQuarter = std::numbers::pi / 2;
  constexpr double a[] = {0, 0, 0, 0.0825, -0.0825, 0, 0.088},
                   d[] = {0.333, 0, 0.316, 0, 0.384, 0, 0},
                   alpha[] = {0, -kQuarter, kQuarter, kQuarter, -kQuarter, kQuarter, kQuarter};
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < q.size(); ++i)
    X = X * Eigen::AngleAxisd(alpha[i], Eigen::Vector3d::UnitX()) *
        Eigen::Translation3d(a[i], 0, d[i]) * Eigen::AngleAxisd(q[i], Eigen::Vector3d::UnitZ());
  return X * Eigen::Translation3d(0, 0, flange);
}

template <class Real>
void Put(const Eigen::Isometry3d& X, Real (&to)[16]) {
  for (int i = 0; i < 16; ++i) to[i] = static_cast<Real>(X.matrix()(i % 4, i / 4));
}
template <class Real>
void Put(const FrankaJoints& from, Real (&to)[7]) {
  for (std::size_t i = 0; i < 7; ++i) to[i] = static_cast<Real>(from[i]);
}

}  // namespace

void FakeFranka::SendState(const ArmSample& sample) {
  if (panda()) return Queue(State<fci::PandaState>(sample));
  if (options_.early) return Queue(State<fci::EarlyResearch3State>(sample));
  Queue(State<fci::Research3State>(sample));
}

template <class Real>
void FakeFranka::FillWrench(const ArmSample& sample, fci::Signals<Real>* signals) const {
  const Eigen::Isometry3d X_FE = FlangeToEndEffector(), X_EK = EndEffectorToStiffness();
  Put(X_FE, signals->F_T_EE);
  Put(X_FE, signals->F_T_NE);
  Put(Eigen::Isometry3d::Identity(), signals->NE_T_EE);
  Put(X_EK, signals->EE_T_K);
  Put(BaseToFlange(FrankaJointsOf(sample.q), options_.flange) * X_FE, signals->O_T_EE);
  const Eigen::Isometry3d X_FS =
      Eigen::Translation3d(options_.X_FS.p) * Eigen::Quaterniond(options_.X_FS.q);
  const Eigen::Isometry3d X_KS = (X_FE * X_EK).inverse() * X_FS;
  // The force and the torque are the reactions to the force and the torque on the sensor, about the
  // origin of K.
  const Eigen::Vector3d force = -(X_KS.linear() * sample.F_S_raw.head<3>());
  const Eigen::Vector3d torque =
      -(X_KS.linear() * sample.F_S_raw.tail<3>()) + X_KS.translation().cross(force);
  for (int i = 0; i < 3; ++i) {
    signals->K_F_ext_hat_K[i] = static_cast<Real>(force[i]);
    signals->K_F_ext_hat_K[3 + i] = static_cast<Real>(torque[i]);
  }
}

template <class Packet>
Bytes FakeFranka::State(const ArmSample& sample) const {
  alignas(8) Packet packet{};
  auto& signals = packet.signals;
  auto& modes = packet.modes;
  const bool moves = phase_ == Phase::kMoving;
  signals.message_id = message_id_;
  Put(FrankaJointsOf(sample.q), signals.q);
  Put(FrankaJointsOf(sample.v), signals.dq);
  Put(moves ? motion_.q() : FrankaJointsOf(sample.q), signals.q_d);
  if (moves) Put(motion_.v(), signals.dq_d);
  if (says_it_moves_) signals.dq_d[0] = 1e-3F;
  if (moves) Put(motion_.a(), signals.ddq_d);
  Put(FrankaJointsOf(sample.q), signals.theta);
  using Real = std::remove_reference_t<decltype(signals.m_ee)>;
  signals.m_ee = static_cast<Real>(options_.payload);
  for (std::size_t i = 0; i < 3; ++i)
    signals.F_x_Cee[i] = static_cast<Real>(options_.payload_cog[i]);
  FillWrench(sample, &signals);
  modes.motion_generator_mode =
      moves ? fci::MotionGeneratorMode::kJointVelocity : fci::MotionGeneratorMode::kIdle;
  modes.controller_mode =
      moves ? fci::ControllerMode::kJointImpedance : fci::ControllerMode::kOther;
  modes.robot_mode = mode_;
  for (std::size_t i = 0; i < 41; ++i) {
    modes.errors[i] = errors_[i] ? 1 : 0;
    modes.reflex_reason[i] = reflex_reason_[i] ? 1 : 0;
  }
  const double rate = moves ? static_cast<double>(successes_.count()) / 100 : 0;
  modes.control_command_success_rate =
      static_cast<decltype(modes.control_command_success_rate)>(rate);
  if (spoil_)
    signals.q[3] =
        std::numeric_limits<std::remove_reference_t<decltype(signals.q[3])>>::quiet_NaN();
  return AsBytes(packet);
}

void FakeFranka::Queue(Bytes state) {
  spoil_ = false;
  if (replay_ && !last_state_.empty()) state = last_state_;
  last_state_ = state;
  if (lose_states_ > 0) {
    --lose_states_;
    return;
  }
  if (leap_) state[5] ^= std::byte{1};  // the state begins with its number, little-endian
  leap_ = false;
  if (cut_) state.pop_back();
  cut_ = false;
  const std::uint64_t due = steps_ + delay_;
  if (swap_) {
    held_back_ = std::move(state);
    swap_ = false;
    return;
  }
  queue_.emplace_back(due, state);
  if (repeat_) queue_.emplace_back(due, state);
  repeat_ = false;
  if (!held_back_.empty()) queue_.emplace_back(due, std::move(held_back_));
  held_back_.clear();
}

}  // namespace predictor
