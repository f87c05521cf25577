#include "assessment/safety/stop_loads.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "assessment/person_chain.h"

namespace predictor::assessment {
namespace {

using person::ArmJoint;

constexpr std::size_t kStopStride = 2;  // samples between two evaluations of all possible people

std::size_t SamplesIn(double time) {
  return static_cast<std::size_t>(std::lround(time * kSampleRate));
}

std::string LabelOf(int joint) {
  std::string label = person::JointName(joint);
  std::ranges::replace(label, '_', ' ');
  return label;
}

// The largest magnitudes of the joint's torque and of the change in this torque since the decision
// to stop.
struct Peaks {
  double torque = 0, change = 0;
};
template <class LoadsAt>
Peaks PeaksOf(int joint, std::size_t decided, std::size_t end, const LoadsAt& loads_at) {
  const double before = loads_at(decided - 1).torque[joint];
  Peaks peaks;
  for (std::size_t i = decided; i < end; ++i) {
    const double torque = loads_at(i).torque[joint];
    peaks.torque = std::max(peaks.torque, std::abs(torque));
    peaks.change = std::max(peaks.change, std::abs(torque - before));
  }
  return peaks;
}

std::optional<double> UseOf(int hand, ArmJoint joint, std::span<const Frame> stopping) {
  const auto h = static_cast<std::size_t>(hand);
  double use = 0;
  for (const Frame& frame : stopping) {
    if (joint == ArmJoint::kShoulderFlexion)
      use = std::max(use, frame.shoulder_use[h]);
    else if (joint == ArmJoint::kElbowFlexion)
      use = std::max(use, frame.elbow_use[h]);
    else
      return {};
  }
  return use;
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
  SampledChain sampled;
  if (intervals) sampled = RunSampled(setup, samples, nominal, kStopStride, work, [](double) {});
  const auto first =
      static_cast<std::size_t>(std::ranges::lower_bound(sampled.at, decided) - sampled.at.begin());
  for (int hand = 0; hand < kHands; ++hand) {
    if (!samples[decided - 1].body.hands[static_cast<std::size_t>(hand)].present) continue;
    for (int k = 0; k < person::kArmJoints; ++k) {
      const auto kind = static_cast<ArmJoint>(k);
      const int joint = person::Of(hand, kind);
      const Peaks peaks = PeaksOf(
          joint, decided,
          end, [&](std::size_t i) -> const auto& { return nominal.frames[i].loads; });
      StopLoad load{.joint = LabelOf(joint),
                    .before = nominal.frames[decided - 1].loads.torque[joint],
                    .peak = peaks.torque,
                    .change = peaks.change,
                    .use = UseOf(hand, kind, std::span(nominal.frames).subspan(decided))};
      if (first >= 1 && first < sampled.at.size()) {
        std::vector<double> changes;
        for (std::size_t p = 0; p < sampled.frames[0].size(); ++p)
          changes.push_back(
              PeaksOf(
                  joint, first, sampled.at.size(),
                  [&](std::size_t i) -> const auto& { return sampled.frames[i][p].loads; })
                  .change);
        load.change_90 = person::IntervalOf(changes);
      }
      judgement.loads.push_back(std::move(load));
    }
  }
  return judgement;
}

}  // namespace predictor::assessment
