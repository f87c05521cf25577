// Measurements of other systems during a run: elbows, head, electromyograms, heart rate. The
// evaluation of a recording uses the same rules (AddTracks).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "assessment/measured_emg.h"
#include "assessment/measured_head.h"
#include "core/person_state.h"
#include "core/stream_sample.h"
#include "tracks/stream_track.h"

namespace predictor::assessment {

// A heart rate is a signal with one of these names.
inline constexpr std::array kHeartRateNames = {"heart_rate", "heart rate", "pulse", "HR"};
// A heart rate that is older than this is missing (design choice) [s].
inline constexpr double kOldestHeartRate = 5;

class LiveStreams {
 public:
  // Without streams, nothing is measured. Throws InputError if a mapping does not fit its stream,
  // or if two streams measure the same.
  explicit LiveStreams(std::span<const tracks::StreamDescription> streams = {});

  // Takes the next sample. `newest_ns` is the monotonic clock at the newest tick. Another process
  // sent the sample, so a sample that is not credible is left out.
  void Take(const StreamSample& sample, std::uint64_t newest_ns);
  // Returns whether a sample that may still arrive could belong to the tick with the monotonic
  // clock `tick_ns`, as LiveHead::IsAwaited.
  bool IsAwaited(std::uint64_t tick_ns, std::uint64_t newest_ns) const;

  // Converts the samples that were taken, and forgets those that are too old for an evaluation at
  // the monotonic clock `clock` [s]. Update does this, too. Call this function during a pause.
  void Convert(double clock);
  // Sets the heart rate in `state`. Call this function before the two functions below, with each
  // sample. `clock` is the monotonic clock at the sample [s], and `run_time` the simulated time
  // [s].
  void Update(double clock, double run_time, PersonState* state);
  // Adds the elbows to the sample and, if no headset measured it, the head. Also sets the inputs
  // and the origin of the head in `state`.
  void AddTo(double clock, const PersonSetup& setup, PersonSample* sample, PersonState* state);
  // Returns the activations that electromyograms measured at `clock` [s], and sets the inputs of
  // `state`. They need samples until kEmgSettling later. `run_time` is the simulated time [s].
  std::array<MeasuredActivations, kHands> ActivationsAt(double clock, double run_time,
                                                        PersonState* state);
  bool has_emg() const { return !emg_.empty(); }

  // Returns sentences about streams that contradict their mapping, each sentence once.
  std::vector<std::string> TakeProblems() { return std::exchange(problems_, {}); }

 private:
  struct Stream {
    explicit Stream(tracks::StreamTrack of) : track(std::move(of)) {}
    tracks::StreamTrack track;
    std::uint64_t last_ns = 0;  // newest sample
    bool awaited = false;       // it measures a part of the body or a muscle
    bool failed = false;        // a problem was reported
  };
  // A channel of an electromyogram that cannot be used.
  struct EmgFailure {
    std::optional<double> since;  // monotonic clock [s]
    bool reported = false;
  };
  void AddHead(const tracks::PartTrack& head, double clock, const PersonSetup& setup,
               PersonSample* sample, PersonState* state);
  void AddElbow(const tracks::PartTrack& elbow, std::size_t hand, double clock,
                const PersonSetup& setup, PersonSample* sample, PersonState* state);
  static void AddHeartRate(const tracks::SignalTrack& signal, double clock, double run_time,
                           PersonState* state);
  double ActivationOf(const tracks::EmgTrack& emg, double clock, EmgFailure* failure);

  std::vector<Stream> streams_;
  std::array<PositionCount, kHands> elbows_;
  PositionCount head_;
  std::vector<MeasuredEmg> emg_;          // the channels of all streams; `measured` has one value
  std::vector<EmgFailure> emg_failures_;  // of these channels
  std::vector<std::string> problems_;
};

}  // namespace predictor::assessment
