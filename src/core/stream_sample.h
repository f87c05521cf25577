// A sample of a stream of measurements that another system sends during a run, for example the
// positions of the elbows or a heart rate.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/ring.h"

namespace predictor {

inline constexpr std::size_t kMaxStreams = 8;
inline constexpr std::size_t kMaxStreamChannels = 32;  // of one stream

struct StreamSample {
  std::uint64_t wall_ns = 0;  // monotonic clock of this computer at the sample
  std::uint32_t stream = 0;   // index in the list of the run's streams
  std::uint32_t count = 0;    // number of channels
  double clock_offset = 0;    // that was added to the sender's clock to get this computer's [s]
  std::array<double, kMaxStreamChannels> values{};  // NaN: missing
};

inline constexpr double kLongestStreamDelay = 0.25;  // that the evaluator waits for a sample [s]
inline constexpr double kLongestStreamLead = 1;      // of a sample, ahead of the newest tick [s]
inline constexpr double kLargestStreamValue = 1e12;  // in the unit of the channel
inline constexpr double kLargestClockOffset = 1e12;  // senders may count from 1970 [s]

// Returns whether indices and numbers are within these limits. A value that is missing is NaN. The
// sample may come from another process or from a file.
bool IsPlausible(const StreamSample& sample);
// Returns whether the sample is plausible and at most kLongestStreamLead later than `newest_ns`,
// the monotonic clock at the newest tick.
bool IsCredible(const StreamSample& sample, std::uint64_t newest_ns);

inline constexpr std::size_t kStreamRing = 8192;  // two seconds of two electromyographs
using StreamRing = RingStorage<StreamSample, kStreamRing>;

}  // namespace predictor
