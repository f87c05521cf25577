#include "assessment/live_exposure.h"

#include <algorithm>

namespace predictor::assessment {
namespace {

// Limits the memory that a run of unlimited duration needs.
constexpr std::size_t kMaxSamples = 8 * 3600 * 100;  // a shift

}  // namespace

LiveExposure::LiveExposure(const Scenario& scenario) {
  Part& back = parts_[static_cast<std::size_t>(BodyPart::kLowerBack)];
  back.damage_per_cycle = ergonomics::LiftDamage;
  back.risk = &ergonomics::kLiftRisk;
  for (int hand = 0; hand < kHands; ++hand) {
    if (!scenario.Has(hand)) continue;
    const auto h = static_cast<std::size_t>(hand);
    Part& shoulder = parts_[static_cast<std::size_t>(BodyPart::kLeftShoulder) + h];
    shoulder.fatigue.emplace(ergonomics::FatigueJoint::kShoulder);
    shoulder.damage_per_cycle = ergonomics::ShoulderDamage;
    shoulder.risk = &ergonomics::kShoulderRisk;
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
      part.fatigue->Add(!frame ? 0 : elbow ? frame->elbow_use[hand] : frame->shoulder_use[hand]);
    if (part.damage_per_cycle)
      part.moment.push_back(!frame   ? 0
                            : i == 0 ? LiftMoment(*frame)
                                     : frame->loads.shoulder_moment[hand]);
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
    if (part.fatigue) to.capacity = static_cast<float>(part.fatigue->capacity());
    if (!part.damage_per_cycle || counted_ == 0) continue;
    if (due) part.damage = DamageOfMoment("", "", part.moment, part.damage_per_cycle, *part.risk);
    to.damage = static_cast<float>(part.damage.per_run);
    to.day_share = static_cast<float>(part.damage.day_share);
  }
}

}  // namespace predictor::assessment
