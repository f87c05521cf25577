// Measures the share of a force that oscillates faster than intentional human motion.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/types.h"

namespace predictor {

// Divides the power from 3 to 10 Hz by the power from 0 to 10 Hz. The windows have a length of 4 s
// and overlap by half. In each window, the mean is removed and a Hann window is applied. The powers
// of the axes are summed (similar to the index of Dimeas and Aspragathos, 2016). The index does not
// detect oscillations below 3 Hz. The oscillation of an underdamped cobot at 1 Hz is detected from
// the growth of its cycles.
class OscillationIndex {
 public:
  static constexpr double kWindow = 4;               // [s]
  static constexpr double kLow = 3, kHigh = 10;      // [Hz]
  static constexpr double kWarn = 0.3, kStop = 0.5;  // thresholds of the index
  static constexpr double kStopForce = 3;  // rms of the force in the window about its mean [N]
  static constexpr double kMinForce = 1;   // " [N]

  struct Window {
    double time = 0;   // middle of the window [s]
    double index = 0;  // 0 to 1
    double rms = 0;    // rms of the force from 3 to 10 Hz [N]
    double total = 0;  // rms up to 10 Hz, with the mean removed [N]
    // Returns false if the force hardly varies, because the index then has no meaning.
    bool IsMeaningful() const { return total > kMinForce; }
    bool IsStrong() const { return total > kStopForce; }
  };

  explicit OscillationIndex(double dt);
  // `force` [N] is in the axes of W, and `time` is the time of the tick [s]. Returns the window
  // that this force completes, or null. Does not use the heap.
  const Window* Add(double time, const Vector3& force) noexcept;
  // Call this function if the next force does not follow the last force immediately.
  void Break() noexcept;

 private:
  void Close() noexcept;
  static constexpr std::size_t kSamples = 400;  // samples per window
  double dt_;
  int each_;                       // ticks averaged per sample
  int count_ = 0;                  // ticks in the current sample
  double time_ = 0;                // time of the newest tick [s]
  Vector3 sum_ = Vector3::Zero();  // sum of the forces in the current sample [N]
  std::vector<Vector3> samples_;   // [N]
  Window window_;                  // the last complete window
};

}  // namespace predictor
