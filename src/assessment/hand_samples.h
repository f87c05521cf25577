// The measurements of the person in a run, at 100 Hz.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/record.h"
#include "person/body_sample.h"
#include "scenario/scenario.h"

namespace predictor::assessment {

inline constexpr double kSampleRate = 100;  // [Hz]

struct PersonSample {
  person::BodySample body;
  std::array<double, kHands> peak_force = {};  // largest of the ticks within the sample [N]
  // False: before it, simulated time was paused, ticks are lost, or a hand gripped or let go.
  bool continues = true;
};

// The sample of successive ticks: means of position and wrench, the orientation of the middle one.
// A hand is present if it grips in most of them.
PersonSample SampleOf(std::span<const TickRecord> ticks);

// Means of position and wrench over all ticks of 10 ms. The middle tick gives the orientation. Only
// ticks in RUN count.
class SampleCollector {
 public:
  explicit SampleCollector(const Scenario& scenario);
  void Add(const TickRecord& record);
  // The record of the first tick in RUN; `tick` is 0 before it.
  const TickRecord& first() const { return first_; }
  const std::vector<PersonSample>& samples() const { return samples_; }

 private:
  void Close();

  std::uint64_t ticks_per_sample_;
  double dt_;
  TickRecord first_{};
  std::vector<TickRecord> pending_;
  std::vector<PersonSample> samples_;
  bool interrupted_ = false;
};

inline bool IsHeld(const PersonSample& sample) {
  return sample.body.hands[0].present || sample.body.hands[1].present;
}
// The samples in which a hand holds a handle. Without one, nothing is known of the posture.
std::vector<PersonSample> Held(const std::vector<PersonSample>& samples);

}  // namespace predictor::assessment
