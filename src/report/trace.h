// Channels of a run over time, in bounded memory and one pass: the lowest and highest value of each
// 50 ms, and every tick of the parts that matter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "report/plot.h"

namespace predictor {

// Why every tick of a part is kept.
struct TraceInterest {
  std::uint64_t tick = 0;
  double before = 5, after = 5;  // kept around it [s]
  int priority = 0;              // the lower first, where not all have room
  std::string why;
};

class Trace {
 public:
  static constexpr double kBin = 0.050;     // of lowest and highest [s]
  static constexpr int kBinsPerBlock = 20;  // parts are kept or not by blocks of a second
  static constexpr double kBefore = 10;     // longest `before` of an interest [s]

  // dt: of a tick [s]; detail: how much is kept with every tick at most [s]. A run that is not
  // longer keeps them all.
  Trace(std::size_t channels, double dt, double detail);

  // Values of all channels, NaN where there is none. Ticks ascend; ones that are missing are gaps.
  // Throws InputError when ticks lie in more seconds than there is memory for: eight hours.
  void Add(std::uint64_t tick, const float* values);
  // Keeps every tick around a place at most kBefore ago. Returns its number.
  std::size_t Keep(TraceInterest interest);
  // The place is elsewhere now: what a worst value was is no longer the worst.
  void Move(std::size_t interest, std::uint64_t tick) { interests_[interest].tick = tick; }
  void Finish();  // throws as Add does

  // After Finish. Times are those of ticks after `origin` [s].
  Samples Times(std::uint64_t origin) const;
  Samples Values(std::size_t channel) const;
  Samples DetailTimes(std::uint64_t origin) const;
  Samples DetailValues(std::size_t channel) const;
  // All ticks of (from, to), with times; as far as they were kept.
  void Part(std::uint64_t from, std::uint64_t to, std::uint64_t origin, std::size_t channel,
            std::vector<double>* times, std::vector<double>* values) const;
  // Interests around which every tick is there, with those that had no room left out.
  std::vector<TraceInterest> Kept() const;
  bool complete() const { return complete_; }  // every tick of the run was kept
  double detail_seconds() const;               // kept with every tick [s]
  double dt() const { return dt_; }

 private:
  struct Block {
    std::uint64_t number = 0;   // of its first tick, in blocks
    std::vector<float> values;  // by channel, then tick
  };
  struct Bins {
    std::uint64_t number = 0;
    std::vector<float> extremes;  // by channel, then bin: two values in their order
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
  std::size_t room_;  // blocks
  bool complete_ = true;
  Block open_;
  bool has_open_ = false;
  std::deque<Block> kept_;
  std::vector<Bins> bins_;
  std::vector<TraceInterest> interests_;
};

}  // namespace predictor
