// Identifies the bias of a force/torque sensor, and the mass and centre of gravity of the handle on
// this sensor. The data are poses at rest in which no one touches the handle.
//
// F = b_F + d_F t + m g        T = b_T + d_T t − g × (m c)        about S, axes of S
//
// g is gravity [m/s²], t the time since the last pose, b the bias at that time, and d its drift
// (the sensor warms up). All unknowns enter linearly, and force and torque are separate, so there
// are two least-squares problems.
#pragma once

#include <array>
#include <span>
#include <string>

#include "core/least_squares.h"
#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor::commissioning {

struct RestingPose {
  double time = 0;                // time of the measurement, from any origin [s]
  Vector3 g_S = Vector3::Zero();  // gravity in axes of S [m/s²]
  Wrench F_S = Wrench::Zero();    // mean of the readings, about S, axes of S
};

// Collects the readings of one pose and computes their mean, provided that the arm rests and no one
// touches the handle.
class PoseRecorder {
 public:
  static constexpr int kReadings = 500;    // number of readings per pose
  static constexpr double kMoves = 0.002;  // a joint that turns further than this is not at rest
                                           // [rad]

  explicit PoseRecorder(const SensorSpec& sensor);

  void Begin();
  // Adds a new reading F_S, with the joints [rad] and the gravity [m/s²] in S at that time.
  void Add(const JointVector& q, const Vector3& g_S, const Wrench& F_S, double time);
  bool complete() const { return count_ >= kReadings; }
  // Returns the reason why the pose cannot be used, with the remedy, or "" if it can be used.
  std::string Refusal() const;
  RestingPose pose() const;

 private:
  Wrench quiet_;  // standard deviations of an untouched handle
  JointVector q_;
  Vector3 g_S_ = Vector3::Zero();
  Wrench first_ = Wrench::Zero(), sum_ = Wrench::Zero(), squares_ = Wrench::Zero();
  double moved_ = 0;  // largest motion of a joint [rad]
  double time_ = 0;
  int count_ = 0;
};

struct HandleCalibration {
  Estimate mass;                           // [kg]
  std::array<Estimate, 3> center_of_mass;  // centre of mass in S [m]
  std::array<Estimate, 6> bias;            // bias at the last pose [N], [N·m]
  Wrench drift = Wrench::Zero();           // drift of the bias [N/s], [N·m/s]
  Wrench residual = Wrench::Zero();        // rms of each axis over the poses [N], [N·m]
  int poses = 0;
};

inline constexpr int kMinHandlePoses = 6;

// Throws InputError with a sentence for the user: too few poses, poses that are too similar, a pose
// that does not fit the others (the handle was touched), or readings that no handle explains.
HandleCalibration CalibrateHandle(std::span<const RestingPose> poses, const SensorSpec& sensor);

// Returns the result as a table. `before` is the nominal payload.
std::string HandleText(const HandleCalibration& found, const HandlePayloadSpec& before);

// Returns the payload with the identified values. The inertia is scaled with the mass, because the
// inertia is not measured. If the handle has no weight because the arm subtracts the weight, the
// centre of mass is unchanged.
HandlePayloadSpec WithCalibration(const HandlePayloadSpec& before, const HandleCalibration& found);

}  // namespace predictor::commissioning
