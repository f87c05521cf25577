#include "core/stream_sample.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace predictor {

bool IsPlausible(const StreamSample& sample) {
  if (sample.stream >= kMaxStreams || sample.count == 0 || sample.count > kMaxStreamChannels)
    return false;
  const auto good = [](double x) { return std::isnan(x) || std::abs(x) <= kLargestStreamValue; };
  // The comparison is false for NaN.
  return std::abs(sample.clock_offset) <= kLargestClockOffset &&
         std::ranges::all_of(std::span(sample.values).first(sample.count), good);
}

bool IsCredible(const StreamSample& sample, std::uint64_t newest_ns) {
  constexpr auto kLead = static_cast<std::uint64_t>(1e9 * kLongestStreamLead);
  const bool is_near = sample.wall_ns <= newest_ns || sample.wall_ns - newest_ns < kLead;
  return is_near && IsPlausible(sample);
}

}  // namespace predictor
