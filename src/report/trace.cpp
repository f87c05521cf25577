#include "report/trace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"

namespace predictor {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
// The maximum number of interests, around which every tick is kept. Without this limit, a recording
// with a thousand markers would cause a thousand searches per second.
constexpr std::size_t kMaxInterests = 64;
// The maximum number of blocks whose lowest and highest values are kept (350 MB for all channels).
// The blocks cover eight hours if no ticks are missing. A hostile recording may have a single tick
// in each block.
constexpr std::size_t kMaxBlocks = 8 * 3600;

// Writes the lowest and highest of n values, in order of occurrence.
void Extremes(const float* values, std::size_t n, float* two) {
  std::size_t low = n, high = n;
  for (std::size_t i = 0; i < n; ++i) {
    if (std::isnan(values[i])) continue;
    if (low == n || values[i] < values[low]) low = i;
    if (high == n || values[i] > values[high]) high = i;
  }
  two[0] = low == n ? kNone : values[std::min(low, high)];
  two[1] = low == n ? kNone : values[std::max(low, high)];
}

}  // namespace

Trace::Trace(std::size_t channels, double dt, double detail)
    : channels_(channels),
      dt_(dt),
      bin_ticks_(static_cast<std::uint64_t>(std::max(1L, std::lround(kBin / dt)))),
      block_ticks_(bin_ticks_ * kBinsPerBlock),
      room_(
          static_cast<std::size_t>(std::ceil(detail / (static_cast<double>(block_ticks_) * dt)))) {}

void Trace::Add(std::uint64_t tick, const float* values) {
  const std::uint64_t number = tick / block_ticks_;
  if (has_open_ && number != open_.number) Close();
  if (!has_open_) {
    open_.number = number;
    open_.values.assign(channels_ * block_ticks_, kNone);
    has_open_ = true;
  }
  float* to = open_.values.data() + tick % block_ticks_;
  for (std::size_t c = 0; c < channels_; ++c) to[c * block_ticks_] = values[c];
}

void Trace::Close() {
  if (bins_.size() == kMaxBlocks)
    throw InputError(
        "The recording has ticks in more than " + std::to_string(kMaxBlocks) +
        " seconds (eight hours), which is more than a report can show. View the recording with "
        "`predictor replay`, or export channels with `predictor export data`.");
  Bins bins{open_.number, std::vector<float>(channels_ * 2 * kBinsPerBlock)};
  for (std::size_t c = 0; c < channels_; ++c)
    for (std::size_t b = 0; b < kBinsPerBlock; ++b)
      Extremes(open_.values.data() + c * block_ticks_ + b * bin_ticks_, bin_ticks_,
               bins.extremes.data() + 2 * (c * kBinsPerBlock + b));
  bins_.push_back(std::move(bins));
  kept_.push_back(std::move(open_));
  open_ = Block();
  has_open_ = false;
  if (kept_.size() > room_) Prune();
}

std::size_t Trace::Keep(TraceInterest interest) {
  if (interests_.size() == kMaxInterests) interests_.pop_back();
  interests_.push_back(std::move(interest));
  return interests_.size() - 1;
}

void Trace::Range(const TraceInterest& interest, std::uint64_t* first, std::uint64_t* last) const {
  const auto before = static_cast<std::uint64_t>(interest.before / dt_);
  const auto after = static_cast<std::uint64_t>(interest.after / dt_);
  *first = (interest.tick > before ? interest.tick - before : 0) / block_ticks_;
  *last = (interest.tick + after) / block_ticks_;
}

// Returns the numbers of the blocks around the interests in ascending order, up to the largest
// number of blocks for which there is room.
std::vector<std::uint64_t> Trace::Wanted(std::size_t room) const {
  std::vector<const TraceInterest*> order;
  for (const TraceInterest& interest : interests_) order.push_back(&interest);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto* a, const auto* b) { return a->priority < b->priority; });
  std::vector<std::uint64_t> wanted;
  for (const TraceInterest* interest : order) {
    std::uint64_t first = 0, last = 0;
    Range(*interest, &first, &last);
    std::vector<std::uint64_t> with = wanted;
    for (std::uint64_t n = first; n <= last; ++n)
      if (!std::binary_search(wanted.begin(), wanted.end(), n)) with.push_back(n);
    if (with.size() > room) continue;
    std::sort(with.begin(), with.end());
    wanted = std::move(with);
  }
  return wanted;
}

