#include "rig/hand.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rig/person.h"

namespace predictor {
namespace {

Scenario Gripping(Scenario scenario) {
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"})};
  return scenario;
}

TEST(Hand, StaticStiffnessIsImpedancePlusReflexPlusSight) {
  const Scenario scenario = Gripping(QuietScenario(1));
  const HandSpec& hand = scenario.operator_.hand;
  Person person(scenario);
  person.Run(1);
  // At the pose where the hand gripped the handle, the force must be zero.
  EXPECT_LT(person.output.F_H_W[0].norm(), 1e-12);
  const Vector3 displacement(0.01, -0.02, 0.015), turn(0.1, -0.05, 0.2);
  person.input.handle[0].X_W.p += displacement;
  person.input.handle[0].X_W.q = RotationFromVector(turn) * person.input.handle[0].X_W.q;
  person.Run(1);
  const Vector3 stiffness = (1 + hand.reflex_gain) * hand.stiffness + hand.visual_stiffness;
  EXPECT_LT((person.Force() + stiffness.cwiseProduct(displacement)).norm(), 1e-10);
  const double rotation = (1 + hand.reflex_gain) * hand.rotation_stiffness;
  EXPECT_LT((person.Torque() + rotation * turn).norm(), 1e-10);
}

// A tired muscle needs more activation for the same force, so tremor and noise grow as 1/capacity.
TEST(Hand, TremorAndNoiseGrowWithFatigue) {
  HandSpec spec = QuietScenario(1).operator_.hand;
  spec.tremor_force = 0.8;
  spec.force_noise_floor = 0.5;
  const auto forces = [&](double capacity) {
    HandModel hand(spec, HandInertia::kInWrench, 5, "left");
    hand.Reset(0.001);
    ArmAbility arm;
    arm.capacity = capacity;
    std::vector<Vector3> series;
    for (int k = 0; k < 10000; ++k)
      series.emplace_back(hand.Intend({.hold = true}, {}, &arm).head<3>());
    return series;
  };
  const auto rested = forces(1), tired = forces(0.4);
  double sum = 0;
  for (std::size_t k = 0; k < rested.size(); ++k) {
    ASSERT_NEAR((tired[k] - rested[k] / 0.4).norm(), 0, 1e-12) << k;
    sum += rested[k].squaredNorm();
  }
  // The comparison means something only if there is tremor.
  const double expected = std::hypot(spec.tremor_force, spec.force_noise_floor);
  EXPECT_GT(std::sqrt(sum / static_cast<double>(rested.size())), 0.5 * expected);
}

TEST(Hand, ReflexAndSightActAfterTheirDelaysToTheTick) {
  const Scenario scenario = Gripping(QuietScenario(1));
  const HandSpec& hand = scenario.operator_.hand;
  for (const double dt : {0.001, 0.002}) {
    Person person(scenario);
    person.input.dt = dt;
    person.Run(1);
    const double z = 0.01;
    person.input.handle[0].X_W.p.z() += z;
    const double own = -hand.stiffness.z() * z;
    const double reflex = hand.reflex_gain * own;
    const double sight = -hand.visual_stiffness.z() * z;
    const int reflex_ticks = static_cast<int>(std::lround(hand.reflex_delay / dt));
    const int sight_ticks = static_cast<int>(std::lround(hand.visual_delay / dt));
    for (int k = 0; k < 2 * sight_ticks; ++k) {
      person.Step();
      const double expected =
          own + (k >= reflex_ticks ? reflex : 0) + (k >= sight_ticks ? sight : 0);
      ASSERT_NEAR(person.Force().z(), expected, 1e-10) << k;
    }
  }
}

TEST(Hand, DampingIsOfTheHandsMassAndStiffness) {
  const Scenario scenario = Gripping(QuietScenario(1));
  const HandSpec& hand = scenario.operator_.hand;
  Person person(scenario);
  person.Run(1);
  person.input.handle[0].V_W << 0.1, 0.2, -0.3, 0.4, 0.5, -0.6;
  person.Run(0.5);
  for (int i = 0; i < 3; ++i) {
    const double damping = 2 * hand.damping_ratio * std::sqrt(hand.mass * hand.stiffness[i]);
    const double late = 1 + hand.reflex_gain;
    EXPECT_NEAR(person.Force()[i], -late * damping * person.input.handle[0].V_W[i], 1e-10);
    EXPECT_NEAR(person.Torque()[i],
                -late * hand.rotation_damping * person.input.handle[0].V_W[3 + i], 1e-10);
  }
}

// The test displaces the handle of an arm along x in a slow sine. The force in phase and in
// quadrature must give the stiffness and damping of the whole arm, including reflexes.
TEST(Hand, SlowMotionsMeetTheMeasuredImpedanceOfAnArm) {
  const double dt = 0.001, amplitude = 0.01, omega = 2 * std::numbers::pi * 0.2;
  HandSpec spec = QuietScenario(1).operator_.hand;
  spec.max_force = 1e3;
  HandModel hand(spec, HandInertia::kInScene, 1, "hand");
  hand.Reset(dt);
  ArmAbility arm;
  arm.stiffness = Vector3(420, 260, 310).asDiagonal();
  HandGoal goal;
  goal.hold = true;
  goal.grip_time = dt;
  const int period = static_cast<int>(std::lround(2 * std::numbers::pi / omega / dt));
  double in_phase = 0, in_quadrature = 0;
  for (int k = 0; k < 2 * period; ++k) {
    const double phase = omega * k * dt;
    FrameMotion handle;
    handle.X_W.p.x() = amplitude * std::sin(phase);
    handle.V_W[0] = amplitude * omega * std::cos(phase);
    const double force = -hand.Intend(goal, handle, &arm)[0];
    if (k < period) continue;  // the grip closes, and the reflex begins
    in_phase += 2 * force * std::sin(phase) / period;
    in_quadrature += 2 * force * std::cos(phase) / period;
  }
  EXPECT_NEAR(in_phase / amplitude, 420, 420 * 0.01);
  const double damping = 2 * spec.damping_ratio * std::sqrt(spec.mass * 420);
  EXPECT_NEAR(in_quadrature / (amplitude * omega), damping, damping * 0.01);
}

TEST(Hand, ItsMassIsInTheWrenchOrReportedForTheScene) {
  const Scenario scenario = Gripping(QuietScenario(1));
  const double mass = scenario.operator_.hand.mass;
  for (const HandInertia inertia : {HandInertia::kInWrench, HandInertia::kInScene}) {
    Person person(scenario, inertia);
    person.Run(1);
    person.input.handle[0].A_W << 1, -2, 3, 4, 5, 6;
    person.Step();
    const double felt = inertia == HandInertia::kInWrench ? mass : 0;
    EXPECT_LT((person.Force() + felt * Vector3(1, -2, 3)).norm(), 1e-12);
    EXPECT_EQ(person.output.hand_mass[0], mass);
    EXPECT_EQ(person.output.hand_mass[1], 0);
  }
}

TEST(Hand, GripClosesSmoothlyAndOpensExponentially) {
  Scenario scenario = Gripping(SpringScenario(1));
  scenario.operator_.script.push_back(MakeActionSpec("release", 1));
  Person person(scenario);
  double last = 0;
  while (person.input.run_time < 0.9995) {
    person.Step();
    const double s = person.output.grip[0];
    EXPECT_GE(s, last - 1e-15);
    EXPECT_LT(s - last, 1.875 * 0.001 / 0.3 * 1.001);  // minimum jerk over 0.3 s
    last = s;
  }
  EXPECT_NEAR(last, 1, 1e-15);
  person.input.handle[0].X_W.p.x() += 0.01;
  const double held = -scenario.operator_.hand.stiffness.x() * 0.01;
  for (int k = 1; k <= 250; ++k) {
    person.Step();
    const double s = std::exp(-0.001 * k / scenario.operator_.hand.release_time);
    ASSERT_NEAR(person.output.grip[0], s, 1e-9) << k;
    ASSERT_NEAR(person.Force().x(), s * held, 1e-9) << k;
  }
  person.Run(0.1);
  EXPECT_EQ(person.output.grip[0], 0);
  EXPECT_EQ(person.output.hand_mass[0], 0);
  EXPECT_EQ(person.output.F_H_W[0].norm(), 0);
}

TEST(Hand, ForceAndTorqueAreBounded) {
  const Scenario scenario = Gripping(QuietScenario(1));
  const HandSpec& hand = scenario.operator_.hand;
  Person person(scenario);
  person.Run(1);
  person.input.handle[0].X_W.p += Vector3(1, 2, -3);
  person.input.handle[0].X_W.q = RotationFromVector({0, 3, 0}) * person.input.handle[0].X_W.q;
  person.Run(1);
  EXPECT_NEAR(person.Force().norm(), hand.max_force, 1e-9);
  EXPECT_NEAR(person.Torque().norm(), hand.max_torque, 1e-9);
}

TEST(Hand, NoiseAndTremorHaveTheirRootMeanSquare) {
  Scenario scenario = Gripping(SpringScenario(1));
  HandSpec& hand = scenario.operator_.hand;
  for (const bool tremor : {false, true}) {
    hand.tremor_force = tremor ? 0.1 : 0;
    hand.force_noise = tremor ? 0 : 0.03;
    hand.force_noise_floor = tremor ? 0 : 0.1;
    Person person(scenario);
    person.Run(1);
    person.input.handle[0].X_W.p.x() -= 0.04;  // 10 N
    double square = 0;
    int n = 0;
    person.Run(100, [&] { square += (person.Force() - Vector3(10, 0, 0)).squaredNorm(), ++n; });
    const double expected = tremor ? 0.1 : 0.03 * 10 + 0.1;
    EXPECT_NEAR(std::sqrt(square / n), expected, 0.1 * expected);
  }
}

}  // namespace
}  // namespace predictor
