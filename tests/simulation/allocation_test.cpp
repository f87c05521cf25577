// The tick must not allocate heap memory.
#include <gtest/gtest.h>

#include "core/text.h"
#include "support/allocation_guard.h"
#include "support/plugins.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

// Performs steps with contacts, active coupling, discarded steps, hands that grip and release, and
// a reset.
void Exercise(const Scenario& s) {
  World world(s);
  WorldInput input = Push(s, {10, -5, -40});
  input.coupled = s.mode == Mode::kEmulate;
  input.handle = world.state().handle;
  WorldInput broken = input;
  broken.F_H_W[0][0] = std::nan("");
  int failed = 0;
  const test::AllocationGuard guard;
  for (int i = 0; i < 1000; ++i) {
    if (s.mode == Mode::kDirect) input.hand_mass = {1e-3 * i, 1.5};
    failed += world.Step(i % 100 == 99 ? broken : input, kTick).ok() ? 0 : 1;
    if (i == 500) world.Reset();
  }
  EXPECT_EQ(guard.count(), 0);
  EXPECT_EQ(failed, 10);
}

TEST(Allocation, NoneInAStepForAnyController) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  for (const std::string& type : ControllerNames()) {
    for (const double ratio : {0.3, 0.7}) {
      Scenario s = BoxScene(9);
      s.cobot.controller = type == "plugin"    ? test::Plugin("joint_impedance")
                           : type == "process" ? test::PythonExample()
                                               : ControllerSpec{type, {}};
      if (type == "joint_impedance") s.cobot.controller.Set("joint_stiffness=1000");
      s.cobot.joint_friction.coulomb = {0.5};
      if (type == "cartesian_impedance") {
        s.cobot.controller.Set("damping_ratio=[0.7, 0.7, 0.7, 0.7, 0.7, " + FormatNumber(ratio) +
                               "]");
      }
      for (const char* moving : {"admittance", "cartesian_impedance", "hybrid_force_position"}) {
        if (type != moving) continue;
        s.cobot.controller.Set("trajectory=[{time: 1, xyz: [0.1, 0, 0], rpy: [0, 0, 0.1]}]");
      }
      s.environment.table = TableSpec{};
      s.environment.table->top = {0.5, 0, 0.98};  // the box stands on it
      Exercise(s);
    }
  }
}

TEST(Allocation, NoneInDirectMode) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  Scenario s = BoxScene(9);
  s.mode = Mode::kDirect;
  s.environment.floor = true;
  Exercise(s);
}

}  // namespace
}  // namespace predictor
