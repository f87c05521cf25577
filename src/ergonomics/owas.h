// OWAS, Ovako Working posture Analysing System (Karhu, Kansi & Kuorinka 1977).
//
// Source: a stored copy of the table (verified) and our recollection of it. The two sources differ
// in one cell: back 3, arms 3, legs 7, load 3 (recollection 1, stored copy 2). The larger value is
// used, and `contested` marks it.
//
// The method is not suitable for judging arms, because it has only three classes for them, or for
// judging neck and wrists, which it ignores.
#pragma once

#include "ergonomics/posture.h"

namespace predictor::ergonomics {

enum class OwasBack { kStraight = 1, kBent, kTwisted, kBentAndTwisted };
enum class OwasArms { kBothBelowShoulder = 1, kOneAboveShoulder, kBothAboveShoulder };
enum class OwasLegs {
  kSitting = 1,
  kStandingOnStraightLegs,
  kStandingOnOneStraightLeg,
  kStandingOnBentKnees,
  kStandingOnOneBentKnee,
  kKneeling,
  kWalking,
};
enum class OwasLoad { kBelow10Kg = 1, kTo20Kg, kAbove20Kg };

struct OwasScore {
  OwasBack back = OwasBack::kStraight;
  OwasArms arms = OwasArms::kBothBelowShoulder;
  OwasLegs legs = OwasLegs::kStandingOnStraightLegs;
  OwasLoad load = OwasLoad::kBelow10Kg;
  int category = 0;        // 1 … 4
  bool contested = false;  // the sources differ about this cell
  Action action;           // level = category
};

// Returns the action for a category of 1 … 4.
Action OwasAction(int category);

OwasScore AssessOwas(OwasBack back, OwasArms arms, OwasLegs legs, OwasLoad load);

// Returns the classes of a measured posture. Kneeling and walking cannot be detected from the
// posture, so pass the classes to the function above in these cases. A knee counts as bent beyond
// 30° (design choice). Does not allocate.
OwasScore AssessOwas(const BodyPosture& body, const ArmPosture& left, const ArmPosture& right,
                     double load,  // [kg]
                     const PostureThresholds& thresholds = kDeclaredThresholds);

}  // namespace predictor::ergonomics
