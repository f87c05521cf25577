// The measurements of the person in a run, at 100 Hz.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/record.h"
#include "person/body_sample.h"
#include "scenario/scenario.h"

namespace predictor::assessment {

inline constexpr double kSampleRate = 100;  // [Hz]
// At this rate of the ticks [Hz]; at least 1.
std::size_t TicksPerSample(double rate);

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
class SampleBuilder {
 public:
  explicit SampleBuilder(const Scenario& scenario);
  // The sample that this tick completes, if it completes one.
  std::optional<PersonSample> Add(const TickRecord& record);
  // The record of the first tick in RUN; `tick` is 0 before it.
  const TickRecord& first() const { return first_; }

 private:
  PersonSample Close();

  std::uint64_t ticks_per_sample_;
  double dt_;
  TickRecord first_{};
  std::vector<TickRecord> pending_;
  std::optional<double> last_time_;                  // of the last tick in RUN [s]
  std::optional<std::array<bool, kHands>> present_;  // in the sample before
  bool interrupted_ = false;
};

// All samples of a run.
class SampleCollector {
 public:
  explicit SampleCollector(const Scenario& scenario) : builder_(scenario) {}
  void Add(const TickRecord& record) {
    if (stopped_ == StopCause::kNone) stopped_ = record.cause;
    if (const auto sample = builder_.Add(record)) samples_.push_back(*sample);
  }
  const TickRecord& first() const { return builder_.first(); }
  const std::vector<PersonSample>& samples() const { return samples_; }
  // What first stopped the run; kNone: nothing.
  StopCause stopped() const { return stopped_; }

 private:
  SampleBuilder builder_;
  StopCause stopped_ = StopCause::kNone;
  std::vector<PersonSample> samples_;
};

inline bool IsHeld(const PersonSample& sample) {
  return sample.body.hands[0].present || sample.body.hands[1].present;
}

// Passes on the samples in which a hand holds a handle. Without one, nothing is known of the
// posture.
class HeldFilter {
 public:
  std::optional<PersonSample> Take(PersonSample sample);

 private:
  bool gap_ = false;  // since the last sample that was passed on
};
std::vector<PersonSample> Held(const std::vector<PersonSample>& samples);

}  // namespace predictor::assessment
