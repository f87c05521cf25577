// The safety functions of the virtual cobot, as a vendor provides them. They are protective stops
// and caps.
#pragma once

#include <Eigen/Cholesky>

#include "core/archive.h"
#include "simulation/controller.h"

namespace predictor {

// The cobot knows its own model, its joint state and its torques. From these, it estimates the
// external torques in its joints by a first-order observer (De Luca & Mattone 2003, "Actuator
// failure detection and isolation using generalized momenta"):
//
//   τ̇_ext = 2π f (M v̇ + h + friction − τ − τ_ext)
//
// and the wrench on the end-effector from them. The wrench at the start is the configured payload.
class CobotSafety {
 public:
  explicit CobotSafety(const CobotSpec& spec);

  bool is_on() const noexcept { return watches_ || spec_.force_cap || spec_.speed_cap; }
  CobotStop stop() const noexcept { return stop_; }
  // Returns the estimated wrench on E beyond the payload, about E, in axes of W [N], [N·m].
  Wrench external_wrench() const noexcept { return F_E_W_ - load(); }

  // The cobot is assumed to rest at `input` under its torques. The only external force on the cobot
  // is assumed to be that of its payload.
  void Reset(const ControllerInput& input) noexcept;
  // Takes the state after a sub-step of dt [s] under input.torque. Starts a protective stop if a
  // limit is exceeded.
  void Watch(const ControllerInput& input, double dt) noexcept;
  // Takes the velocities [rad/s] after a sub-step in which closed brakes held the joints.
  void Skip(const JointVector& v) noexcept { v_before_ = v; }
  // Sets the share of its payload that the cobot carries from now on, which is 0 after it put the
  // object down, and the wrench of a further load on E, about E, in axes of W [N, N·m]. The
  // estimates change at once, whereas the observer alone would change them slowly.
  void SetLoad(const ControllerInput& input, double share, const Wrench& further) noexcept;
  // Caps the controller's torques. A protective stop lasts until Reset. During the stop, the
  // function replaces these torques.
  void Limit(const ControllerInput& input, double dt, JointVector* torque) noexcept;

  void Archive(StateArchive& a) noexcept;

 private:
  Wrench load() const noexcept { return load_ * payload_ + further_; }
  JointVector Friction(const JointVector& v) const noexcept;
  Wrench WrenchOf(const ControllerInput& input, const JointVector& torque) noexcept;
  CobotStop Exceeded(const ControllerInput& input) noexcept;
  double Mobility(const ControllerInput& input, const Vector3& direction) noexcept;
  void CapForce(const ControllerInput& input, JointVector* torque) noexcept;
  void CapSpeed(const ControllerInput& input, JointVector* torque) noexcept;
  void StopTorque(const ControllerInput& input, double dt, JointVector* torque) noexcept;

  CobotSafetySpec spec_;
  JointFriction friction_;
  bool watches_;
  CobotStop stop_ = CobotStop::kNone;
  JointVector v_before_, external_;                           // [rad/s], [N·m]
  Wrench F_E_W_ = Wrench::Zero(), payload_ = Wrench::Zero();  // estimated
  double load_ = 1;                                           // share of payload_ that is there
  Wrench further_ = Wrench::Zero();                           // of the further load
  JointVector q_stop_, v_stop_;                               // reference of the stop
  double fade_ = 0, fade_rate_ = 0;                           // of v_stop_ [1], [1/s]
  Jacobian J_;                                                // workspace
  Eigen::LLT<Matrix6> factor_;
  Eigen::LLT<JointMatrix> M_factor_;
};

}  // namespace predictor
