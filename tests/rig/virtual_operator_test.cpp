#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/minimum_jerk.h"
#include "rig/person.h"

namespace predictor {
namespace {

// Returns the offset from the handle to the target position of a hand that consists only of a
// spring.
Vector3 Pull(const Person& person, const Scenario& scenario, int hand = 0) {
  return person.Force(hand).cwiseQuotient(scenario.operator_.hand.stiffness);
}

TEST(MinimumJerk, HasThePeakSpeedAndTheEndsOfTheClosedForm) {
  EXPECT_EQ(MinimumJerk(-1), 0);
  EXPECT_EQ(MinimumJerk(0), 0);
  EXPECT_NEAR(MinimumJerk(0.5), 0.5, 1e-15);
  EXPECT_EQ(MinimumJerk(1), 1);
  EXPECT_EQ(MinimumJerk(2), 1);
  EXPECT_EQ(MinimumJerkRate(0.5), 1.875);
  for (double x = 0.05; x < 1; x += 0.05) {
    const double h = 1e-6;
    EXPECT_NEAR(MinimumJerkRate(x), (MinimumJerk(x + h) - MinimumJerk(x - h)) / (2 * h), 1e-8);
  }
}

TEST(VirtualOperator, MovesTheReferenceWithMinimumJerk) {
  Scenario scenario = SpringScenario(2);
  ActionSpec move = MakeActionSpec("move", 1, {"duration=4"});
  const Vector3 by(0.1, -0.2, 0.3);
  move.Set("by=[0.1, -0.2, 0.3]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), move};
  Person person(scenario);
  person.Run(1);
  Vector3 before = Vector3::Zero();
  double peak = 0;
  for (int k = 1; k <= 5000; ++k) {
    person.Step();
    const double x = k * 0.001 / 4;
    for (const int hand : {0, 1}) {
      ASSERT_LT((Pull(person, scenario, hand) - MinimumJerk(x) * by).norm(), 1e-10) << k;
      ASSERT_LT(person.Torque(hand).norm(), 1e-12);
    }
    peak = std::max(peak, (Pull(person, scenario) - before).norm() / 0.001);
    before = Pull(person, scenario);
    if (k != 4000) {  // rounding decides whether the motion ends in this tick
      EXPECT_EQ(person.output.action, k < 4000 ? 1 : -1) << k;
    }
  }
  EXPECT_NEAR(peak, 1.875 * by.norm() / 4, 1e-5);
}

TEST(VirtualOperator, DampsAgainstTheVelocityOfTheReference) {
  Scenario scenario = SpringScenario(2);
  scenario.operator_.hand.damping_ratio = 0.3;
  scenario.operator_.hand.rotation_damping = 0.1;
  ActionSpec move = MakeActionSpec("move", 1, {"duration=2"});
  move.Set("by=[0.1, 0, 0]");
  ActionSpec turn = MakeActionSpec("rotate", 1, {"duration=2"});
  turn.Set("rotate_by=[0, 0, 0.4]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), move, turn};
  Scenario undamped = scenario;
  undamped.operator_.hand.damping_ratio = undamped.operator_.hand.rotation_damping = 0;
  Person person(scenario), springs(undamped);
  person.Run(1);
  springs.Run(1);
  Vector3 before = Vector3::Zero();
  const HandSpec& hand = scenario.operator_.hand;
  for (int k = 1; k <= 2000; ++k) {
    person.Step();
    springs.Step();
    // The finite differences of the spring's force give the velocity of the reference half a step
    // too early.
    const Vector3 v = (Pull(springs, scenario) - before) / 0.001;
    before = Pull(springs, scenario);
    const Vector3 damping = (2 * hand.damping_ratio * (hand.mass * hand.stiffness).cwiseSqrt());
    ASSERT_LT((person.Force() - springs.Force() - damping.cwiseProduct(v)).norm(), 5e-3) << k;
    const double w = 0.4 * MinimumJerkRate(k * 0.001 / 2) / 2;
    ASSERT_NEAR((person.Torque() - springs.Torque()).z(), hand.rotation_damping * w, 1e-9) << k;
  }
}

TEST(VirtualOperator, TurnsBothHandlesAboutTheObject) {
  Scenario scenario = SpringScenario(2);
  ActionSpec turn = MakeActionSpec("rotate", 1, {"duration=2"});
  const Vector3 rotate_by(0.1, -0.2, 0.35);
  turn.Set("rotate_by=[0.1, -0.2, 0.35]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), turn};
  Person person(scenario);
  person.Run(4);
  const Matrix3 R = RotationFromVector(rotate_by).toRotationMatrix();
  for (const int hand : {0, 1}) {
    const Vector3 arm = person.input.handle[static_cast<std::size_t>(hand)].X_W.p - person.X_WO.p;
    EXPECT_LT((Pull(person, scenario, hand) - (R * arm - arm)).norm(), 1e-10);
    EXPECT_LT((person.Torque(hand) - scenario.operator_.hand.rotation_stiffness * rotate_by).norm(),
              1e-10);
  }
}

TEST(VirtualOperator, RunsTheCircleThroughItsStart) {
  Scenario scenario = SpringScenario(1);
  const double radius = 0.15, period = 4, cycles = 2;
  const ActionSpec circle = MakeActionSpec("circle", 1, {"radius=0.15", "period=4", "cycles=2"});
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), circle};
  Person person(scenario);
  person.Run(1);
  const Vector3 centre(-radius, 0, 0);  // from the start
  double turned = 0, last = 0, fastest = 0;
  const double end = cycles * period + 1;
  person.Run(end, [&] {
    const Vector3 from_centre = Pull(person, scenario) - centre;
    ASSERT_NEAR(from_centre.norm(), radius, 1e-10);
    ASSERT_NEAR(from_centre.z(), 0, 1e-10);
    const double angle = std::atan2(from_centre.y(), from_centre.x());
    const double step = std::remainder(angle - last, 2 * std::numbers::pi);
    EXPECT_GE(step, -1e-12);  // counter-clockwise
    turned += step;
    fastest = std::max(fastest, step / 0.001);
    last = angle;
  });
  EXPECT_NEAR(turned, 2 * std::numbers::pi * cycles, 1e-9);
  EXPECT_NEAR(fastest, 2 * std::numbers::pi / period, 1e-6);
  EXPECT_LT(Pull(person, scenario).norm(), 1e-9);  // back at its start
  person.Step();
  EXPECT_EQ(person.output.action, -1);
}

TEST(VirtualOperator, PushRisesStaysAndFalls) {
  Scenario scenario = SpringScenario(2);
  ActionSpec push = MakeActionSpec("push", 1, {"duration=0.5"});
  push.Set("hand=right");
  push.Set("force=[45, 0, 0]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), push};
  Person person(scenario);
  person.Run(1);
  for (int k = 1; k <= 1000; ++k) {
    person.Step();
    const double t = 0.001 * k;
    const double part = std::clamp(std::min(t, 0.74 - t) / 0.12, 0.0, 1.0);
    ASSERT_NEAR(person.Force(1).x(), 45 * part, 1e-9) << k;
    ASSERT_LT(person.Force(0).norm(), 1e-12);
  }
}

TEST(VirtualOperator, SqueezesAlongTheLineBetweenTheHands) {
  Scenario scenario = SpringScenario(2);
  scenario.operator_.hand.internal_force = 8;
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"})};
  Person person(scenario);
  person.Run(1);
  const Vector3 line = person.input.handle[1].X_W.p - person.input.handle[0].X_W.p;
  EXPECT_LT((person.Force(0) - 8 * line.normalized()).norm(), 1e-9);
  EXPECT_LT((person.Force(0) + person.Force(1)).norm(), 1e-12);
}

TEST(VirtualOperator, RegripsWhereTheObjectThenIs) {
  Scenario scenario = QuietScenario(2);
  ActionSpec move = MakeActionSpec("move", 0.5, {"duration=1"});
  move.Set("by=[0, 0, 0.1]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), move,
                               MakeActionSpec("release", 2),
                               MakeActionSpec("grip", 3, {"duration=0.3"})};
  Person person(scenario);
  person.Run(1.9);
  EXPECT_GT(person.Force().norm(), 10);  // the hand pulls, because the handles do not move
  person.Run(0.6);
  EXPECT_EQ(person.output.F_H_W[0].norm() + person.output.F_H_W[1].norm(), 0);
  for (FrameMotion& handle : person.input.handle) handle.X_W.p += Vector3(0.05, -0.02, 0.1);
  person.Run(2);
  EXPECT_EQ(person.output.grip[0], 1);
  EXPECT_LT(person.output.F_H_W[0].norm() + person.output.F_H_W[1].norm(), 1e-9);
}

TEST(VirtualOperator, AHandThatJoinsDoesNotDisturbTheOther) {
  Scenario scenario = SpringScenario(2);
  ActionSpec left = MakeActionSpec("grip", 0, {"duration=0.3"}),
             right = MakeActionSpec("grip", 2, {"duration=0.3"});
  left.Set("hand=left");
  right.Set("hand=right");
  ActionSpec first = MakeActionSpec("move", 1, {"duration=0.5"}), second = first;
  const Vector3 first_by(0, 0.1, 0), second_by(0.2, 0, 0);
  first.Set("by=[0, 0.1, 0]");
  second.start = 3;
  second.Set("by=[0.2, 0, 0]");
  scenario.operator_.script = {left, first, right, second};
  Person person(scenario);
  person.Run(1.9);
  EXPECT_LT((Pull(person, scenario, 0) - first_by).norm(), 1e-9);
  EXPECT_EQ(person.output.grip[1], 0);
  person.Run(0.9);
  EXPECT_LT((Pull(person, scenario, 0) - first_by).norm(), 1e-9);
  EXPECT_EQ(person.output.grip[1], 1);
  EXPECT_LT(person.output.F_H_W[1].norm(), 1e-9);
  person.Run(1);
  EXPECT_LT((Pull(person, scenario, 0) - first_by - second_by).norm(), 1e-9);
  EXPECT_LT((Pull(person, scenario, 1) - second_by).norm(), 1e-9);
}

TEST(VirtualOperator, PutsDownAndReleases) {
  Scenario scenario = SpringScenario(1);
  ActionSpec put_down = MakeActionSpec("put_down", 1, {"duration=2"});
  put_down.Set("by=[0, 0, -0.1]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), put_down};
  Person person(scenario);
  person.Run(2.99);
  EXPECT_EQ(person.output.grip[0], 1);
  EXPECT_NEAR(Pull(person, scenario).z(), -0.1, 1e-6);
  person.Run(0.5);
  EXPECT_EQ(person.output.grip[0], 0);
}

TEST(VirtualOperator, GripsOnlyInRun) {
  Scenario scenario = SpringScenario(1);
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"})};
  Person person(scenario);
  person.input.running = false;
  person.Run(1);
  EXPECT_EQ(person.output.grip[0], 0);
  person.input.running = true;
  person.Run(1);
  EXPECT_EQ(person.output.grip[0], 1);
  person.input.running = false;  // the run stops, so the hand lets go
  person.Run(0.5);
  EXPECT_EQ(person.output.grip[0], 0);
  person.input.running = true;  // a new run: the script starts again
  person.input.run_time = 0;
  person.Run(1);
  EXPECT_EQ(person.output.grip[0], 1);
}

std::vector<Wrench> Record(Person* person) {
  std::vector<Wrench> forces;
  person->Run(3, [&] { forces.push_back(person->output.F_H_W[0] + person->output.F_H_W[1]); });
  return forces;
}

TEST(VirtualOperator, IsTheSameForTheSameSeedAndAfterAReset) {
  Scenario scenario = QuietScenario(2);
  scenario.operator_.hand = HandSpec();
  ActionSpec move = MakeActionSpec("move", 0.5, {"duration=2"});
  move.Set("by=[0.1, 0.1, 0.1]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), move};
  Person one(scenario), two(scenario);
  const std::vector<Wrench> first = Record(&one);
  EXPECT_EQ(first, Record(&two));
  one.self().Reset();
  one.input.run_time = 0;
  EXPECT_EQ(first, Record(&one));
  scenario.seed = 2;
  Person other(scenario);
  EXPECT_NE(first, Record(&other));
}

TEST(VirtualOperator, PaceDriftsButTheWayIsTheSame) {
  Scenario scenario = SpringScenario(1);
  scenario.operator_.hand.speed_drift = 0.06;
  ActionSpec move = MakeActionSpec("move", 1, {"duration=4"});
  move.Set("by=[0.2, 0, 0]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), move};
  double mean = 0, square = 0;
  const int n = 200;
  for (int seed = 0; seed < n; ++seed) {
    scenario.seed = static_cast<std::uint64_t>(seed);
    Person person(scenario);
    person.Run(1);
    double taken = 0;
    while (person.output.action != -1 || taken == 0) {
      person.Step();
      taken += 0.001;
    }
    EXPECT_NEAR(Pull(person, scenario).x(), 0.2, 1e-9);
    mean += taken / n;
    square += taken * taken / n;
  }
  // The mean pace over 4 s of a process with a time constant of 1 s has the variance σ² · 2τ/T² ·
  // (T − τ(1 − e^(−T/τ))).
  const double deviation = 4 * 0.06 * std::sqrt(2.0 / 16 * (4 - (1 - std::exp(-4.0))));
  EXPECT_NEAR(mean, 4, 4 * deviation / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(square - mean * mean), deviation, 0.25 * deviation);
}

// A person holds a 9 kg box with both hands and lifts it by 0.1 m. Meanwhile, a cobot holds the box
// with a spring of 500 N/m; the cobot's effective mass in this direction is 4.3 kg. The result
// contains the largest force of a hand, and the time when it first exceeds 30 N [s].
struct Lift {
  double peak = 0, above_limit = -1;
};

Lift LiftBox(double damping_ratio, std::uint64_t seed) {
  Scenario scenario = QuietScenario(2);
  scenario.operator_.hand = HandSpec();
  scenario.seed = seed;
  ActionSpec move = MakeActionSpec("move", 1, {"duration=4"});
  move.Set("by=[0, 0, 0.1]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), move};
  Person person(scenario);
  const double stiffness = 500, cobot = 4.3, mass = 9 + cobot;
  const double damping = 2 * damping_ratio * std::sqrt(stiffness * cobot);
  double z = 0, v = 0;
  Lift lift;
  person.Run(15, [&] {
    const double force = person.Force(0).z() + person.Force(1).z();
    const double a = (force - stiffness * z - damping * v) / mass;
    v += a * person.input.dt;
    z += v * person.input.dt;
    for (FrameMotion& handle : person.input.handle) {
      handle.X_W.p.z() += v * person.input.dt;
      handle.V_W[2] = v;
      handle.A_W[2] = a;
    }
    lift.peak = std::max(lift.peak, person.Force(0).norm());
    if (lift.above_limit < 0 && lift.peak > 30) lift.above_limit = person.input.run_time;
  });
  return lift;
}

TEST(VirtualOperator, LiftsADampedBoxAndShakesAnUndampedOne) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Lift damped = LiftBox(0.7, seed);
    EXPECT_GT(damped.peak,
              13);  // at rest: 340/(340 · 2 + 500) of the displacement; 14.4 N without overshoot
    EXPECT_LT(damped.peak, 20);
    const Lift undamped = LiftBox(0.02, seed);
    EXPECT_GT(undamped.above_limit, 5);  // the force grows slowly after the lift
    EXPECT_LT(undamped.above_limit, 12);
  }
}

TEST(VirtualOperator, RefusesScriptsThatCannotBeRun) {
  Scenario scenario = SpringScenario(1);
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}),
                               MakeActionSpec("move", 1, {"duration=0"})};
  EXPECT_THROW(MakeVirtualOperator(scenario, HandInertia::kInWrench), InputError);
  scenario.operator_.script[1] = MakeActionSpec("grip", 1, {"hand=middle"});
  try {
    MakeVirtualOperator(scenario, HandInertia::kInWrench);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("script.1.hand"), std::string::npos) << error.what();
  }
  scenario.operator_.script.clear();
  scenario.operator_.hand.visual_delay = 0.7;
  EXPECT_THROW(MakeVirtualOperator(scenario, HandInertia::kInWrench), InputError);
}

}  // namespace
}  // namespace predictor
