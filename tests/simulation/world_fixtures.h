// Helpers to run a world in tests.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "core/error.h"
#include "scenes.h"
#include "simulation/world.h"

namespace predictor {

inline constexpr double kTick = 0.001;  // [s]

inline WorldInput HandsOff(const Scenario& s) {
  WorldInput input;
  input.present = s.hands();
  return input;
}

// Returns a force [N] in W on each existing handle.
inline WorldInput Push(const Scenario& s, const Vector3& force) {
  WorldInput input = HandsOff(s);
  for (Wrench& F : input.F_H_W) F.head<3>() = force;
  return input;
}

inline void Simulate(World* world, const WorldInput& input, double duration,
                     const std::function<void(const WorldState&)>& each = {}) {
  const int ticks = static_cast<int>(std::lround(duration / kTick));
  for (int i = 0; i < ticks; ++i) {
    ASSERT_TRUE(world->Step(input, kTick).ok()) << "at " << world->state().time << " s";
    if (each) each(world->state());
  }
}

// Returns the key and the message with which the world refuses a scenario, or "" if it accepts the
// scenario.
inline std::string RefusalOf(const Scenario& s) {
  try {
    World world(s);
  } catch (const InputError& error) {
    return error.key() + " | " + error.what();
  }
  return "";
}

}  // namespace predictor
