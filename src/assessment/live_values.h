// Converts frames to the numbers of the person's state: gauges, scores, intervals, warnings.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "assessment/live_chain.h"
#include "core/person_state.h"

namespace predictor::assessment {

// Writes the gauges, scores and loads of the nominal person into `state`, and leaves the intervals
// unchanged.
void WriteFrame(const JudgedSample& judged, PersonState* state);

// Writes intervals and probabilities from the frames of all possible people.
void WriteIntervals(std::span<const Frame> frames, const PersonSample& sample, PersonState* state);
// Sets all values that WriteFrame and WriteIntervals write to unknown. Elbows and electromyograms,
// which are only read while a posture is evaluated, are then missing.
void ForgetValues(PersonState* state);

// Evaluates the possible people a few at a time, so that the evaluation of the nominal person is
// never delayed.
class LiveIntervals {
 public:
  LiveIntervals(const PersonSetup& setup, const WorkPattern& work);
  // Call this function with each judged sample. Every kSampledStride-th sample is evaluated for all
  // people. Writes the results when all people have been evaluated.
  void Add(const JudgedSample& judged, PersonState* state);

 private:
  PersonSetup setup_;
  WorkPattern work_;
  person::PostureSampler sampler_;
  std::size_t count_ = 0;
  std::optional<JudgedSample> current_;
  std::vector<Frame> frames_;  // frames of the people evaluated so far
};

// Computes the warnings. A hysteresis, and a delay for each direction, prevent flicker.
class WarningKeeper {
 public:
  // Returns the bits of PersonState::warnings. `time` is the simulated time [s] of the judged
  // sample.
  std::uint16_t Update(const Frame& frame, double time);
  void Clear() { *this = {}; }

 private:
  struct Entry {
    bool on = false;
    std::optional<double> since;  // time since which the value has required the opposite state [s]
  };
  std::array<Entry, kPersonWarnings> entries_;
};

}  // namespace predictor::assessment
