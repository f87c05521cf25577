// Determines the warnings, which report conditions to the operator without stopping the run.
#pragma once

#include <array>
#include <cstdint>

#include "core/archive.h"
#include "core/messages.h"

namespace predictor {

// The input of the function that determines the warnings. The supervisor writes it.
struct WarningInput {
  Hands present;
  const DeviceSample* sample = nullptr;
  std::array<HandWrench, kHands> wrench;
  bool rests = false;  // the arms are at rest, and no one needs to hold the handles
};

// Lost packets and refused commands are counted over about one second. Drift is the slope of a
// straight line that is fitted to the force over kDriftTime at rest. The residual of the fit must
// not exceed the sensor's own noise, because the force of a hand is always noisier than the sensor.
// A warning remains until its value has fallen to half the limit.
class Warnings {
 public:
  // During this initial time [s], nothing is counted, because packets that arrived before the
  // program read them were not lost.
  static constexpr double kStartTime = 0.5;
  static constexpr double kMaxLost = 0.01;    // largest share of lost samples
  static constexpr double kMinLosses = 1.5;   // fewer losses cause no warning
  static constexpr double kMaxRefused = 0.5;  // [1/s]
  static constexpr double kMaxDrift = 2;      // [N/min]
  static constexpr double kDriftTime = 5;     // [s]

  // `quiet` is the largest standard deviation of the force on a free handle [N]. `dt` is the
  // duration of a tick [s].
  Warnings(const std::array<double, kHands>& quiet, double dt) : quiet_(quiet), dt_(dt) {}

  // Does not use the heap or throw.
  void Update(const WarningInput& input) noexcept;
  // `bits` contains one bit for each Warning. The values have the same meaning as in HandRecord.
  std::uint8_t bits(std::size_t hand) const noexcept { return bits_[hand]; }
  const std::array<double, kWarningValues>& values(std::size_t hand) const noexcept {
    return values_[hand];
  }
  void Archive(StateArchive& a) noexcept { a(arm_, sensor_, lines_, bits_, values_); }

 private:
  // The numbers of lost packets and refused commands during about the last second. Older counts
  // fade.
  struct Link {
    LinkCounts last;
    double known = 0;  // time since the first count [s]
    double taken = 0, lost = 0, refused = 0;
    void Count(const LinkCounts& now, double dt) noexcept;
    double share() const noexcept { return lost > kMinLosses ? lost / (taken + lost) : 0; }
    void Archive(StateArchive& a) noexcept { a(last, known, taken, lost, refused); }
  };
  // The sums from which a straight line is fitted to each axis of a force.
  struct Line {
    double n = 0, t = 0, tt = 0;
    Vector3 f = Vector3::Zero(), tf = Vector3::Zero(), ff = Vector3::Zero();
    Vector3 first = Vector3::Zero();
    void Archive(StateArchive& a) noexcept { a(n, t, tt, f, tf, ff, first); }
  };

  void UpdateDrift(std::size_t hand, const Vector3& force, bool rests) noexcept;
  void Compare(std::size_t hand, Warning warning, double value, double limit) noexcept;
  void Set(std::size_t hand, Warning warning, bool in_force) noexcept;

  std::array<double, kHands> quiet_;
  double dt_;
  std::array<Link, kHands> arm_, sensor_;
  std::array<Line, kHands> lines_;
  std::array<std::uint8_t, kHands> bits_ = {};
  std::array<std::array<double, kWarningValues>, kHands> values_ = {};
};

}  // namespace predictor
