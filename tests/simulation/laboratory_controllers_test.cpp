// The controllers that laboratories use, against the closed forms of their laws. Each expected
// value is computed here, from the law as published.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/error.h"
#include "simulation/controllers/minimum_jerk_estimate.h"
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

// ---- minimum jerk ------------------------------------------------------------------------------

// Position and velocity, as shares of the distance, of a movement of T seconds at time t.
struct JerkPoint {
  double x, v;
};
JerkPoint MinimumJerkAt(double t, double T) {
  const double s = std::min(std::max(t / T, 0.0), 1.0);
  return {10 * std::pow(s, 3) - 15 * std::pow(s, 4) + 6 * std::pow(s, 5),
          (30 * std::pow(s, 2) - 60 * std::pow(s, 3) + 30 * std::pow(s, 4)) / T};
}

// Along an exact minimum-jerk movement, the estimate equals it: within 2 % from a quarter of the
// movement on, within 0.5 % from its middle on. It is noticed late, and begins at any time.
TEST(MinimumJerkEstimate, EqualsAnExactMovement) {
  for (const double T : {0.7, 1.5, 4.0})
    for (const Vector3& distance : {Vector3(0.1, 0, 0), Vector3(-0.2, 0.3, 0.1)}) {
      double numbers[controllers::MovementOnset::kSize] = {};
      controllers::MovementOnset onset(numbers);
      const Vector3 start(1, 2, 3);
      for (int k = 0; k < 1000 * (1 + T); ++k) {
        const double t = 1e-3 * k - 0.5;  // it begins after half a second
        const JerkPoint point = MinimumJerkAt(t, T);
        const Vector3 p = start + point.x * distance, v = point.v * distance;
        if (t > 0.25 * T && t < 0.9 * T) {
          const double tolerance = t < 0.5 * T ? 0.02 : 0.005;
          const auto estimate = onset.Estimate(p, v);
          ASSERT_NEAR(estimate.duration, T, tolerance * T) << t;
          ASSERT_LT((estimate.distance - distance).norm(), 2 * tolerance * distance.norm()) << t;
        }
        onset.Advance(p, v, 0.01, 1e-3);
      }
      EXPECT_FALSE(onset.is_moving());
    }
}

// A hand leads the box along a minimum-jerk movement with the force that this needs beyond the
// assistance (which the controller fades in from s = 0.1 to 0.3), and a spring against deviations.
// Returns the mean force [N] of the hand while the cobot assists fully.
double MeanForceOfHand(double assistance, double T, double distance) {
  World world(FlangeScene("minimum_jerk_intention", {"damping_translation=60", "load_mass=2",
                                                     "assistance=" + std::to_string(assistance)}));
  const double y = world.state().end_effector.X_W.p.y();
  double sum = 0;
  int count = 0;
  Guide(&world, T, [&](const WorldState& state) {
    const double s = state.time / T, h = 1e-4;
    const JerkPoint wanted = MinimumJerkAt(state.time, T);
    const double a =
        (MinimumJerkAt(state.time + h, T).v - MinimumJerkAt(state.time - h, T).v) / (2 * h);
    const double needed = distance * (60 * wanted.v + (8 + kMassOfBox) * a);
    const double share = assistance * std::min(std::max((s - 0.1) / 0.2, 0.0), 1.0);
    const double force = (1 - share) * needed +
                         400 * (y + distance * wanted.x - state.end_effector.X_W.p.y()) +
                         40 * (distance * wanted.v - state.end_effector.V_W[1]);
    if (s > 0.3 && s < 0.9) sum += std::abs(force), ++count;
    return Vector3(0, force, 0);
  });
  EXPECT_NEAR(world.state().end_effector.X_W.p.y() - y, distance, 0.05 * distance);
  return sum / count;
}

// Without assistance, the hand moves the virtual mass, the box and the damper. With full
// assistance, its force nearly vanishes.
TEST(MinimumJerkIntention, RelievesTheHand) {
  for (const double T : {1.5, 2.5}) {
    const double distance = 0.2;
    double expected = 0;
    int count = 0;
    for (double t = 0.3 * T; t < 0.9 * T; t += 1e-3, ++count) {
      const double h = 1e-4, v = MinimumJerkAt(t, T).v;
      const double a = (MinimumJerkAt(t + h, T).v - MinimumJerkAt(t - h, T).v) / (2 * h);
      expected += distance * std::abs(60 * v + (8 + kMassOfBox) * a);
    }
    expected /= count;
    EXPECT_NEAR(MeanForceOfHand(0, T, distance), expected, 0.05 * expected) << T;
    EXPECT_NEAR(MeanForceOfHand(0.5, T, distance), 0.5 * expected, 0.05 * expected) << T;
    EXPECT_LT(MeanForceOfHand(1, T, distance), 0.1 * expected) << T;
  }
}

}  // namespace
}  // namespace predictor
