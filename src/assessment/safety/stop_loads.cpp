#include "assessment/safety/stop_loads.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "assessment/person_chain.h"

namespace predictor::assessment {
namespace {

using person::ArmJoint;

std::size_t SamplesIn(double time) {
  return static_cast<std::size_t>(std::lround(time * kSampleRate));
}

std::string LabelOf(int joint) {
  std::string label = person::JointName(joint);
  std::ranges::replace(label, '_', ' ');
  return label;
}

// The largest magnitude of the joint's torque since the decision to stop, and the change in this
// torque that has the largest magnitude. Neither is a number if the torque is unknown at any time.
struct Peaks {
  double torque = 0, change = 0;
};
template <class TorqueAt>
Peaks PeaksOf(std::size_t decided, std::size_t end, const TorqueAt& torque_at) {
  const double before = torque_at(decided - 1);
  Peaks peaks;
  for (std::size_t i = decided; i < end; ++i) {
    const double change = torque_at(i) - before;
    if (!std::isfinite(change)) return {kUnknownValue, kUnknownValue};
    peaks.torque = std::max(peaks.torque, std::abs(torque_at(i)));
    if (std::abs(change) > std::abs(peaks.change)) peaks.change = change;
  }
  return peaks;
}

std::optional<double> UseOf(int hand, ArmJoint joint, std::span<const Frame> stopping) {
  const auto h = static_cast<std::size_t>(hand);
  if (joint != ArmJoint::kShoulderFlexion && joint != ArmJoint::kElbowFlexion) return {};
  double most = 0;
  for (const Frame& frame : stopping) {
    const double use =
        joint == ArmJoint::kShoulderFlexion ? frame.shoulder_use[h] : frame.elbow_use[h];
    if (!std::isfinite(use)) return {};
    most = std::max(most, use);
  }
  return most;
}

// Returns the change for each possible person.
std::vector<double> ChangesOfPeople(const SampledChain& sampled, std::size_t decided, int hand,
                                    ArmJoint joint) {
  std::vector<double> changes;
  for (std::size_t p = 0; p < sampled.frames[0].size(); ++p)
    changes.push_back(PeaksOf(decided, sampled.at.size(), [&](std::size_t i) {
                        return TorqueOf(sampled.frames[i][p], hand, joint);
                      }).change);
  return changes;
}

}  // namespace

StopWindows::StopWindows(const Scenario& scenario)
    : ticks_a_sample_(TicksPerSample(scenario.rate)), log_(scenario) {}

void StopWindows::Add(const TickRecord& record) {
  log_.Add(record);
  const std::size_t before = SamplesIn(kBefore) * ticks_a_sample_;
  const std::size_t longest = SamplesIn(kLongest) * ticks_a_sample_;
  if (log_.count() > stops_ && cuts_.size() < kMaxCuts && cuts_.size() < log_.stops().size()) {
    if (!cuts_.empty()) cuts_.back().open = false;
    cuts_.push_back({.ticks = {recent_.begin(), recent_.end()}, .decided = recent_.size()});
  }
  stops_ = log_.count();
  if (!cuts_.empty() && cuts_.back().open) {
    Cut& cut = cuts_.back();
    cut.ticks.push_back(record);
    cut.after = record.state == RunState::kStopping ? 0 : cut.after + 1;
    cut.open = cut.ticks.size() < longest && cut.after < SamplesIn(kAfter) * ticks_a_sample_;
  }
  if (recent_.size() == before) recent_.pop_front();
  recent_.push_back(record);
}

StopWindow StopWindows::WindowOf(const Cut& cut, const StopSummary& stop) const {
  StopWindow window;
  window.stop = stop;
  std::vector<TickRecord> ticks = cut.ticks;
  for (std::size_t i = cut.decided; i < ticks.size(); ++i)
    for (std::size_t h = 0; h < kHands; ++h)
      ticks[i].hands[h].gripping = ticks[cut.decided].hands[h].gripping;
  // Shifts the samples so that one sample begins at the decision to stop.
  std::size_t begin = cut.decided % ticks_a_sample_;
  window.decided = (cut.decided - begin) / ticks_a_sample_;
  for (; begin + ticks_a_sample_ <= ticks.size(); begin += ticks_a_sample_) {
    PersonSample sample = SampleOf(std::span(ticks).subspan(begin, ticks_a_sample_));
    sample.body.time = static_cast<double>(window.samples.size()) / kSampleRate;
    window.samples.push_back(sample);
  }
  return window;
}

std::vector<StopWindow> StopWindows::windows() const {
  std::vector<StopWindow> windows;
  for (std::size_t i = 0; i < cuts_.size(); ++i)
    windows.push_back(WindowOf(cuts_[i], log_.stops()[i]));
  return windows;
}

StopJudgement JudgeStop(const PersonSetup& setup, const StopWindow& window, bool intervals) {
  StopJudgement judgement;
  judgement.stop = window.stop;
  const std::span<const PersonSample> samples = window.samples;
  const std::size_t decided = window.decided, end = samples.size();
  if (decided < 1 || decided >= end) return judgement;
  WorkPattern work;
  work.strength = setup.body.strength;
  const NominalChain nominal = RunNominal(setup, samples, work, [](double) {});
  // The people are evaluated at every sample, because the reference is the last sample before the
  // decision, and the force changes within a few samples.
  SampledChain sampled;
  if (intervals) sampled = RunSampled(setup, samples, nominal, 1, work, [](double) {});
  for (int hand = 0; hand < kHands; ++hand) {
    if (!samples[decided - 1].body.hands[static_cast<std::size_t>(hand)].present) continue;
    for (int k = 0; k < person::kArmJoints; ++k) {
      const auto kind = static_cast<ArmJoint>(k);
      const Peaks peaks = PeaksOf(
          decided, end, [&](std::size_t i) { return TorqueOf(nominal.frames[i], hand, kind); });
      StopLoad load{.joint = LabelOf(person::Of(hand, kind)),
                    .before = TorqueOf(nominal.frames[decided - 1], hand, kind),
                    .peak = peaks.torque,
                    .change = peaks.change,
                    .use = UseOf(hand, kind, std::span(nominal.frames).subspan(decided))};
      if (intervals && std::isfinite(load.change))
        load.change_90 = IntervalOfKnown(ChangesOfPeople(sampled, decided, hand, kind));
      judgement.loads.push_back(std::move(load));
    }
  }
  return judgement;
}

}  // namespace predictor::assessment
