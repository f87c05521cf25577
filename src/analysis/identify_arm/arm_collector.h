// Extracts the responses of a hand to displacements of its handle from a run.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "analysis/identify_arm/arm_fit.h"
#include "core/filters.h"
#include "core/record.h"
#include "scenario/scenario.h"

namespace predictor {

class ArmCollector {
 public:
  // Times that are kept before and after the onset of a displacement [s]. The time after the onset
  // covers the longest reflex and ends before a person reacts voluntarily (after about 200 ms:
  // Takagi 2020).
  static constexpr double kBefore = 0.18, kAfter = 0.2;

  // plane: two unit vectors. dt: tick [s].
  ArmCollector(const Scenario& scenario, int hand, const std::array<Vector3, 2>& plane, double dt);

  void Add(const TickRecord& record);  // in order
  ArmResponses responses() const;
  int taken() const { return static_cast<int>(windows_.size()); }
  // Number of displacements that ended early, or during which data were missing or a sensor was
  // saturated.
  int spoiled() const { return spoiled_; }
  double largest_force() const { return largest_force_; }  // of the hand in these windows [N]

 private:
  struct Sample {
    Eigen::Vector2d position, velocity, force;  // in the plane
  };
  struct Window {
    std::vector<Sample> samples;
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();
  };
  void Abandon();
  Eigen::Vector2d InPlane(const Vector3& x) const { return {plane_[0].dot(x), plane_[1].dot(x)}; }

  int hand_;
  std::array<Vector3, 2> plane_;
  double dt_;
  double amplitude_;  // [m]
  std::size_t before_, after_;
  // The filter and the delay of the sensor, which are applied to the motion as well.
  RampLowPass<Eigen::Vector4d> low_pass_;
  FractionalDelay<Eigen::Vector4d, 64> delay_;
  double delay_ticks_;
  bool started_ = false;  // the filters are filled
  std::uint64_t tick_ = 0;
  bool displaced_ = false;

  std::deque<Sample> past_;
  Window open_;
  bool is_open_ = false;
  std::vector<Window> windows_;
  int spoiled_ = 0;
  double largest_force_ = 0;
};

}  // namespace predictor
