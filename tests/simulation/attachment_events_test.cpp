// Tests two events of the attachment: the object breaks loose, or it slips in the grip. Expected
// values are closed forms of the motion, or come from the scene in which the cobot carries the
// object.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/archive.h"
#include "core/error.h"
#include "event_fixtures.h"
#include "simulation/attachment.h"

namespace predictor {
namespace {

constexpr double kMass = 2;  // of the box [kg]

Scenario WithEvent(Scenario s, const EventSpec& event) {
  s.events.push_back(event);
  return s;
}

EventSpec Loose(double after) { return Event("object_breaks_loose", after); }

EventSpec Slips(double after, double force, double torque, double distance = 0.1) {
  return Event("object_slips", after,
               {"slip_force=" + std::to_string(force), "slip_torque=" + std::to_string(torque),
                "slip_distance=" + std::to_string(distance)});
}

Vector3 HandlesMiddle(const WorldState& state) {
  return (state.handle[0].X_W.p + state.handle[1].X_W.p) / 2;
}

Pose ObjectInFlange(const WorldState& state) {
  return state.end_effector.X_W.Inverse() * state.object.X_W;
}

// Returns the distance of a fall with acceleration a after n steps of the semi-implicit Euler
// method. This distance differs from a t²/2 by a t dt/2.
double Fall(double a, int n) { return a * kTick * kTick * n * (n + 1) / 2; }

// ---- the object breaks loose ------------------------------------------------------------------

TEST(BreaksLoose, TheObjectFallsFreely) {
  World world(WithEvent(RigidBox(), Loose(0.1)));
  const WorldInput input = HandsOff(RigidBox());
  RunWith(&world, input, 0.1);
  const Vector3 start = world.state().object.X_W.p;
  for (int n = 1; n <= 300; ++n) {
    ASSERT_TRUE(world.Step(input, kTick).ok());
    const Vector3 moved = world.state().object.X_W.p - start;
    ASSERT_NEAR(moved.z(), -Fall(kGravity, n), 1e-8) << n;
    ASSERT_LT(moved.head<2>().norm(), 1e-8) << n;
  }
  EXPECT_LT(world.state().object.V_W.tail<3>().norm(), 1e-7);
  EXPECT_NE(world.state().events, 0);
}

// In the step after its release, a rotating and swinging object must have its momentum before the
// release plus the impulse of its weight. The cobot must accelerate as its own model demands.
TEST(BreaksLoose, KeepsTheMomentumOfObjectAndCobot) {
  for (const bool fixed : {false, true}) {
    Scenario s = fixed ? RigidBox() : BoxScene(kMass);
    World world(WithEvent(s, Loose(0.3)));
    WorldInput push = Push(s, {6, -4, 9});
    push.F_H_W[1] << 0, 3, -5, 0.3, 0.2, -0.1;
    RunWith(&world, push, 0.3);
    const WorldState before = world.state();
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
    const WorldState after = world.state();
    ASSERT_GT(before.object.V_W.norm(), 0.05);
    const Vector3 gained = after.object.V_W.head<3>() - before.object.V_W.head<3>();
    EXPECT_LT((gained - Vector3(0, 0, -kGravity * kTick)).norm(),
              1e-10);  // O is the centre of mass
    const Vector3 size = s.object.primitive->size.cwiseAbs2();
    const Vector3 moments =
        kMass / 12 * Vector3(size[1] + size[2], size[0] + size[2], size[0] + size[1]);
    const auto spin = [&](const WorldState& state) -> Vector3 {
      const Matrix3 R = state.object.X_W.R();
      return R * moments.asDiagonal() * R.transpose() * state.object.V_W.tail<3>();
    };
    EXPECT_LT((spin(after) - spin(before)).norm(), 1e-4 * spin(before).norm());
    ControlledRobot robot(s);
    robot.Update(before.q, before.v);
    const Eigen::MatrixXd M = robot.data.M();
    const Eigen::MatrixXd implicit = M + kTick * Eigen::MatrixXd::Identity(7, 7);
    const Eigen::VectorXd alone =
        implicit.llt().solve(after.torque - robot.data.bias() - before.v);  // 1 N·m·s/rad
    EXPECT_LT((after.v - before.v - kTick * alone).norm(), 1e-9);
  }
}

// Two hands of stiffness k hold the handles at their initial places, so z = −(m g / 2 k) (1 − cos ω
// t).
TEST(BreaksLoose, TheObjectSwingsOnTheSpringsOfTwoHands) {
  const Scenario s = WithEvent(RigidBox(), Loose(0.1));
  constexpr double kSpring = 400;  // [N/m]
  const double omega = std::sqrt(2 * kSpring / kMass), sag = kMass * kGravity / (2 * kSpring);
  World world(s);
  WorldInput input = HandsOff(s);
  RunWith(&world, input, 0.1);
  const WorldState start = world.state();
  double lowest = 0;
  for (int n = 1; n <= 700; ++n) {
    for (std::size_t h = 0; h < kHands; ++h)
      input.F_H_W[h].head<3>() = kSpring * (start.handle[h].X_W.p - world.state().handle[h].X_W.p);
    ASSERT_TRUE(world.Step(input, kTick).ok());
    const double z = (HandlesMiddle(world.state()) - HandlesMiddle(start)).z();
    // The semi-implicit Euler method of the engine is half a step ahead.
    ASSERT_NEAR(z, -sag * (1 - std::cos(omega * n * kTick)), 0.6 * sag * omega * kTick) << n;
    lowest = std::min(lowest, z);
  }
  EXPECT_NEAR(lowest, -2 * sag, 0.01 * sag);
}

// The springs of the controller carried the weight of the object, so the cobot rises when the
// object is gone.
TEST(BreaksLoose, TheCobotRisesToItsOwnEquilibrium) {
  World world(WithEvent(RigidBox(), Loose(0)));
  const double before = world.state().end_effector.X_W.p.z();
  RunWith(&world, HandsOff(RigidBox()), 6);
  EXPECT_NEAR(world.state().end_effector.X_W.p.z() - before, kMass * kGravity / 500, 3e-4);
}

// The cobot's wrist sensor was tared while the cobot held the load. The cobot feels the loss of the
// load as an upward force and yields to it with the speed F / D.
TEST(BreaksLoose, AnAdmittanceCobotYieldsToTheLostWeight) {
  Scenario s = RigidBox();
  s.cobot.controller = {"admittance", {}};
  World world(WithEvent(s, Loose(0.1)));
  RunWith(&world, HandsOff(s), 0.8);
  EXPECT_NEAR(world.state().end_effector.V_W.z(), kMass * kGravity / 60, 0.02);
}

// In a scene without contacts, the object's centre of mass must come to rest on the floor, which
// acts as a spring with a frequency of 30 rad/s.
TEST(BreaksLoose, NoFallIsEndless) {
  for (const bool floor : {false, true}) {
    Scenario s = WithEvent(RigidBox(), Loose(0));
    s.environment.floor = floor;
    World world(s);
    RunWith(&world, HandsOff(s), 4);
    const double height = world.state().object.X_W.p.z();
    EXPECT_NEAR(height, floor ? 0.1 : -kGravity / (30 * 30), floor ? 2e-3 : 1e-6);
    EXPECT_LT(world.state().object.V_W.norm(), 1e-3);
  }
}

TEST(BreaksLoose, BelowTheFloorTheFallEndsOneMetreFurtherDown) {
  Scenario s = WithEvent(RigidBox(), Loose(0));
  s.cobot.base.xyz.z() = -2;
  World world(s);
  const double start = world.state().object.X_W.p.z();
  ASSERT_LT(start, -0.5);
  RunWith(&world, HandsOff(s), 4);
  EXPECT_NEAR(world.state().object.X_W.p.z(), start - 1 - kGravity / (30 * 30), 1e-6);
}

// ---- the object slips -------------------------------------------------------------------------

// With closed brakes, the flange stays in place, and the grip carries a part of the weight that is
// equal to the grip's limit.
TEST(Slips, TheObjectSlidesWithTheForceBeyondTheLimit) {
  constexpr double kLimit = 15;  // [N]
  const double a = kGravity - kLimit / kMass;
  Scenario s = WithEvent(RigidBox(), Slips(0.1, kLimit, 100));
  s.events.push_back(Event("brakes_close"));
  World world(s);
  RunWith(&world, HandsOff(s), 0.1);
  const Pose start = world.state().object.X_W;
  const double v = world.state().object.V_W.z();  // the brakes creep
  EXPECT_LT(std::abs(v), 2e-3);
  for (int n = 1; n <= 200; ++n) {
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
    const double fallen = start.p.z() + v * n * kTick - world.state().object.X_W.p.z();
    ASSERT_NEAR(fallen, Fall(a, n), 0.002 * Fall(a, n) + 1e-6) << n;
  }
  EXPECT_LT(RotationError(world.state().object.X_W.q, start.q).norm(), 1e-3);
}

// A pair of forces at the handles rotates the box about the vertical axis of its grip.
TEST(Slips, TheObjectTurnsWithTheTorqueBeyondTheLimit) {
  constexpr double kForce = 5, kLimit = 1;  // [N], [N·m]
  Scenario s = WithEvent(RigidBox(), Slips(0.1, 1000, kLimit));
  s.events.push_back(Event("brakes_close"));
  World world(s);
  RunWith(&world, HandsOff(s), 0.1);
  const Pose start = world.state().object.X_W;
  const double w = world.state().object.V_W[5];
  const double inertia = kMass * (0.26 * 0.26 + 0.38 * 0.38) / 12;
  const double a = (kForce * 0.38 - kLimit) / inertia;
  WorldInput input = HandsOff(s);
  for (int n = 1; n <= 150; ++n) {
    const Vector3 across = world.state().object.X_W.q * Vector3(kForce, 0, 0);
    input.F_H_W[0].head<3>() = -across;
    input.F_H_W[1].head<3>() = across;
    ASSERT_TRUE(world.Step(input, kTick).ok());
    const Vector3 turned = RotationError(world.state().object.X_W.q, start.q);
    ASSERT_NEAR(std::abs(turned.z() - w * n * kTick), Fall(a, n), 0.01 * Fall(a, n) + 1e-6) << n;
  }
  EXPECT_LT((world.state().object.X_W.p - start.p).norm(), 1e-3);
}

// Below the limits of the grip, the grip must hold the object in place. With the same inputs, the
// motion must be the same as with the rigid attachment, apart from the error of the engine's steps.
// The error depends on the coordinates, which are different in the two scenes. It shifts each
// motion by at most about half a step.
TEST(Slips, BelowTheLimitNothingMoves) {
  for (const char* controller : {"", "admittance"}) {
    for (const JointType joint : {JointType::kFixed, JointType::kSpherical}) {
      Scenario s = BoxScene(kMass);
      s.object.attachment.joint = joint;
      s.object.attachment.damping = joint == JointType::kSpherical ? 0.5 : 0;
      if (*controller != 0) s.cobot.controller = {controller, {}};
      World gripped(WithEvent(s, Slips(0.1, 60, 20))), carried(s);
      const Vector3 top(0, 0, 0.1);  // the attachment, in O
      const Pose place = ObjectInFlange(gripped.state());
      double apart = 0, fastest = 0, slid = 0, turned = 0;
      for (int k = 0; k < 1500; ++k) {
        WorldInput push = HandsOff(s);
        const double t = k * kTick;
        push.F_H_W[0] << 4 * std::sin(7 * t), -3 * std::sin(3 * t), 5 * std::sin(5 * t), 0, 0.2, 0;
        push.F_H_W[1] << -2 * std::sin(4 * t), 3 * std::sin(2 * t), 4 * std::sin(9 * t), 0.1, 0, 0;
        ASSERT_TRUE(gripped.Step(push, kTick).ok());
        ASSERT_TRUE(carried.Step(push, kTick).ok());
        const WorldState &now = gripped.state(), &rigid = carried.state();
        const bool same = now.object.V_W == rigid.object.V_W;
        ASSERT_TRUE(same || k >= 100) << k;  // the same scene until the event
        apart = std::max(apart, (now.object.X_W.p - rigid.object.X_W.p).norm());
        fastest = std::max(fastest, rigid.object.V_W.head<3>().norm());
        const Pose X_EO = ObjectInFlange(now);
        slid = std::max(slid, (X_EO * top - place * top).norm());
        turned = std::max(turned, RotationError(X_EO.q, place.q).norm());
      }
      SCOPED_TRACE(std::string(controller) + " " + std::to_string(static_cast<int>(joint)));
      EXPECT_LT(slid, 1e-7);
      EXPECT_TRUE(turned < 1e-6 || joint == JointType::kSpherical) << turned;
      EXPECT_GT(fastest, 0.05);
      EXPECT_LT(apart, fastest * kTick);
    }
  }
}

// Coulomb friction in the joints and the contact with a table must react to the grip in the same
// step.
TEST(Slips, FrictionAndContactDoNotMoveTheGrip) {
  Scenario s = RigidBox();
  s.cobot.joint_friction.coulomb = {2};
  s.environment.table = TableSpec{};
  World still(s);
  s.environment.table->top = still.state().object.X_W.p - Vector3(0, 0, 0.1);
  World world(WithEvent(s, Slips(0.1, 200, 60)));
  const Pose place = ObjectInFlange(world.state());
  double slid = 0, turned = 0;
  for (int k = 0; k < 1500; ++k) {
    const double t = k * kTick;
    const Vector3 force(6 * std::sin(7 * t), -5 * std::sin(3 * t), 20 * std::sin(5 * t));
    ASSERT_TRUE(world.Step(Push(s, force), kTick).ok());
    const Pose X_EO = ObjectInFlange(world.state());
    slid = std::max(slid, (X_EO.p - place.p).norm());
    turned = std::max(turned, RotationError(X_EO.q, place.q).norm());
  }
  EXPECT_LT(slid, 1e-5);
  EXPECT_LT(turned, 1e-4);
}

TEST(Slips, TheGripHoldsAgainAfterTheEvent) {
  for (const JointType joint : {JointType::kFixed, JointType::kSpherical}) {
    Scenario s = BoxScene(kMass);
    s.object.attachment.joint = joint;
    s = WithEvent(s, Slips(0.1, 15, 100));
    s.events[0].duration = 0.1;
    World world(s);
    const Vector3 top(0, 0, 0.1);  // the attachment, in O
    const Vector3 first = ObjectInFlange(world.state()) * top;
    RunWith(&world, HandsOff(s), 0.3);
    const Vector3 place = ObjectInFlange(world.state()) * top;
    EXPECT_GT((place - first).norm(), 0.008);
    for (int k = 0; k < 500; ++k) {
      ASSERT_TRUE(world.Step(Push(s, {2, 1, 3}), kTick).ok());
      ASSERT_LT((ObjectInFlange(world.state()) * top - place).norm(), 1e-6) << k;
    }
  }
}

// With closed brakes, the speed after the event is v₀ + (g − F₀/m) t − r t² / 2m until the object
// rests, because the grip's force F₀ grows at the rate r.
TEST(Slips, TheGripTightensWithoutAJolt) {
  constexpr double kLimit = 15;  // [N]
  Scenario s = WithEvent(RigidBox(), Slips(0.1, kLimit, 100));
  s.events[0].duration = 0.1;
  s.events.push_back(Event("brakes_close"));
  World world(s);
  RunWith(&world, HandsOff(s), 0.2);
  const double v0 = -world.state().object.V_W.z(), rate = LimitedGrip::kForceRate / kMass;
  const double a = kGravity - kLimit / kMass;
  ASSERT_NEAR(v0, 0.1 * a, 0.003);
  const double rest = (a + std::sqrt(a * a + 2 * rate * v0)) / rate;
  for (int n = 1; n * kTick < rest - 0.001; ++n) {
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
    const double t = n * kTick;
    // During a step, the grip's force may already have the value that belongs to the end of the
    // step.
    EXPECT_NEAR(-world.state().object.V_W.z(), v0 + a * t - rate * t * t / 2, rate * kTick * t)
        << n;
  }
  RunWith(&world, HandsOff(s), 0.003);
  EXPECT_LT(std::abs(world.state().object.V_W.z()), 2e-3);  // the brakes creep
}

// A grip without any force or torque is open. When the grip closes, it must grip the object where
// the object is at that time.
TEST(Slips, AnOpenGripClosesWhereTheObjectIs) {
  Scenario s = WithEvent(RigidBox(), Slips(0.1, 0, 0, 1));
  s.events[0].duration = 0.1;
  s.events.push_back(Event("brakes_close"));
  World world(s);
  RunWith(&world, Push(s, {0, 3, 0}), 0.2);
  Vector3 v = world.state().object.V_W.head<3>(), w = world.state().object.V_W.tail<3>();
  EXPECT_NEAR(v.z(), -kGravity * 0.1, 0.003);
  const double longest = 0.3;  // time in which the grip must stop the object [s]
  for (int k = 0; k < longest / kTick; ++k) {
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
    const WorldState& now = world.state();
    const double force = std::min(LimitedGrip::kForceRate * (k + 1) * kTick, 200.0);
    EXPECT_LT((now.object.V_W.head<3>() - v).norm(), (force / kMass + kGravity) * kTick) << k;
    v = now.object.V_W.head<3>(), w = now.object.V_W.tail<3>();
  }
  EXPECT_LT(v.norm() + w.norm(), 1e-2);
  const Pose place = ObjectInFlange(world.state());
  RunWith(&world, HandsOff(s), 0.2);
  EXPECT_LT((ObjectInFlange(world.state()).p - place.p).norm(), 1e-6);
}

// After the object has slid out of the grip, only gravity may accelerate it.
TEST(Slips, TheObjectLeavesTheGripBeyondItsReach) {
  Scenario s = WithEvent(RigidBox(), Slips(0, 15, 100, 0.02));
  s.events.push_back(Event("brakes_close"));
  World world(s);
  const double start = world.state().object.X_W.p.z();
  while (start - world.state().object.X_W.p.z() < 0.0205)
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
  const double v = world.state().object.V_W.z();
  EXPECT_NEAR(v, -std::sqrt(2 * (kGravity - 15 / kMass) * 0.0205), 0.02);
  RunWith(&world, HandsOff(s), 0.1);
  EXPECT_NEAR(world.state().object.V_W.z(), v - kGravity * 0.1, 1e-9);
}

// A sliding object loses energy, so the grip must never drive it.
TEST(Slips, TheGripDissipates) {
  Scenario s = RigidBox();
  s.environment.gravity = 0;
  s = WithEvent(s, Slips(0.2, 3, 0.05, 1));
  World world(s);
  RunWith(&world, Push(s, {10, 8, 6}), 0.2);
  double energy = 1e9;
  for (int k = 0; k < 500; ++k) {
    ASSERT_TRUE(world.Step(HandsOff(s), kTick).ok());
    EXPECT_LT(world.state().energy, energy + 1e-6) << k;
    energy = world.state().energy;
  }
}

// ---- saved state, heap, bad input -------------------------------------------------------------

// In direct mode, the hands' masses are part of the scene. With these masses, the object breaks
// loose. The state is saved and loaded in both scenes, and the run starts again after a reset. All
// of this must be repeatable bit for bit.
TEST(AttachmentEvents, ContinueBitForBitWithTheMassesOfHands) {
  Scenario s = RigidBox();
  s.mode = Mode::kDirect;
  s.events = {Event("object_slips", 0.05, {"slip_force=12", "slip_torque=0.1"}), Loose(0.15)};
  WorldInput input = Push(s, {1, 2, 3});
  input.hand_mass = {0.7, 0.4};
  for (const double saved_at : {0.02, 0.1, 0.2}) {
    World world(s), other(s);
    RunWith(&other, input, 0.12);  // leaves traces that the loaded state must replace
    RunWith(&world, input, saved_at);
    CopyState(&world, &other);
    for (int round = 0; round < 2; ++round) {
      RunWith(&world, input, 0.25);
      RunWith(&other, input, 0.25);
      EXPECT_EQ((world.state().q - other.state().q).norm(), 0) << saved_at;
      EXPECT_EQ((world.state().object.X_W.p - other.state().object.X_W.p).norm(), 0) << saved_at;
      EXPECT_EQ((world.state().object.V_W - other.state().object.V_W).norm(), 0) << saved_at;
      world.Reset();
      other.Reset();
    }
  }
}

TEST(AttachmentEvents, TakeNothingFromTheHeap) {
  Scenario s = RigidBox();
  s.environment.floor = true;
  s.events = {Slips(0.05, 12, 0.1), Loose(0.3)};
  s.events[0].duration = 0.2;
  ExpectNoHeap(s, {1, 2, 3}, 800);
}

// A light object spins between stiff couplings after its release. The object's motion must neither
// diverge nor become NaN.
TEST(AttachmentEvents, KeepALightObjectInTheCouplingFinite) {
  for (const bool slips : {false, true}) {
    Scenario s = RigidBox();
    s.object.primitive->mass = 0.05;
    s = WithEvent(s, slips ? Slips(0.05, 0.2, 0.01) : Loose(0.05));
    World world(s);
    WorldInput input = Push(s, {0.5, -0.3, 0.2});
    input.coupled = true;
    input.handle = world.state().handle;
    RunWith(&world, input, 2);
    for (std::size_t h = 0; h < kHands; ++h)
      EXPECT_LT((world.state().handle[h].X_W.p - input.handle[h].X_W.p).norm(),
                s.coupling.deadband + 0.01);
  }
}

std::string Error(const Scenario& s) {
  try {
    World world(s);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(AttachmentEvents, ThatAreImpossibleAreRefused) {
  for (const JointType joint : {JointType::kRevolute, JointType::kPrismatic}) {
    Scenario s = BoxScene(kMass);
    s.object.attachment.joint = joint;
    EXPECT_EQ(
        Error(WithEvent(s, Slips(0, 20, 2))),
        "events.0.event is object_slips, but only a fixed or a spherical attachment can slip. "
        "Change object.attachment.joint, or use object_breaks_loose.");
  }
  Scenario s = WithEvent(RigidBox(), Loose(0));
  s.events[0].duration = 2;
  EXPECT_EQ(Error(s),
            "events.0.event is object_breaks_loose with a duration, but an object that broke loose "
            "does not return to the cobot. Remove the duration, or use object_slips.");
  EXPECT_NE(Error(WithEvent(RigidBox(), Slips(0, -1, 2))).find("events.0.slip_force"),
            std::string::npos);
  EXPECT_NE(Error(WithEvent(RigidBox(), Slips(0, 1, 2, 0))).find("events.0.slip_distance"),
            std::string::npos);
}

// A revolute or prismatic attachment must open in the same way.
TEST(BreaksLoose, FromEveryJoint) {
  for (const JointType joint : {JointType::kRevolute, JointType::kPrismatic}) {
    Scenario s = BoxScene(kMass);
    s.object.attachment.joint = joint;
    if (joint == JointType::kRevolute) s.object.attachment.axis = {0, 1, 0};
    s.object.attachment.range = {-0.05, 0.05};
    World world(WithEvent(s, Loose(0.1)));
    RunWith(&world, HandsOff(s), 0.1);
    const double start = world.state().object.X_W.p.z();
    RunWith(&world, HandsOff(s), 0.2);
    EXPECT_NEAR(world.state().object.X_W.p.z() - start, -Fall(kGravity, 200), 1e-7);
  }
}

}  // namespace
}  // namespace predictor
