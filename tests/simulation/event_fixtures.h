// Helpers for tests of events.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "world_fixtures.h"

namespace predictor {

inline EventSpec Event(const std::string& name, double after = 0,
                       const std::vector<std::string>& parameters = {}) {
  EventSpec event;
  event.event = name;
  event.trigger.after = after;
  for (const std::string& p : parameters) event.Set(p);
  return event;
}

// A box of 2 kg fixed to the flange, so that nothing swings.
inline Scenario RigidBox() {
  Scenario s = BoxScene(2);
  s.object.attachment.joint = JointType::kFixed;
  return s;
}

inline void RunWith(World* world, const WorldInput& input, double time) {
  for (int k = 0; k < std::lround(time / kTick); ++k)
    ASSERT_TRUE(world->Step(input, kTick).ok()) << world->state().time;
}

}  // namespace predictor