// Recent blocks are kept, because a later event may need the ticks in these blocks.
void Trace::Prune() {
  complete_ = false;
  const std::vector<std::uint64_t> wanted = Wanted(room_);
  const auto recent =
      static_cast<std::uint64_t>(std::ceil(kBefore / (static_cast<double>(block_ticks_) * dt_)));
  const std::uint64_t newest = kept_.back().number;
  std::erase_if(kept_, [&](const Block& block) {
    return block.number + recent < newest &&
           !std::binary_search(wanted.begin(), wanted.end(), block.number);
  });
}

void Trace::Finish() {
  if (has_open_) Close();
  if (complete_) return;
  const std::vector<std::uint64_t> wanted = Wanted(room_);
  std::erase_if(kept_, [&](const Block& block) {
    return !std::binary_search(wanted.begin(), wanted.end(), block.number);
  });
}

const Trace::Block* Trace::Find(std::uint64_t number) const {
  const auto it =
      std::lower_bound(kept_.begin(), kept_.end(), number,
                       [](const Block& block, std::uint64_t n) { return block.number < n; });
  return it != kept_.end() && it->number == number ? &*it : nullptr;
}

Samples Trace::Times(std::uint64_t origin) const {
  std::vector<double> times;
  times.reserve(bins_.size() * (2 * kBinsPerBlock + 1));
  const double bin = static_cast<double>(bin_ticks_) * dt_;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    const double start =
        (static_cast<double>(bins_[i].number * block_ticks_) - static_cast<double>(origin)) * dt_;
    if (Gap(i)) times.push_back(start);
    for (int b = 0; b < 2 * kBinsPerBlock; ++b) times.push_back(start + (b + 0.5) * bin / 2);
  }
  return MakeSamples(std::move(times));
}

Samples Trace::Values(std::size_t channel) const {
  std::vector<double> values;
  values.reserve(bins_.size() * (2 * kBinsPerBlock + 1));
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    if (Gap(i)) values.push_back(kNothing);
    const float* from = bins_[i].extremes.data() + 2 * channel * kBinsPerBlock;
    values.insert(values.end(), from, from + 2 * kBinsPerBlock);
  }
  return MakeSamples(std::move(values));
}

Samples Trace::DetailTimes(std::uint64_t origin) const {
  std::vector<double> times;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    const double start =
        (static_cast<double>(kept_[i].number * block_ticks_) - static_cast<double>(origin)) * dt_;
    if (i > 0 && kept_[i].number != kept_[i - 1].number + 1) times.push_back(start - dt_ / 2);
    for (std::uint64_t k = 0; k < block_ticks_; ++k)
      times.push_back(start + static_cast<double>(k) * dt_);
  }
  return MakeSamples(std::move(times));
}

Samples Trace::DetailValues(std::size_t channel) const {
  std::vector<double> values;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (i > 0 && kept_[i].number != kept_[i - 1].number + 1) values.push_back(kNothing);
    const float* from = kept_[i].values.data() + channel * block_ticks_;
    values.insert(values.end(), from, from + block_ticks_);
  }
  return MakeSamples(std::move(values));
}

void Trace::Part(std::uint64_t from, std::uint64_t to, std::uint64_t origin, std::size_t channel,
                 std::vector<double>* times, std::vector<double>* values) const {
  for (std::uint64_t n = from / block_ticks_; n <= to / block_ticks_; ++n) {
    const Block* block = Find(n);
    if (!block) continue;
    for (std::uint64_t k = 0; k < block_ticks_; ++k) {
      const std::uint64_t tick = n * block_ticks_ + k;
      if (tick < from || tick > to) continue;
      times->push_back((static_cast<double>(tick) - static_cast<double>(origin)) * dt_);
      values->push_back(static_cast<double>(block->values[channel * block_ticks_ + k]));
    }
  }
}

std::vector<TraceInterest> Trace::Kept() const {
  std::vector<TraceInterest> kept;
  for (const TraceInterest& interest : interests_)
    if (Find(interest.tick / block_ticks_)) kept.push_back(interest);
  return kept;
}

double Trace::detail_seconds() const {
  return static_cast<double>(kept_.size() * block_ticks_) * dt_;
}

}  // namespace predictor
