// Made-up records and samples of a person.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "assessment/hand_samples.h"
#include "assessment/person_run.h"
#include "assessment/person_setup.h"

namespace predictor::assessment {

inline constexpr double kGround = -0.85;  // height of the ground in W [m]

inline Scenario PersonScenario() {
  Scenario scenario;
  scenario.name = "Made up";
  scenario.left_handle = scenario.right_handle = HandleSpec{};
  scenario.operator_.body = BodySpec{.height = 1.75, .mass = 75, .sex = Sex::kMale};
  scenario.operator_.stance = StanceSpec{.ground = {0.95, 0, kGround}, .facing = std::numbers::pi};
  return scenario;
}

// Both hands are 0.45 m in front of the person and `height` [m] above the ground. Each hand exerts
// an upward force [N].
inline TickRecord RecordOf(std::uint64_t tick, double height, double force) {
  TickRecord record{};
  record.tick = tick;
  record.run_time = 1e-3 * static_cast<double>(tick);
  record.ran = 1;
  for (std::size_t h = 0; h < kHands; ++h) {
    HandRecord& hand = record.hands[h];
    hand.present = hand.gripping = 1;
    hand.real.pose = ToRecord(Pose{{0.5, h == 0 ? -0.15 : 0.15, kGround + height}, {1, 0, 0, 0}});
    hand.wrench[2] = force;
  }
  return record;
}

inline constexpr std::uint64_t kBegin = 7'000'000'000;  // monotonic clock at tick 0 [ns]
inline constexpr std::uint64_t kMilli = 1'000'000;      // [ns]

// The same with 20 N and a time of the monotonic clock.
inline TickRecord TickAt(std::uint64_t tick) {
  TickRecord record = RecordOf(tick, 1, 20);
  record.wall_ns = kBegin + kMilli * tick;
  return record;
}

inline SampleCollector Collect(const Scenario& scenario, double duration,
                               const std::function<TickRecord(std::uint64_t)>& record) {
  SampleCollector run(scenario);
  const auto ticks = static_cast<std::uint64_t>(std::lround(1e3 * duration));
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) run.Add(record(tick));
  return run;
}

}  // namespace predictor::assessment
