#include "ergonomics/owas.h"

#include "ergonomics/joint_scores.h"

namespace predictor::ergonomics {
namespace {

// Rows: back 1 … 4, arms 1 … 3. Columns: legs 1 … 7, each with load 1 … 3.
constexpr std::string_view kOwas[4][3] = {
    {"111111111222222111111", "111111111222222111111", "111111111223223111112"},
    {"223223223333333222233", "223223233344344334234", "334223333344444444234"},
    {"111111112333444111111", "223111112444444333111", "223111233444444444112"},
    {"233223233444444444234", "334234334444444444234", "444234334444444444234"}};

constexpr const char* kOwasActions[4] = {
    "The posture is normal; no action is necessary.",
    "The posture may be harmful; take corrective action in the near future.",
    "The posture is harmful; take corrective action as soon as possible.",
    "The posture is very harmful; take corrective action immediately."};

OwasLegs OwasLegsOf(const BodyPosture& body) {
  if (body.sitting) return OwasLegs::kSitting;
  const bool bent = body.knee_flexion > Degrees(30);
  if (body.on_both_feet)
    return bent ? OwasLegs::kStandingOnBentKnees : OwasLegs::kStandingOnStraightLegs;
  return bent ? OwasLegs::kStandingOnOneBentKnee : OwasLegs::kStandingOnOneStraightLeg;
}

}  // namespace

OwasScore AssessOwas(OwasBack back, OwasArms arms, OwasLegs legs, OwasLoad load) {
  OwasScore score = {back, arms, legs, load};
  const int column = 3 * (static_cast<int>(legs) - 1) + static_cast<int>(load) - 1;
  score.category = Cell(kOwas[static_cast<int>(back) - 1][static_cast<int>(arms) - 1], column);
  score.contested = back == OwasBack::kTwisted && arms == OwasArms::kBothAboveShoulder &&
                    legs == OwasLegs::kWalking && load == OwasLoad::kAbove20Kg;
  score.action = OwasAction(score.category);
  return score;
}

Action OwasAction(int category) { return {category, kOwasActions[category - 1]}; }

OwasScore AssessOwas(const BodyPosture& body, const ArmPosture& left, const ArmPosture& right,
                     double load) {
  const bool bent = Exceeds(body.trunk_flexion, kDeclaredThresholds.bent_back);
  const bool twisted = Exceeds(body.trunk_twist, kDeclaredThresholds.bent_back) ||
                       Exceeds(body.trunk_side_bend, kDeclaredThresholds.bent_back);
  return AssessOwas(static_cast<OwasBack>(1 + bent + 2 * twisted),
                    static_cast<OwasArms>(1 + left.over_shoulder + right.over_shoulder),
                    OwasLegsOf(body),
                    load > 20    ? OwasLoad::kAbove20Kg
                    : load >= 10 ? OwasLoad::kTo20Kg
                                 : OwasLoad::kBelow10Kg);
}

}  // namespace predictor::ergonomics
