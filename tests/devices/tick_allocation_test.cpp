// A complete tick with real drivers must not allocate memory in motion, during faults, during a
// stop, or at rest.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <map>
#include <string>

#include "fakes/held_system.h"
#include "support/allocation_guard.h"

namespace predictor {
namespace {

struct TickFault {
  const char* name;
  std::function<void(HeldSystem*)> happen;
  int missed = 0;  // number of missed ticks before the next one
};

// Returns two arms of one manufacturer or, for "mixed", one arm of each manufacturer. One arm uses
// its own sensor, and the other arm uses a separate sensor.
HeldSystemOptions Rigging(const std::string& make) {
  const std::string right = make == "mixed" ? "franka" : make, left = make == "mixed" ? "ur" : make;
  const std::map<std::string, std::string> scenarios = {
      {"ur", "dual_ur5"}, {"franka", "box_9kg"}, {"mixed", "ur_and_panda"}};
  HeldSystemOptions options;
  options.scenario =
      std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + scenarios.at(make) + ".yaml";
  options.arms = {left, right};
  options.net_ft = {false, left == "ur"};
  return options;
}

// Counts allocations from one second before the fault until 1.5 s after it. Returns whether the
// arms stopped.
bool ExpectNoAllocation(const std::string& make, const TickFault& fault) {
  HeldSystem system(Rigging(make));
  EXPECT_TRUE(system.Start()) << make << " " << fault.name;
  std::int64_t count = 0;
  bool stopped = false;
  for (int k = 0; k < 2500; ++k) {
    const bool now = k == 1000;
    if (now) fault.happen(&system);
    const int missed = now ? fault.missed : 0;
    system.Between(missed);
    const test::AllocationGuard guard;
    system.emulator().Tick(system.now(), missed);
    count += guard.count();
    stopped = stopped || system.emulator().state() == RunState::kStopping;
  }
  EXPECT_EQ(count, 0) << make << ": " << fault.name;
  return stopped;
}

const TickFault kOfAnyMake[] = {
    {"nothing", [](HeldSystem*) {}},
    {"connection breaks", [](HeldSystem* s) { s->wire(0).closed = true; }},
    {"silence", [](HeldSystem* s) { s->wire(1).silent = true; }},
    {"deaf", [](HeldSystem* s) { s->wire(1).deaf = true; }},
    {"late", [](HeldSystem* s) { s->wire(0).delay = 0.012; }},
    {"bytes one by one", [](HeldSystem* s) { s->wire(0).split = true; }},
    {"corrupt",
     [](HeldSystem* s) {
       s->wire(0).corrupt = [](Bytes* bytes) {
         for (std::byte& b : *bytes) b ^= std::byte{0x5a};
       };
     }},
    {"joint jumps",
     [](HeldSystem* s) {
       JointVector q = JointVector::Zero(s->rig().joints(1).size());
       q[2] = 0.2;
       s->rig().Disturb(1, q, Wrench::Zero());
     }},
    {"60 N",
     [](HeldSystem* s) {
       s->rig().Disturb(0, {}, Wrench((Vector6() << 60, 0, 0, 0, 0, 0).finished()));
     }},
    {"not a number",
     [](HeldSystem* s) {
       s->rig().Disturb(0, {}, Wrench::Constant(std::numeric_limits<double>::quiet_NaN()));
     }},
    {"three deadlines missed", [](HeldSystem*) {}, 3},
};

class TickAllocation : public testing::TestWithParam<std::string> {};

TEST_P(TickAllocation, NoTickEverAllocates) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  int stops = 0;
  for (const TickFault& fault : kOfAnyMake) stops += ExpectNoAllocation(GetParam(), fault);
  EXPECT_GE(stops, 8);  // proves that the faults have an effect
}

INSTANTIATE_TEST_SUITE_P(Of, TickAllocation, testing::Values("ur", "franka", "mixed"),
                         [](const auto& rig) { return rig.param; });

TEST(TickAllocation, NoTickAllocatesInAControllersOwnFaults) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  int stops = 0;
  for (const char* what : {"protective stop", "emergency stop", "power off", "slider 50", "repeat",
                           "rewind", "malformed", "text", "stop program", "not a number"})
    stops += ExpectNoAllocation("ur",
                                {what, [what](HeldSystem* s) { EXPECT_TRUE(s->arm(0).Do(what)); }});
  for (const char* what : {"saturate", "freeze", "silent", "short"})
    stops += ExpectNoAllocation(
        "ur", {what, [what](HeldSystem* s) { EXPECT_TRUE(s->sensor(1).Do(what)); }});
  for (const char* what : {"user stop", "emergency stop", "reflex", "lose states 30",
                           "repeat state", "cut state", "spoil state", "lose commands 25"})
    stops += ExpectNoAllocation("franka",
                                {what, [what](HeldSystem* s) { EXPECT_TRUE(s->arm(0).Do(what)); }});
  EXPECT_GE(stops, 17);
}

}  // namespace
}  // namespace predictor
