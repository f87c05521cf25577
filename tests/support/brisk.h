// Provides a script that carries the object from side to side, almost at the handles' speed cap,
// for tests of events during fast motion.
#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor {

constexpr double kBriskBegin = 1, kBriskMove = 2, kBriskWay = 0.25;  // [s], [s], [m]
// Each move has minimum jerk: at the fraction u of its time, its speed is 30 u²(1 − u)² times the
// mean speed. The maximum speed is 15/8 of the mean speed. For half of the time, the speed exceeds
// 9/16 of the maximum. It reaches this value after a quarter of the time.
constexpr double kBriskSpeed = 15.0 / 8 * kBriskWay / kBriskMove;  // [m/s]
constexpr double kBriskMedian = 9.0 / 16 * kBriskSpeed;            // [m/s]

inline std::vector<ActionSpec> BriskScript() {
  std::vector<ActionSpec> script = {MakeActionSpec("grip", 0, {"duration=0.5"})};
  for (int i = 0; i < 6; ++i)
    script.push_back(
        MakeActionSpec("move", kBriskBegin + kBriskMove * i,
                       {"duration=" + std::to_string(kBriskMove),
                        "by=[0, " + std::to_string(i % 2 == 0 ? kBriskWay : -kBriskWay) + ", 0]"}));
  return script;
}

}  // namespace predictor
