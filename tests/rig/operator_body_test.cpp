#include "rig/operator_body.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "rig/person.h"
#include "support/allocation_guard.h"

namespace predictor {
namespace {

// Returns a person of mean strength in front of two handles at the height of the waist.
Scenario Embodied() {
  Scenario scenario = QuietScenario(2);
  scenario.operator_.embodied = true;
  scenario.operator_.body = BodySpec();
  scenario.operator_.stance = StanceSpec();
  return scenario;
}

std::array<FrameMotion, kHands> HandlesAt(const Vector3& middle, double apart = 0.4) {
  std::array<FrameMotion, kHands> handles;
  handles[0].X_W.p = middle + Vector3(0, apart / 2, 0);
  handles[1].X_W.p = middle - Vector3(0, apart / 2, 0);
  return handles;
}

// `middle` is the middle of the handles in the person's frame.
struct StandingBody {
  explicit StandingBody(const Scenario& scenario, const Vector3& middle = {0.4, 0, 1.0})
      : body(scenario), handles(HandlesAt(middle)) {
    const Eigen::AngleAxisd turn(scenario.operator_.stance->facing, Vector3::UnitZ());
    for (FrameMotion& handle : handles)
      handle.X_W = Pose{Vector3::Zero(), Quaternion(turn)} * handle.X_W;
    Run(1, Wrench::Zero());
  }
  void Run(double seconds, const Wrench& each) {
    const int steps = static_cast<int>(std::lround(seconds / 0.001));
    for (int i = 0; i < steps; ++i) {
      body.Step(handles, {true, true}, 0.001);
      body.Feel({each, each});
    }
  }
  OperatorBody body;
  std::array<FrameMotion, kHands> handles;
};

Vector3 RandomForce(RandomStream* random, double size) {
  return size * Vector3(random->Normal(), random->Normal(), random->Normal());
}

TEST(ArmAbility, LargestShareReachesTheLimitAndNoMore) {
  EXPECT_EQ(LargestShare(1, 10, -5, 6), 0.5);
  EXPECT_EQ(LargestShare(1, -12, -5, 6), 0.5);
  EXPECT_EQ(LargestShare(1, 2, -5, 6), 1);
  EXPECT_EQ(LargestShare(1, 0, -5, 6), 1);
  EXPECT_EQ(LargestShare(7, 1, -5, 6), 0);   // the joint is already overloaded
  EXPECT_EQ(LargestShare(7, -2, -5, 6), 1);  // the force relieves the joint
}

TEST(ArmAbility, BalanceEndsWhereTheTippingMomentDoes) {
  const Standing person = {700, 0.05, 0, -0.06, 0.2, 0.2};
  // A person who pushes forward at the height h tips backwards above F = W (x - back) / h.
  const double h = 1.1, most = 700 * (0.05 + 0.06) / h;
  HandForce push = {{0.5, 0, h}, {most / 0.4, 0, 0}};
  EXPECT_NEAR(BalanceSharesOf(person, {&push, 1}).x, 0.4, 1e-12);
  // A vertical force moves the centre of pressure, but is not reduced.
  HandForce both = {{0.5, 0.1, h}, {most / 0.4, 20, 60}};
  both.F.x() *= BalanceSharesOf(person, {&both, 1}).x;
  const double N = 700 + both.F.z();
  const double x = (700 * 0.05 + 0.5 * 60 - h * both.F.x()) / N;
  EXPECT_NEAR(x, -0.06, 1e-12);
}

// When this person lifts, the centre of pressure moves beyond the toes, so the hand cannot pull.
// Sideways, the force reaches W (half_width) / h plus the additional force that the lifted weight
// allows.
TEST(ArmAbility, APersonOnTheToesCanStillPushSideways) {
  const Standing person = {700, 0.19, 0, -0.06, 0.2, 0.15};
  const double h = 0.8, lift = 40;
  const HandForce pull = {{0.55, 0, h}, {-10, 0, lift}};
  EXPECT_EQ(BalanceSharesOf(person, {&pull, 1}).x, 0);
  const HandForce towards_heels = {{0.55, 0, h}, {10, 0, lift}};
  EXPECT_EQ(BalanceSharesOf(person, {&towards_heels, 1}).x, 1);
  const HandForce sideways = {{0.55, 0, h}, {-10, 500, lift}};
  EXPECT_NEAR(500 * BalanceSharesOf(person, {&sideways, 1}).y, (700 + lift) * 0.15 / h, 1e-9);
}

TEST(ArmAbility, ReachIsAShell) {
  const Vector3 shoulder(1, 2, 3);
  EXPECT_NEAR((WithinReach({4, 2, 3}, shoulder, 0.2, 0.7) - Vector3(1.7, 2, 3)).norm(), 0, 1e-12);
  EXPECT_NEAR((WithinReach({1.1, 2, 3}, shoulder, 0.2, 0.7) - Vector3(1.2, 2, 3)).norm(), 0, 1e-12);
  EXPECT_EQ(WithinReach({1.5, 2, 3}, shoulder, 0.2, 0.7), Vector3(1.5, 2, 3));
}

TEST(OperatorBody, ForcesStayWithinStrengthAndBalance) {
  Scenario scenario = Embodied();
  scenario.operator_.body->strength = {0.3, 0.3, 0.3, 0.3};
  const StandingBody person(scenario);
  RandomStream random(1, "force");
  int limited = 0;
  for (int k = 0; k < 200; ++k) {
    std::array<Vector3, kHands> forces = {RandomForce(&random, 60), RandomForce(&random, 60)};
    const auto wanted = forces;
    person.body.LimitForces(person.handles, &forces);
    std::array<HandForce, kHands> acting;
    for (std::size_t hand = 0; hand < kHands; ++hand) {
      acting[hand] = {person.handles[hand].X_W.p, forces[hand]};
      limited += forces[hand] != wanted[hand];
      EXPECT_LE(forces[hand].norm(), wanted[hand].norm() + 1e-12);
    }
    const BalanceShares left = BalanceSharesOf(person.body.standing(), acting);
    EXPECT_GT(std::min(left.x, left.y), 1 - 1e-9);
  }
  EXPECT_GT(limited, 50);
  EXPECT_LT(limited, 400);
}

// If the handles and the forces turn with the person about the vertical, the results for the person
// do not change.
TEST(OperatorBody, LimitsTurnWithThePerson) {
  constexpr double kTurn = 2;  // [rad]
  Scenario scenario = Embodied();
  const StandingBody ahead(scenario);
  scenario.operator_.stance->facing = kTurn;
  const StandingBody turned(scenario);
  const Quaternion turn(Eigen::AngleAxisd(kTurn, Vector3::UnitZ()));
  RandomStream random(2, "turn");
  for (int k = 0; k < 50; ++k) {
    std::array<Vector3, kHands> forces = {RandomForce(&random, 100), RandomForce(&random, 100)};
    std::array<Vector3, kHands> others = {turn * forces[0], turn * forces[1]};
    ahead.body.LimitForces(ahead.handles, &forces);
    turned.body.LimitForces(turned.handles, &others);
    for (std::size_t hand = 0; hand < kHands; ++hand)
      EXPECT_NEAR((others[hand] - turn * forces[hand]).norm(), 0, 1e-6);
  }
}

TEST(OperatorBody, TheStrengthLimitIsThatOfTheJoints) {
  Scenario scenario = Embodied();
  scenario.operator_.body->strength = {0.2, 0.2, 0.2, 0.2};
  const StandingBody person(scenario);
  for (int hand = 0; hand < kHands; ++hand) {
    const ArmAbility& arm = person.body.arm(hand);
    const Vector3 F(0, 0, 500);
    const Vector3 possible = StrengthShare(arm, F) * F;
    ASSERT_LT(possible.z(), 500);
    double closest = 1;
    for (const JointAbility& joint : arm.joints) {
      const double torque = joint.TorqueFor(possible);
      EXPECT_LE(torque, joint.upper + 1e-9);
      EXPECT_GE(torque, joint.lower - 1e-9);
      closest = std::min({closest, joint.upper - torque, torque - joint.lower});
    }
    EXPECT_NEAR(closest, 0, 1e-9);
  }
}

TEST(OperatorBody, FatigueLowersStrengthMonotonically) {
  double before = 1e9;
  for (const double fatigue : {0.0, 0.1, 0.3, 0.6, 0.9}) {
    Scenario scenario = Embodied();
    scenario.operator_.body->fatigue = fatigue;
    const StandingBody person(scenario);
    const ArmAbility& arm = person.body.arm(0);
    EXPECT_NEAR(arm.capacity, 1 - fatigue, 0.01);
    EXPECT_LT(arm.joints[0].upper, before);
    before = arm.joints[0].upper;
  }
}

// The person must tire from a held load according to the published closed form.
TEST(OperatorBody, TiresByTheClosedFormOfTheFatigueModel) {
  StandingBody person(Embodied());
  Wrench lift = Wrench::Zero();
  lift.z() = 40;
  const ArmAbility rested = person.body.arm(0);
  double before = rested.capacity, expected = 1;
  for (int minute = 1; minute <= 3; ++minute) {
    person.Run(60, lift);
    const double now = person.body.arm(0).capacity;
    EXPECT_LT(now, before);
    before = now;
    expected = 1;
    for (int j = 0; j < kJudgedJoints; ++j) {
      const JointAbility& joint = rested.joints[static_cast<std::size_t>(j)];
      const double torque = joint.TorqueFor(lift.head<3>());
      const double load = std::abs(torque) / (torque > 0 ? joint.upper : -joint.lower);
      const auto rates = FatigueRatesOf(j == 0 ? ergonomics::FatigueJoint::kElbow
                                               : ergonomics::FatigueJoint::kShoulder);
      expected = std::min(
          expected, 1 - ergonomics::FatiguedShareUnderConstantLoad(load, 60.0 * minute, rates));
    }
    EXPECT_NEAR(now, expected, 0.01);
  }
}

TEST(OperatorBody, ReachesWithTheTrunkBeforeTheArmsAreStraight) {
  const StandingBody near(Embodied(), {0.35, 0, 1.0}), far(Embodied(), {0.75, 0, 1.0});
  EXPECT_GT(far.body.arm(0).shoulder.x(), near.body.arm(0).shoulder.x() + 0.05);
  const Vector3 away(3, 0.2, 1);
  const Vector3 p = near.body.Reachable(0, away);
  EXPECT_LT((p - near.body.arm(0).shoulder).norm(), 0.8);
  EXPECT_GT((p - near.body.arm(0).shoulder).norm(), 0.5);
  const Vector3 inside = near.handles[0].X_W.p;
  EXPECT_LT((near.body.Reachable(0, inside) - inside).norm(), 1e-12);
}

// Returns a scenario whose operator lifts the object and moves it sideways. `side` is 1 or, for the
// mirrored motion, −1.
Scenario Lifting(double side) {
  Scenario scenario = Embodied();
  ActionSpec move = MakeActionSpec("move", 0.6, {"duration=1"});
  move.Set("by=[0.05, " + std::to_string(0.1 * side) + ", 0.1]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), move};
  return scenario;
}

struct Lifter : Person {
  explicit Lifter(const Scenario& scenario, const Vector3& middle = {0.4, 0, 1.0})
      : Person(scenario) {
    const auto at = HandlesAt(middle, 0.6);
    for (std::size_t i = 0; i < kHands; ++i) input.handle[i] = at[i];
  }
};

TEST(EmbodiedOperator, AMirroredPersonExertsMirroredForces) {
  Lifter left(Lifting(1)), right(Lifting(-1));
  const Vector3 mirror(1, -1, 1);
  double largest = 0;
  for (int k = 0; k < 2000; ++k) {
    left.Step();
    right.Step();
    for (const int hand : {0, 1}) {
      const Vector3 mirrored = right.Force(1 - hand).cwiseProduct(mirror);
      ASSERT_LT((left.Force(hand) - mirrored).norm(), 1e-3) << k;
      largest = std::max(largest, left.Force(hand).norm());
    }
  }
  EXPECT_GT(largest, 5);
}

TEST(EmbodiedOperator, HeightChangesTheForceOfTheSameMotion) {
  Lifter low(Lifting(1), {0.4, 0, 0.8}), high(Lifting(1), {0.4, 0, 1.4});
  low.Run(2);
  high.Run(2);
  EXPECT_GT((low.Force() - high.Force()).norm(), 1);
}

TEST(EmbodiedOperator, AWeakPersonPushesLess) {
  double before = 0;
  for (const double strength : {0.1, 0.2, 1.0}) {
    Scenario scenario = Embodied();
    scenario.operator_.body->strength.fill(strength);
    ActionSpec push = MakeActionSpec("push", 0.6, {"duration=1"});
    push.Set("force=[0, 0, 100]");
    scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), push};
    Lifter person(scenario);
    person.Run(1.2);
    EXPECT_GT(person.Force().norm(), before);
    before = person.Force().norm();
  }
  EXPECT_NEAR(before, HandSpec().max_force, 1e-6);
}

TEST(EmbodiedOperator, UsesNoHeap) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  Lifter person(Lifting(1));
  person.Run(0.1);
  const test::AllocationGuard guard;
  person.Run(2);
  person.input.running = false;
  person.Run(0.1);
  person.input.running = true;
  person.Run(0.5);
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace predictor
