// OWAS, Ovako Working posture Analysing System (Karhu, Kansi & Kuorinka 1977).
//
// Sources: a stored copy of the table (verified) and our recollection of the table. The two sources
// differ in the cell for back 3, arms 3, legs 7 and load 3: our recollection is 1, and the stored
// copy has
// 2. The larger value is used, and `contested` marks it.
//
// The method is not suitable for judging arms, because it has only three classes for arms. It is
// also not suitable for judging neck and wrists, because it ignores them.
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
// posture. In these cases, pass the classes to the function above. A knee counts as bent beyond 30°
// (design choice). The load is in kg. Does not allocate.
OwasScore AssessOwas(const BodyPosture& body, const ArmPosture& left, const ArmPosture& right,
                     double load);

}  // namespace predictor::ergonomics
