#include "assessment/live_exposure.h"

#include <algorithm>
#include <cmath>

#include "assessment/hand_samples.h"

namespace predictor::assessment {
namespace {

// Limits the memory that a run of unlimited duration needs.
constexpr auto kMaxSamples = static_cast<std::size_t>(ergonomics::kShift * kSampleRate);

}  // namespace

double LiveExposure::Gaps::Fill(double load) {
  ++count_;
  if (std::isfinite(load))
    last_ = load;
  else
    ++unknown_;
  return last_;
}

bool LiveExposure::Gaps::TooLong() const {
  return static_cast<double>(unknown_) > kMaxUnknownShare * static_cast<double>(count_);
}

LiveExposure::LiveExposure(const Scenario& scenario) {
  Part& back = parts_[static_cast<std::size_t>(BodyPart::kLowerBack)];
  back.tool = &ergonomics::kLiftTool;
  for (int hand = 0; hand < kHands; ++hand) {
    if (!scenario.Has(hand)) continue;
    const auto h = static_cast<std::size_t>(hand);
    Part& shoulder = parts_[static_cast<std::size_t>(BodyPart::kLeftShoulder) + h];
    shoulder.fatigue.emplace(ergonomics::FatigueJoint::kShoulder);
    shoulder.tool = &ergonomics::kShoulderTool;
    parts_[static_cast<std::size_t>(BodyPart::kLeftElbow) + h].fatigue.emplace(
        ergonomics::FatigueJoint::kElbow);
  }
}

void LiveExposure::Add(const Frame* frame) {
  if (count_ == kMaxSamples) return;
  ++count_;
  for (std::size_t i = 0; i < kBodyParts; ++i) {
    Part& part = parts_[i];
    const std::size_t hand = i == 0 ? 0 : (i - 1) % 2;
    const bool elbow = i >= static_cast<std::size_t>(BodyPart::kLeftElbow);
    if (part.fatigue)
      part.fatigue->Add(
          frame ? part.fatigue_gaps.Fill(elbow ? frame->elbow_use[hand] : frame->shoulder_use[hand])
                : 0);
    if (part.tool)
      part.moment.push_back(
          frame ? part.moment_gaps.Fill(i == 0 ? LiftMoment(*frame) : ShoulderMoment(*frame, hand))
                : 0);
  }
}

void LiveExposure::Write(bool now, PersonState* state) {
  constexpr std::size_t kMinGrowth = 100;
  const std::size_t grown = count_ - counted_;
  const bool due = grown >= std::max(kMinGrowth, counted_ / 50) || (now && grown > 0);
  if (due) counted_ = count_;
  for (std::size_t i = 0; i < kBodyParts; ++i) {
    Part& part = parts_[i];
    PartState& to = state->parts[i];
    if (part.fatigue)
      to.capacity =
          part.fatigue_gaps.TooLong() ? kUnknown : static_cast<float>(part.fatigue->capacity());
    if (!part.tool || counted_ == 0) continue;
    if (part.moment_gaps.TooLong()) {
      to.damage = to.day_share = to.load_over_range = kUnknown;
      continue;
    }
    if (due) part.damage = DamageOfMoment(*part.tool, "", part.moment);
    to.damage = static_cast<float>(part.damage.per_run);
    to.day_share = static_cast<float>(part.damage.day_share);
    if (std::isfinite(part.tool->largest_load))
      to.load_over_range = static_cast<float>(part.damage.load_over_range);
  }
}

}  // namespace predictor::assessment
