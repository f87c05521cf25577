#include "assessment/live_chain.h"

namespace predictor::assessment {

void LiveChain::Add(const PersonSample& sample) {
  Forget();
  samples_.push_back(sample);
  postures_.push_back(person_.Solve(sample));
}

// Drops samples that are no longer needed. Dropping samples moves the remaining samples, so it
// happens only occasionally.
void LiveChain::Forget() {
  if (next_ < 4 * kLiveHistory) return;
  const auto dropped = static_cast<std::ptrdiff_t>(next_ - kLiveHistory);
  samples_.erase(samples_.begin(), samples_.begin() + dropped);
  postures_.erase(postures_.begin(), postures_.begin() + dropped);
  next_ = kLiveHistory;
}

bool LiveChain::Next(bool all, JudgedSample* judged) {
  const std::size_t known = samples_.size();
  if (next_ >= known) return false;
  std::size_t end = next_ + 1;  // end of the uninterrupted part
  while (end < known && samples_[end].continues) ++end;
  if (!all && end == known && next_ + delay_ >= known) return false;
  std::size_t begin = next_;
  while (begin > 0 && next_ - begin < kLiveHistory && samples_[begin].continues) --begin;
  std::vector<person::BodyVector> q;
  for (std::size_t i = begin; i < end; ++i) q.push_back(postures_[i].q);
  judged->sample = samples_[next_];
  judged->force_rate = ForceRates(samples_, next_);
  judged->motion = MotionsOfPart(q)[next_ - begin];
  judged->frame =
      person_.Judge({judged->sample.body, judged->force_rate}, judged->motion, postures_[next_]);
  muscles_.Add(judged->sample.body, judged->motion, &judged->frame,
               measured_ ? measured_(judged->sample) : std::array<MeasuredActivations, kHands>{});
  ++next_;
  return true;
}

}  // namespace predictor::assessment
