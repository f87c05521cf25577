// Bias of a force/torque sensor, mass and centre of gravity of the handle on it, out of poses at
// rest in which nobody touches the handle.
//
//   F = b_F + d_F t + m g        T = b_T + d_T t − g × (m c)        about S, axes of S
//
// g gravity [m/s²], t time since the last pose, b bias then, d its drift (a sensor that warms up).
// Everything unknown enters linearly, force and torque apart: two least squares.
#pragma once

#include <array>
#include <span>
#include <string>

#include "core/least_squares.h"
#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

struct RestingPose {
  double time = 0;                // when it was taken, from any origin [s]
  Vector3 g_S = Vector3::Zero();  // gravity in axes of S [m/s²]
  Wrench F_S = Wrench::Zero();    // mean of the readings, about S, axes of S
};

// Readings of one pose: their mean, if the arm rests and nobody touches the handle meanwhile.
class PoseRecorder {
 public:
  static constexpr int kReadings = 500;    // of the sensor that make a pose
  static constexpr double kMoves = 0.002;  // a joint that turns further does not rest [rad]

  explicit PoseRecorder(const SensorSpec& sensor);

  void Begin();
  // A fresh reading F_S, the joints [rad] and gravity [m/s²] in S then.
  void Add(const JointVector& q, const Vector3& g_S, const Wrench& F_S, double time);
  bool complete() const { return count_ >= kReadings; }
  // Why it is no pose, and what to do; "" if it is one.
  std::string Refusal() const;
  RestingPose pose() const;

 private:
  Wrench quiet_;  // standard deviations that are no touch
  JointVector q_;
  Vector3 g_S_ = Vector3::Zero();
  Wrench first_ = Wrench::Zero(), sum_ = Wrench::Zero(), squares_ = Wrench::Zero();
  double moved_ = 0;  // of a joint, at most [rad]
  double time_ = 0;
  int count_ = 0;
};

struct HandleCalibration {
  Estimate mass;                           // [kg]
  std::array<Estimate, 3> center_of_mass;  // in S [m]
  std::array<Estimate, 6> bias;            // at the last pose [N], [N·m]
  Wrench drift = Wrench::Zero();           // of the bias [N/s], [N·m/s]
  Wrench residual = Wrench::Zero();        // rms of each axis over the poses [N], [N·m]
  int poses = 0;
};

inline constexpr int kLeastHandlePoses = 6;

// Throws InputError, a sentence for a person: too few poses, poses too alike, one that does not fit
// the others (the handle was touched), or readings that no handle explains.
HandleCalibration CalibrateHandle(std::span<const RestingPose> poses, const SensorSpec& sensor);

// As a table; `before`: what was believed.
std::string HandleText(const HandleCalibration& found, const HandlePayloadSpec& before);

// The payload with what was found. The inertia grows with the mass: it is not measured. Of a handle
// without weight (the arm takes it off by itself) the centre of mass stays as it was.
HandlePayloadSpec WithCalibration(const HandlePayloadSpec& before, const HandleCalibration& found);

}  // namespace predictor
