#include "assessment/hand_samples.h"

#include <algorithm>
#include <cmath>

#include "core/norm.h"

namespace predictor::assessment {
namespace {

person::HandSample MeanOf(std::span<const TickRecord> ticks, std::size_t hand) {
  person::HandSample mean;
  const auto n = static_cast<double>(ticks.size());
  double gripping = 0;
  for (const TickRecord& tick : ticks) {
    const HandRecord& h = tick.hands[hand];
    if (!h.present) return mean;
    gripping += h.gripping;
    mean.X_WD.p += FromRecord(h.real.pose).p / n;
    mean.F_D_W += Eigen::Map<const Vector6>(h.wrench.data()) / n;
  }
  mean.X_WD.q = FromRecord(ticks[ticks.size() / 2].hands[hand].real.pose).q;
  mean.present = gripping > n / 2;
  return mean;
}

}  // namespace

PersonSample SampleOf(std::span<const TickRecord> ticks) {
  PersonSample sample;
  sample.body.time = ticks[ticks.size() / 2].run_time;
  for (std::size_t h = 0; h < kHands; ++h) {
    sample.body.hands[h] = MeanOf(ticks, h);
    for (const TickRecord& tick : ticks)
      if (tick.hands[h].present)
        sample.peak_force[h] = std::max(sample.peak_force[h], Norm(tick.hands[h].wrench.data()));
  }
  return sample;
}

std::size_t TicksPerSample(double rate) {
  return static_cast<std::size_t>(std::max(1.0, std::round(rate / kSampleRate)));
}

SampleBuilder::SampleBuilder(const Scenario& scenario)
    : ticks_per_sample_(TicksPerSample(scenario.rate)), dt_(1 / scenario.rate) {
  pending_.reserve(ticks_per_sample_);
}

std::optional<PersonSample> SampleBuilder::Add(const TickRecord& record) {
  if (!start_) {
    start_ = record.tick;
    start_ns_ = record.wall_ns;
  }
  const bool follows = !last_time_ || record.run_time < *last_time_ + 1.5 * dt_;
  if (!record.ran || !follows) {
    // A partial sample is dropped, because it would have a different bandwidth.
    interrupted_ = interrupted_ || last_time_;
    pending_.clear();
  }
  if (!record.ran) return {};
  if (first_.tick == 0) first_ = record;
  last_time_ = record.run_time;
  pending_.push_back(record);
  if (pending_.size() < ticks_per_sample_) return {};
  return Close();
}

PersonSample SampleBuilder::Close() {
  PersonSample sample = SampleOf(pending_);
  const std::size_t middle = pending_.size() / 2;
  sample.recorded = dt_ * static_cast<double>(pending_[middle].tick - *start_);
  const std::uint64_t ns = pending_[middle].wall_ns;
  sample.by_clock = ns > start_ns_ ? 1e-9 * static_cast<double>(ns - start_ns_) : sample.recorded;
  const std::array<bool, kHands> present = {sample.body.hands[0].present,
                                            sample.body.hands[1].present};
  sample.continues = !interrupted_ && (!present_ || *present_ == present);
  present_ = present;
  interrupted_ = false;
  pending_.clear();
  return sample;
}

std::optional<PersonSample> HeldFilter::Take(PersonSample sample) {
  const bool held = IsHeld(sample);
  if (held && gap_) sample.continues = false;
  gap_ = !held;
  if (!held) return {};
  return sample;
}

std::vector<PersonSample> Held(const std::vector<PersonSample>& samples) {
  std::vector<PersonSample> held;
  HeldFilter filter;
  for (const PersonSample& sample : samples)
    if (const auto taken = filter.Take(sample)) held.push_back(*taken);
  return held;
}

}  // namespace predictor::assessment
