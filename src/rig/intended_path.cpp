#include "rig/intended_path.h"

#include <algorithm>
#include <cmath>

#include "core/minimum_jerk.h"
#include "rig/script.h"

namespace predictor {
namespace {

constexpr double kTick = 0.001;  // tick of the operator [s]

double NextGrip(const Scenario& scenario, double time) {
  double next = scenario.duration;
  for (const ActionSpec& action : scenario.operator_.script)
    if (action.action == "grip" && action.start > time) next = std::min(next, action.start);
  return next;
}

// The minimum-jerk motion of an object that no hand holds.
struct Return {
  Pose from, to;
  double begin = 0, end = 0;  // [s]

  void At(double time, Intent* intent) const {
    const double length = std::max(end - begin, kTick);
    const double x = (time - begin) / length;
    const double s = MinimumJerk(x);
    const double rate = MinimumJerkRate(x) / length;
    intent->X_WO = {from.p + s * (to.p - from.p), from.q.slerp(s, to.q)};
    intent->V_WO << rate * (to.p - from.p), rate * RotationError(to.q, from.q);
  }
};

// Calls `visit(time, intent)` in each tick.
template <typename Visit>
void Play(const Scenario& scenario, const Pose& X_WO, AfterRelease after, Visit visit) {
  Script script(scenario.operator_.script);
  Intent intent;
  intent.X_WO = X_WO;
  Return home{X_WO, X_WO, 0, scenario.duration};
  const auto ticks = static_cast<long>(std::llround(scenario.duration / kTick));
  for (long k = 0; k <= ticks; ++k) {
    const double time = static_cast<double>(k) * kTick;
    const bool was_held = intent.AnyHold();
    intent.V_WO.setZero();
    script.Begin(time, &intent);
    script.Advance(kTick, 1, &intent);
    if (was_held && !intent.AnyHold()) home = {intent.X_WO, X_WO, time, NextGrip(scenario, time)};
    if (!intent.AnyHold() && after == AfterRelease::kReturns) home.At(time, &intent);
    visit(k, intent);
  }
}

}  // namespace

std::vector<IntendedSample> IntendedPath(const Scenario& scenario, const Pose& X_WO,
                                         AfterRelease after, double step) {
  std::vector<IntendedSample> path;
  const long every = std::max(1L, std::lround(step / kTick));
  Play(scenario, X_WO, after, [&](long k, const Intent& intent) {
    if (k % every == 0)
      path.push_back({static_cast<double>(k) * kTick, intent.X_WO, intent.V_WO, intent.AnyHold()});
  });
  return path;
}

bool GripsAgain(const Scenario& scenario) {
  bool let_go = false;
  bool was_held = false;
  bool again = false;
  Play(scenario, {}, AfterRelease::kStays, [&](long, const Intent& intent) {
    let_go = let_go || (was_held && !intent.AnyHold());
    again = again || (let_go && intent.AnyHold());
    was_held = intent.AnyHold();
  });
  return again;
}

}  // namespace predictor
