// How much of a force oscillates faster than a person moves on purpose.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/types.h"

namespace predictor {

// Power from 3 to 10 Hz as a part of that from 0 to 10 Hz, of windows of 4 s that overlap by half:
// mean removed, Hann's window, summed over the axes (as Dimeas and Aspragathos, 2016, define such
// an index). Blind below 3 Hz: an underdamped cobot at 1 Hz is found by the growth of its cycles.
class OscillationIndex {
 public:
  static constexpr double kWindow = 4;               // [s]
  static constexpr double kLow = 3, kHigh = 10;      // [Hz]
  static constexpr double kWarn = 0.3, kStop = 0.5;  // of the index
  static constexpr double kStopForce = 3;            // rms of the window's force about its mean [N]
  static constexpr double kLeastForce = 1;           // " [N]

  struct Window {
    double time = 0;   // of its middle [s]
    double index = 0;  // 0 to 1
    double rms = 0;    // of the force from 3 to 10 Hz [N]
    double total = 0;  // up to 10 Hz, the mean removed [N]
    // Of a force that hardly varies the index says nothing.
    bool Tells() const { return total > kLeastForce; }
  };

  explicit OscillationIndex(double dt);
  // force [N], axes of W; time of the tick [s].
  void Add(double time, const Vector3& force);
  // The next force does not follow on the last.
  void Break();
  const std::vector<Window>& windows() const { return windows_; }

 private:
  void Close();
  static constexpr std::size_t kSamples = 400;  // of a window
  double dt_;
  int each_;                       // ticks that are averaged into a sample
  int count_ = 0;                  // of them so far
  double time_ = 0;                // of the newest [s]
  Vector3 sum_ = Vector3::Zero();  // of them [N]
  std::vector<Vector3> samples_;   // [N]
  std::vector<Window> windows_;
};

}  // namespace predictor
