// What is not as it should be, but no reason to stop: told to a person.
#pragma once

#include <array>
#include <cstdint>

#include "core/archive.h"
#include "core/messages.h"

namespace predictor {

// What the warnings are judged by. Written by the emulator.
struct WarningInput {
  std::array<bool, kHands> present = {};
  const DeviceSample* sample = nullptr;
  std::array<HandWrench, kHands> wrench;
  bool rests = false;  // nothing was sent to the arms, and nobody is asked to hold them
};

// Losses and refusals are counted over about a second. A drift is seen by a straight line through
// the force of kDriftTime at rest: its slope, where what is left beside it is the sensor's own
// noise (a hand is not so quiet). A warning stays until what it tells of has fallen to half the
// limit.
class Warnings {
 public:
  // At first nothing is counted: what came while nobody read yet was not lost on the way [s].
  static constexpr double kBeginning = 0.5;
  static constexpr double kMostLost = 0.01;    // share of the samples
  static constexpr double kFewest = 1.5;       // a single loss is none to tell of
  static constexpr double kMostRefused = 0.5;  // [1/s]
  static constexpr double kMostDrift = 2;      // [N/min]
  static constexpr double kDriftTime = 5;      // [s]

  // quiet: standard deviation of a force that nobody exerts, at most [N]. dt: tick [s].
  Warnings(const std::array<double, kHands>& quiet, double dt) : quiet_(quiet), dt_(dt) {}

  // No heap, no throw.
  void Follow(const WarningInput& input) noexcept;
  // Bit = Warning, and values as in HandRecord.
  std::uint8_t bits(std::size_t hand) const noexcept { return bits_[hand]; }
  const std::array<double, kWarningValues>& values(std::size_t hand) const noexcept {
    return values_[hand];
  }
  void Archive(StateArchive& a) noexcept { a(arm_, sensor_, lines_, bits_, values_); }

 private:
  // Counts of the last second, older ones forgotten.
  struct Link {
    LinkCounts last;
    double known = 0;  // for how long [s]
    double taken = 0, lost = 0, refused = 0;
    void Count(const LinkCounts& now, double dt) noexcept;
    double share() const noexcept { return lost > kFewest ? lost / (taken + lost) : 0; }
    void Archive(StateArchive& a) noexcept { a(last, known, taken, lost, refused); }
  };
  // Sums for a straight line through each axis of a force.
  struct Line {
    double n = 0, t = 0, tt = 0;
    Vector3 f = Vector3::Zero(), tf = Vector3::Zero(), ff = Vector3::Zero();
    Vector3 first = Vector3::Zero();
    void Archive(StateArchive& a) noexcept { a(n, t, tt, f, tf, ff, first); }
  };

  void FollowForce(std::size_t hand, const Vector3& force, bool rests) noexcept;
  void Judge(std::size_t hand, Warning warning, double value, double limit) noexcept;
  void Set(std::size_t hand, Warning warning, bool in_force) noexcept;

  std::array<double, kHands> quiet_;
  double dt_;
  std::array<Link, kHands> arm_, sensor_;
  std::array<Line, kHands> lines_;
  std::array<std::uint8_t, kHands> bits_ = {};
  std::array<std::array<double, kWarningValues>, kHands> values_ = {};
};

}  // namespace predictor
