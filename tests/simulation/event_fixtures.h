// Helpers for tests of events.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/archive.h"
#include "support/allocation_guard.h"
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

// Returns a scenario with a box of 2 kg fixed to the flange, so that nothing swings.
inline Scenario RigidBox() {
  Scenario s = BoxScene(2);
  s.object.attachment.joint = JointType::kFixed;
  return s;
}

inline void RunWith(World* world, const WorldInput& input, double time) {
  for (int k = 0; k < std::lround(time / kTick); ++k)
    ASSERT_TRUE(world->Step(input, kTick).ok()) << world->state().time;
}

// Checks that `ticks` steps with this force on each handle, and a reset, do not allocate memory on
// the heap.
inline void ExpectNoHeap(const Scenario& scenario, const Vector3& force, int ticks) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  World world(scenario);
  const WorldInput input = Push(scenario, force);
  bool ok = true;
  const test::AllocationGuard guard;
  for (int k = 0; k < ticks; ++k) ok = world.Step(input, kTick).ok() && ok;
  world.Reset();
  const std::int64_t count = guard.count();
  EXPECT_EQ(count, 0);
  EXPECT_TRUE(ok);
}

// Saves the state of one world and loads it into another one.
inline void CopyState(World* from, World* to) {
  std::vector<std::byte> bytes(1 << 20);
  StateArchive save = StateArchive::ToSave(bytes);
  from->Archive(save);
  ASSERT_TRUE(save.ok());
  StateArchive load = StateArchive::ToLoad({bytes.data(), save.used()});
  to->Archive(load);
  ASSERT_TRUE(load.ok());
  ASSERT_EQ(load.used(), save.used());
}

}  // namespace predictor
