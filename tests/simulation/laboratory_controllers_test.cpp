// The controllers that laboratories use, against the closed forms of their laws. Each expected
// value is computed here, from the law as published.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/error.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

constexpr double kMassOfBox = 2;  // of FlangeScene [kg]

// The force [N] of the hand by time [s] and state.
using HandForce = std::function<Vector3(const WorldState&)>;

void Guide(World* world, double duration, const HandForce& force) {
  WorldInput input;
  input.present = {true, false};
  for (int k = 0; k < std::lround(duration / kTick); ++k) {
    input.F_H_W[0].head<3>() = force(world->state());
    ASSERT_TRUE(world->Step(input, kTick).ok()) << "at " << world->state().time << " s";
  }
}

// ---- variable impedance ------------------------------------------------------------------------

// A constant force moves the end-effector at the speed v with d(v) v = F.
TEST(VariableImpedance, ReachesTheSpeedAtWhichDampingBalancesTheForce) {
  for (const double force : {5.0, 10.0, 15.0}) {
    World world(FlangeScene("variable_impedance", {"damping_translation=120", "damping_minimum=40",
                                                   "adaptation_speed=0.15"}));
    Guide(&world, 1.6, [&](const WorldState&) { return Vector3(0, force, 0); });
    double slow = 0, fast = 1;
    while (fast - slow > 1e-9) {
      const double v = (slow + fast) / 2, d = 40 + 80 * std::exp(-v / 0.15);
      (d * v < force ? slow : fast) = v;
    }
    EXPECT_NEAR(world.state().end_effector.V_W[1], slow, 0.02 * slow) << force;
  }
}

// A force that rises by r t, then falls at the same rate: m v̇ + d v = F with d = d_0 − α r, then
// d_0 + α r. The mass is the virtual one and the box.
TEST(VariableImpedance, TakesARisingForceAsTheIntentionToAccelerate) {
  const double d0 = 100, gain = 2, r = 10, m = 8 + kMassOfBox, turn = 1, end = 1.6;
  World world(FlangeScene("variable_impedance",
                          {"adaptation=intention", "damping_translation=100", "adaptation_gain=2",
                           "virtual_mass=8", "derivative_time=0.01"}));
  const auto push = [&](const WorldState& s) {
    return Vector3(0, r * (s.time < turn ? s.time : 2 * turn - s.time), 0);
  };
  const double rising = d0 - gain * r, falling = d0 + gain * r;
  const auto ramp = [&](double d, double slope, double force, double v, double t) {
    const double v_ramp = force / d - slope * m / (d * d);  // particular solution at t = 0
    return v_ramp + slope * t / d + (v - v_ramp) * std::exp(-d * t / m);
  };
  const double v_turn = ramp(rising, r, 0, 0, turn);
  Guide(&world, turn, push);
  EXPECT_NEAR(world.state().end_effector.V_W[1], v_turn, 0.03 * v_turn);
  Guide(&world, end - turn, push);
  const double v_end = ramp(falling, -r, r * turn, v_turn, end - turn);
  EXPECT_NEAR(world.state().end_effector.V_W[1], v_end, 0.05 * v_turn);
}

TEST(VariableImpedance, RefusesBoundsInTheWrongOrder) {
  try {
    World(FlangeScene("variable_impedance", {"damping_translation=10"}));
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "cobot.controller.damping_minimum is 20 N·s/m; it must be at most "
                 "damping_translation, 10 N·s/m.");
  }
}

}  // namespace
}  // namespace predictor
