#include "assessment/live_values.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "assessment/picture.h"
#include "assessment/quantities.h"

namespace predictor::assessment {
namespace {

// Tables of how each value of PersonState follows from a frame, in the order of the enumerations.
using GaugeValue = double (*)(const Moment&);

constexpr std::array<GaugeValue, kPersonGauges> kGaugeValues = {
    [](const Moment& m) { return m.frame.loads.l5s1.compression; },
    [](const Moment& m) { return m.frame.loads.l5s1.shear; },
    [](const Moment& m) { return m.frame.loads.l5s1.flexion_moment; },
    [](const Moment& m) { return m.frame.loads.balance.margin; },
    [](const Moment& m) { return m.frame.angles.trunk_flexion; },
    [](const Moment& m) { return m.frame.shoulder_use[0]; },
    [](const Moment& m) { return m.frame.shoulder_use[1]; },
    [](const Moment& m) { return m.frame.elbow_use[0]; },
    [](const Moment& m) { return m.frame.elbow_use[1]; },
    [](const Moment& m) { return m.sample.body.hands[0].F_D_W.head<3>().norm(); },
    [](const Moment& m) { return m.sample.body.hands[1].F_D_W.head<3>().norm(); },
    [](const Moment& m) { return m.frame.muscles[0].values[kLargestActivation]; },
    [](const Moment& m) { return m.frame.muscles[1].values[kLargestActivation]; },
    [](const Moment& m) { return m.frame.muscles[0].values[kSoftest]; },
    [](const Moment& m) { return m.frame.muscles[1].values[kSoftest]; },
};
constexpr std::array<double (*)(const Frame&), kPersonWarnings> kWarningValues = {
    [](const Frame& f) { return f.loads.l5s1.compression; },
    [](const Frame& f) { return f.loads.l5s1.shear; },
    [](const Frame& f) { return f.loads.balance.margin; },
    [](const Frame& f) { return f.shoulder_use[0]; },
    [](const Frame& f) { return f.shoulder_use[1]; },
    [](const Frame& f) { return f.elbow_use[0]; },
    [](const Frame& f) { return f.elbow_use[1]; },
    [](const Frame& f) { return static_cast<double>(f.rula.action.level); },
    [](const Frame& f) { return static_cast<double>(f.reba.action.level); },
    [](const Frame& f) { return static_cast<double>(f.owas.action.level); },
    [](const Frame& f) { return f.reached ? 0.0 : 1.0; },
};

// Returns whether the given hand holds a handle. For −1, which stands for neither hand, returns
// true.
bool IsPresent(int hand, const PersonSample& sample) {
  return hand < 0 || sample.body.hands[static_cast<std::size_t>(hand)].present;
}

ScoreState ScoreOf(std::size_t kind, const Frame& frame) {
  const WorksheetKind& worksheet = Worksheets()[kind];
  ScoreState state;
  state.score = static_cast<std::uint8_t>(worksheet.of(frame));
  if (state.score > 0) state.level = static_cast<std::uint8_t>(worksheet.action(state.score).level);
  return state;
}

}  // namespace

void WriteFrame(const JudgedSample& judged, PersonState* state) {
  const Moment moment{judged.frame, judged.sample};
  for (std::size_t i = 0; i < kPersonGauges; ++i)
    state->gauges[i].value = IsPresent(kPersonGaugeRows[i].hand, judged.sample)
                                 ? static_cast<float>(kGaugeValues[i](moment))
                                 : kUnknown;
  const PartLoads loads = LoadsOf(judged.frame);
  for (std::size_t i = 0; i < kBodyParts; ++i) {
    const int hand = KindOf(static_cast<BodyPart>(i)).hand;
    state->parts[i].load = IsPresent(hand, judged.sample) ? static_cast<float>(loads[i]) : kUnknown;
  }
  for (std::size_t i = 0; i < kPersonScores; ++i) {
    const auto probability = state->scores[i].probability;
    state->scores[i] = ScoreOf(i, judged.frame);
    state->scores[i].probability = probability;
  }
}

void WriteIntervals(std::span<const Frame> frames, const PersonSample& sample, PersonState* state) {
  for (std::size_t i = 0; i < kPersonGauges; ++i) {
    GaugeState& gauge = state->gauges[i];
    gauge.low = gauge.high = kUnknown;
    if (kPersonGaugeRows[i].source != GaugeSource::kModelled ||
        !IsPresent(kPersonGaugeRows[i].hand, sample))
      continue;
    std::vector<double> values;
    for (const Frame& frame : frames) values.push_back(kGaugeValues[i]({frame, sample}));
    const std::optional<person::Interval> interval = IntervalOfKnown(std::move(values));
    if (!interval) continue;
    gauge.low = static_cast<float>(interval->low);
    gauge.high = static_cast<float>(interval->high);
  }
  const auto known = std::ranges::count_if(frames, [](const Frame& f) { return f.known; });
  for (std::size_t i = 0; i < kPersonScores; ++i) {
    auto& probability = state->scores[i].probability;
    probability.fill(known > 0 ? 0 : kUnknown);
    for (const Frame& frame : frames)
      if (const std::size_t level = ScoreOf(i, frame).level; level > 0)
        probability[level - 1] += 1.0F / static_cast<float>(known);
  }
  const auto reached = std::ranges::count_if(frames, [](const Frame& f) { return f.reached; });
  state->sampled_reached = static_cast<float>(reached) / static_cast<float>(frames.size());
}

void ForgetValues(PersonState* state) {
  state->gauges = {};
  state->scores = {};
  for (PartState& part : state->parts) part.load = kUnknown;
  state->sampled_reached = kUnknown;
  state->head = HeadSource::kModelled;
  state->reached = 0;
  state->miss = 0;
  state->warnings = 0;
  using enum PersonInput;
  for (const PersonInput input : {kLeftElbow, kRightElbow, kLeftEmg, kRightEmg}) {
    InputStatus& status = state->inputs[static_cast<std::size_t>(input)].status;
    if (status != InputStatus::kNone) status = InputStatus::kMissing;
  }
}

LiveIntervals::LiveIntervals(const PersonSetup& setup, const WorkPattern& work)
    : setup_(setup), work_(work), sampler_(setup.body, setup.stance, setup.grips) {}

void LiveIntervals::Add(const JudgedSample& judged, PersonState* state) {
  constexpr std::size_t kAtOnce = 4;  // people that are evaluated at once, before the next ones
  static_assert(kAtOnce * kSampledStride >= person::kPostureSamples);
  if (count_++ % kSampledStride == 0) {
    current_ = judged;
    frames_.clear();
  }
  if (!current_) return;
  const FrameInput input{current_->sample.body, current_->force_rate};
  for (std::size_t n = 0; n < kAtOnce && frames_.size() < person::kPostureSamples; ++n) {
    const person::SampledPosture one =
        sampler_.EvaluatePerson(frames_.size(), input.sample, current_->motion);
    frames_.push_back(FrameOfPerson(one, input, setup_.body.sex, work_));
  }
  if (frames_.size() < person::kPostureSamples) return;
  WriteIntervals(frames_, current_->sample, state);
  state->interval_time = current_->sample.body.time;
  current_.reset();
}

std::uint16_t WarningKeeper::Update(const Frame& frame, double time) {
  constexpr double kRounding = 1e-6;  // [s]
  std::uint16_t bits = 0;
  for (std::size_t i = 0; i < kPersonWarnings; ++i) {
    const PersonWarningRow& row = kPersonWarningRows[i];
    Entry& entry = entries_[i];
    const double value = kWarningValues[i](frame);
    const bool low_is_bad = row.on < row.off;
    const bool beyond = low_is_bad ? value <= row.on : value >= row.on;
    const bool calm = !std::isfinite(value) || (low_is_bad ? value >= row.off : value <= row.off);
    if (entry.on ? calm : beyond) {
      if (!entry.since) entry.since = time;
      if (time - *entry.since > (entry.on ? kCalmAfter : kWarnAfter) - kRounding) {
        entry.on = !entry.on;
        entry.since.reset();
      }
    } else {
      entry.since.reset();
    }
    if (entry.on) bits = static_cast<std::uint16_t>(bits | 1U << i);
  }
  return bits;
}

}  // namespace predictor::assessment
