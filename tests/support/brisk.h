// A carry from side to side, at nearly the handles' cap, for tests of events during fast motion.
#pragma once

#include <vector>

#include "scenario/scenario.h"

namespace predictor {

constexpr double kBriskBegin = 1, kBriskMove = 2, kBriskWay = 0.25;  // [s], [s], [m]
// Each move has minimum jerk, with a speed of 30 u²(1 − u)² times its mean at the fraction u of its
// time. The maximum is 15/8 of the mean. In half of the time the speed exceeds 9/16 of the maximum
// (the value at a quarter).
constexpr double kBriskSpeed = 15.0 / 8 * kBriskWay / kBriskMove;  // [m/s]
constexpr double kBriskMedian = 9.0 / 16 * kBriskSpeed;            // [m/s]

inline std::vector<ActionSpec> BriskScript() {
  std::vector<ActionSpec> script(1);
  script[0].action = "grip";
  script[0].duration = 0.5;
  for (int i = 0; i < 6; ++i) {
    ActionSpec move;
    move.action = "move";
    move.start = kBriskBegin + kBriskMove * i;
    move.duration = kBriskMove;
    move.by = {0, i % 2 == 0 ? kBriskWay : -kBriskWay, 0};
    script.push_back(move);
  }
  return script;
}

}  // namespace predictor
