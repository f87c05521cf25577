// Stores channels of a run over time, in bounded memory and in one pass. A trace keeps the lowest
// and the highest value of each interval of 50 ms, and every tick of the important parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "report/plot.h"

namespace predictor {

// A reason to keep every tick of a part of the run.
struct TraceInterest {
  std::uint64_t tick = 0;
  double before = 5, after = 5;  // time kept before and after it [s]
  int priority = 0;              // lower values first, if there is not enough room
  std::string why;
};

class Trace {
 public:
  static constexpr double kBin = 0.050;  // time over which lowest and highest values are kept [s]
  static constexpr int kBinsPerBlock = 20;  // parts are kept or discarded in blocks of one second
  static constexpr double kBefore = 10;     // longest `before` of an interest [s]

  // `dt` is the duration of a tick [s]. `detail` is the longest time for which every tick is kept
  // [s]. A run of at most this length is kept completely.
  Trace(std::size_t channels, double dt, double detail);

  // Adds a tick with one value for each channel. The value is NaN if the channel has none. The
  // numbers of the ticks must ascend. Missing ticks become gaps. Throws InputError if the ticks
  // cover more time than memory allows (eight hours).
  void Add(std::uint64_t tick, const float* values);
  // Keeps every tick near a given time, which may be at most kBefore in the past. Returns the
  // interest's number.
  std::size_t Keep(TraceInterest interest);
  // Moves an interest to another time, for example when a new worst value replaces the old one.
  void Move(std::size_t interest, std::uint64_t tick) { interests_[interest].tick = tick; }
  void Finish();  // throws like Add

  // Call this after Finish. Times are relative to the tick `origin` [s].
  Samples Times(std::uint64_t origin) const;
  Samples Values(std::size_t channel) const;
  Samples DetailTimes(std::uint64_t origin) const;
  Samples DetailValues(std::size_t channel) const;
  // Returns the ticks in (from, to) that were kept, with their times.
  void Part(std::uint64_t from, std::uint64_t to, std::uint64_t origin, std::size_t channel,
            std::vector<double>* times, std::vector<double>* values) const;
  // Returns the interests for which every tick was kept. Interests for which there was no room are
  // omitted.
  std::vector<TraceInterest> Kept() const;
  bool complete() const { return complete_; }  // every tick of the run was kept
  double detail_seconds() const;               // total time kept with every tick [s]
  double dt() const { return dt_; }

 private:
  struct Block {
    std::uint64_t number = 0;   // number of the block
    std::vector<float> values;  // by channel, then tick
  };
  struct Bins {
    std::uint64_t number = 0;
    std::vector<float> extremes;  // by channel, then bin: two values in order of occurrence
  };
  void Close();
  void Prune();
  std::vector<std::uint64_t> Wanted(std::size_t room) const;
  bool Gap(std::size_t i) const { return i > 0 && bins_[i].number != bins_[i - 1].number + 1; }
  const Block* Find(std::uint64_t number) const;
  void Range(const TraceInterest& interest, std::uint64_t* first, std::uint64_t* last) const;

  std::size_t channels_;
  double dt_;
  std::uint64_t bin_ticks_, block_ticks_;
  std::size_t room_;  // room for detailed ticks [blocks]
  bool complete_ = true;
  Block open_;
  bool has_open_ = false;
  std::deque<Block> kept_;
  std::vector<Bins> bins_;
  std::vector<TraceInterest> interests_;
};

}  // namespace predictor
