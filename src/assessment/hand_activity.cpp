#include "assessment/hand_activity.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "ergonomics/hand_activity.h"
#include "evaluation/statistics_samples.h"

namespace predictor::assessment {
namespace {

constexpr double kPeak =
    0.9;  // percentile of a peak force (chapter on HAL in a textbook; verified)

double HandForce(const PersonSample& sample, std::size_t hand) {
  const person::HandSample& h = sample.body.hands[hand];
  return h.present ? h.F_D_W.head<3>().norm() : 0;
}

// Makes pauses shorter than kShortestPause part of the exertion.
void FillShortPauses(std::vector<bool>* exerts) {
  const auto shortest = static_cast<std::size_t>(kShortestPause * kSampleRate);
  std::optional<std::size_t> last;  // last sample with an exertion
  for (std::size_t i = 0; i < exerts->size(); ++i) {
    if (!(*exerts)[i]) continue;
    if (last && i - *last <= shortest)
      for (std::size_t k = *last + 1; k < i; ++k) (*exerts)[k] = true;
    last = i;
  }
}

std::vector<bool> ExertionOver(std::span<const PersonSample> all, std::size_t hand) {
  std::vector<bool> exerts;
  bool now = false;
  for (const PersonSample& sample : all) {
    const double force = HandForce(sample, hand);
    now = now ? force >= kExertionEnds : force > kExertionBegins;
    exerts.push_back(now);
  }
  FillShortPauses(&exerts);
  return exerts;
}

// Returns not a number if no posture is known.
double UseOfArm(const Frame& frame, std::size_t hand) {
  return std::fmax(frame.elbow_use[hand], frame.shoulder_use[hand]);
}

double PeakOf(std::vector<double> values) {
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  return values.empty() ? kUnknownValue : Quantile(values, kPeak);
}

// Returns `force`, but at most 10. An unknown force stays unknown.
double Strongest(double force) { return force > 10 ? 10 : force; }

}  // namespace

HandActivity HandActivityOf(int hand, std::span<const PersonSample> all,
                            const NominalChain& nominal, std::optional<double> grip_effort) {
  const auto h = static_cast<std::size_t>(hand);
  const std::vector<bool> exerts = ExertionOver(all, h);
  HandActivity activity{.hand = hand};
  std::vector<double> forces, uses;
  std::size_t held = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (exerts[i] && (i == 0 || !exerts[i - 1])) ++activity.exertions;
    if (exerts[i]) forces.push_back(HandForce(all[i], h));
    if (!IsHeld(all[i])) continue;
    activity.exerts.push_back(exerts[i]);
    if (exerts[i]) uses.push_back(UseOfArm(nominal.frames[held], h));
    ++held;
  }
  const auto samples = static_cast<double>(all.size());
  activity.frequency = static_cast<double>(activity.exertions) * kSampleRate / samples;
  activity.duty = static_cast<double>(forces.size()) / samples;
  activity.level = ergonomics::HandActivityLevel(activity.frequency, activity.duty);
  activity.studied = ergonomics::HandActivityWasStudied(activity.frequency, activity.duty);
  activity.peak_force = forces.empty() ? 0 : PeakOf(forces);
  activity.stated = grip_effort.has_value();
  if (grip_effort)
    activity.normalized_force = *grip_effort;
  else if (!forces.empty())
    activity.normalized_force = Strongest(10 * PeakOf(uses));
  activity.ratio = ergonomics::HandActivityRatio(activity.normalized_force, activity.level);
  return activity;
}

const QuantityKind& ActivityRatioKind(int hand) {
  constexpr Unit kRatio = {"", "", 1, 2};
  constexpr const char* kGroup = "Hand activity (ACGIH)";
  static constexpr QuantityKind kKinds[kHands] = {
      {"hands.left.activity_ratio", kGroup, "left hand activity ratio", kRatio, Origin::kStandard,
       nullptr, 0, "", 0},
      {"hands.right.activity_ratio", kGroup, "right hand activity ratio", kRatio, Origin::kStandard,
       nullptr, 0, "", 1}};
  return kKinds[hand];
}

std::string Sentence(const HandActivity& a) {
  std::string text = Formatted(
      "%s hand: %zu exertion%s above %.0f N (%.2f per second, %.0f %% of the time, 90th percentile "
      "of the force %.1f N), so the hand activity level is %.1f of 10%s.",
      HandName(a.hand), a.exertions, a.exertions == 1 ? "" : "s", kExertionBegins, a.frequency,
      100 * a.duty, a.peak_force, a.level,
      a.studied ? "" : ", extrapolated beyond the data of the equation");
  if (!std::isfinite(a.normalized_force))
    return text + " The ratio is unknown, because no posture is known during the exertions.";
  if (a.stated)
    Append(&text, " The normalized peak force is %.1f of 10 (stated), so the ratio is %.2f.",
           a.normalized_force, a.ratio);
  else
    Append(&text,
           " The normalized peak force is at least %.1f of 10 (modelled, from the strength of the "
           "arm; the grip may be tighter), so the ratio is at least %.2f.",
           a.normalized_force, a.ratio);
  return text;
}

}  // namespace predictor::assessment
