// The measurements of the person during a run, at 100 Hz.
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
// Returns the number of ticks per sample for the given tick rate [Hz], which is at least 1.
std::size_t TicksPerSample(double rate);

struct PersonSample {
  person::BodySample body;
  double recorded = 0;  // time since the first tick of the recording, from the number of ticks [s]
  double by_clock = 0;  // the same by the monotonic clock, which includes missed ticks [s]
  std::array<double, kHands> peak_force = {};  // largest over the ticks of the sample [N]
  // The value is false if, immediately before this sample, simulated time was paused, ticks were
  // lost, or a hand gripped or let go.
  bool continues = true;
};

// Makes one sample from successive ticks. The sample contains the means of position and wrench, and
// the orientation at the middle tick. A hand is present if it grips in most of the ticks.
PersonSample SampleOf(std::span<const TickRecord> ticks);

// Builds a sample from every 10 ms of ticks (see SampleOf). The builder uses only ticks in RUN.
class SampleBuilder {
 public:
  explicit SampleBuilder(const Scenario& scenario);
  // Returns the sample that this tick completes, if any.
  std::optional<PersonSample> Add(const TickRecord& record);
  // Returns the record of the first tick in RUN. Before the first tick in RUN, the `tick` of this
  // record is 0.
  const TickRecord& first() const { return first_; }
  // Returns the monotonic clock at the first tick of the recording [ns].
  std::uint64_t start_ns() const { return start_ns_; }

 private:
  PersonSample Close();

  std::uint64_t ticks_per_sample_;
  double dt_;
  std::optional<std::uint64_t> start_;  // first tick of the recording
  std::uint64_t start_ns_ = 0;
  TickRecord first_{};
  std::vector<TickRecord> pending_;
  std::optional<double> last_time_;                  // time of the last tick in RUN [s]
  std::optional<std::array<bool, kHands>> present_;  // hands present in the previous sample
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
  // Returns the cause that first stopped the run, or kNone if it was not stopped.
  StopCause stopped() const { return stopped_; }

 private:
  SampleBuilder builder_;
  StopCause stopped_ = StopCause::kNone;
  std::vector<PersonSample> samples_;
};

inline bool IsHeld(const PersonSample& sample) {
  return sample.body.hands[0].present || sample.body.hands[1].present;
}

// Passes on only the samples in which a hand holds a handle. While no hand holds a handle, the
// posture is unknown.
class HeldFilter {
 public:
  std::optional<PersonSample> Take(PersonSample sample);

 private:
  bool gap_ = false;  // whether samples were dropped since the last one that was passed on
};
std::vector<PersonSample> Held(const std::vector<PersonSample>& samples);

}  // namespace predictor::assessment
