// Compares the controllers that laboratories use with the closed forms of their laws. The tests
// compute each expected value from the published law.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/random.h"
#include "simulation/controllers/minimum_jerk_estimate.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

constexpr double kMassOfBox = 2;  // of FlangeScene [kg]

struct WrenchCase {
  const char* type;
  std::vector<std::string> parameters;
};

// Returns the force [N] of the hand for a time [s] and a state.
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

// A constant force must move the end-effector at the speed v for which d(v) v = F.
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

// A force rises at the rate r and then falls at the same rate. The motion follows m v̇ + d v = F
// with d = d_0 − α r, then d_0 + α r. The moving mass is the sum of the controller's virtual mass
// and the mass of the box.
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
    const double v_ramp = force / d - slope * m / (d * d);  // the particular solution at t = 0
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

// Position and velocity at time t of a movement that lasts T seconds, as fractions of the
// movement's distance.
struct JerkPoint {
  double x, v;
};
JerkPoint MinimumJerkAt(double t, double T) {
  const double s = std::min(std::max(t / T, 0.0), 1.0);
  return {10 * std::pow(s, 3) - 15 * std::pow(s, 4) + 6 * std::pow(s, 5),
          (30 * std::pow(s, 2) - 60 * std::pow(s, 3) + 30 * std::pow(s, 4)) / T};
}

// During an exact minimum-jerk movement, the estimate must agree with the movement within 2 % after
// a quarter of the movement. After half of the movement, it must agree within 0.5 %. The controller
// notices the movement late, and the movement may begin at any time.
TEST(MinimumJerkEstimate, EqualsAnExactMovement) {
  for (const double T : {0.7, 1.5, 4.0})
    for (const Vector3& distance : {Vector3(0.1, 0, 0), Vector3(-0.2, 0.3, 0.1)}) {
      double numbers[controllers::MovementOnset::kSize] = {};
      controllers::MovementOnset onset(numbers);
      const Vector3 start(1, 2, 3);
      for (int k = 0; k < 1000 * (1 + T); ++k) {
        const double t = 1e-3 * k - 0.5;  // the movement begins after half a second
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

// A hand leads the box along a minimum-jerk movement. The hand's force is the part of the necessary
// force that the assistance does not provide, plus the force of a spring that acts against
// deviations. The controller fades the assistance in from s = 0.1 to 0.3. Returns the hand's mean
// force [N] while the cobot assists fully.
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
// assistance, the hand's force must be almost zero. In faster movements, a larger part of the force
// remains (a quarter if the movement takes 1 s), because the position loop yields a little to the
// hand and the estimate uses the real motion.
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

// ---- controllers that exert a wrench -----------------------------------------------------------

Scenario WithoutFriction(const std::string& type, const std::vector<std::string>& parameters) {
  Scenario s = FlangeScene(type, parameters);
  s.cobot.joint_friction.viscous = {0};
  return s;
}

// At the start, the box stands on a table.
Scenario OnTable(const std::string& type, const std::vector<std::string>& parameters) {
  Scenario s = FlangeScene(type, parameters);
  const ControlledRobot robot(s);
  s.environment.table = TableSpec{};
  s.environment.table->top =
      robot.data.FramePose(*robot.model, robot.end_effector).p - Vector3(0, 0, 0.05);
  return s;
}

// Through a spring, a hand lifts the box to 5 cm above its start, minus the sag of the spring.
// Returns the hand's force at rest [N].
double ForceToHoldInTheAir(const Scenario& s, double duration) {
  World world(s);
  const double table = world.state().end_effector.X_W.p.z();
  double force = 0;
  Guide(&world, duration, [&](const WorldState& state) {
    const FrameMotion& E = state.end_effector;
    force = 1000 * (table + 0.05 - E.X_W.p.z()) - 150 * E.V_W[2];
    return Vector3(0, 0, force);
  });
  EXPECT_GT(world.state().end_effector.X_W.p.z(), table + 0.02);
  EXPECT_LT(world.state().end_effector.V_W.norm(), 5e-4);
  return force;
}

TEST(WrenchControl, SpringsAndCarriedWeightAreTheGradientOfTheEnergy) {
  const std::string load = "object_mass=2", com = "object_center_of_mass=[0.03, 0.02, 0.1]";
  const WrenchCase cases[] = {
      {"load_sharing", {load, com, "share=0.6"}},
      {"virtual_fixtures", {load, com, "guide={type: line, direction: [1, 1, 0]}"}},
      {"virtual_fixtures", {load, com, "guide={type: plane, offset: [0, 0, 0.1]}"}},
      {"hybrid_force_position", {"force_axes=xz", "set_force=[3, 5, 7]"}}};
  RandomStream random(1, "wrench");
  for (const WrenchCase& c : cases) {
    ControlledRobot robot(FlangeScene(c.type, c.parameters));
    JointVector q = robot.posture;
    for (int j = 0; j < 7; ++j) q[j] += 0.2 * random.Normal();
    const double h = 1e-6;
    JointVector gradient(7);
    for (int j = 0; j < 7; ++j) {
      robot.Update(q + h * JointVector::Unit(7, j), JointVector::Zero(7));
      const double ahead = robot.Energy();
      robot.Update(q - h * JointVector::Unit(7, j), JointVector::Zero(7));
      gradient[j] = (ahead - robot.Energy()) / (2 * h);
    }
    robot.Update(q, JointVector::Zero(7));
    const JointVector exerted = robot.Torque() - robot.data.gravity();
    EXPECT_LT((exerted + gradient).norm(), 1e-6 * (1 + gradient.norm())) << c.type;
  }
}

TEST(LoadSharing, LeavesTheRestOfTheWeightToTheHands) {
  for (const double share : {0.0, 0.3, 0.7, 1.0}) {
    const Scenario s = OnTable("load_sharing", {"object_mass=2", "share=" + std::to_string(share)});
    EXPECT_NEAR(ForceToHoldInTheAir(s, 3), (1 - share) * kMassOfBox * kGravity, 0.01) << share;
  }
}

// The hand accelerates the cobot's inertia Λ and the part of the box that the cobot does not move.
TEST(LoadSharing, TakesItsPartOfTheInertialForce) {
  for (const double part : {0.0, 0.5}) {
    const Scenario s = WithoutFriction(
        "load_sharing", {"object_mass=2", "share=1", "inertia_share=" + std::to_string(part),
                         "acceleration_time=0.002", "damping_translation=0", "damping_rotation=0",
                         "stiffness_rotation=0"});
    ControlledRobot robot(s);
    Jacobian J;
    robot.data.FrameJacobian(*robot.model, robot.end_effector, &J);
    const Eigen::MatrixXd Jx = J, to_joints = Solve(robot.data.M(), Jx.transpose());
    Eigen::MatrixXd inertia = Solve(Jx * to_joints, Eigen::MatrixXd::Identity(6, 6));
    inertia.diagonal().head<3>().array() += (1 - part) * kMassOfBox;
    inertia.diagonal().tail<3>().array() += kMassOfBox * 0.1 * 0.1 / 6;
    const double force = 4, duration = 0.05;
    const double a = Solve(inertia, force * Eigen::VectorXd::Unit(6, 1))(1);
    World world(s);
    Guide(&world, duration, [&](const WorldState&) { return Vector3(0, force, 0); });
    EXPECT_NEAR(world.state().end_effector.V_W[1], a * duration, 0.03 * a * duration) << part;
  }
}

// Friction in the joints takes a part of the force, and the integral must replace this part.
TEST(HybridForcePosition, HoldsTheSetForceExactlyInSpiteOfFriction) {
  const auto carried = [](double force, double integral_gain) {
    Scenario s =
        OnTable("hybrid_force_position", {"set_force=[0, 0, " + std::to_string(force) + "]",
                                          "force_integral_gain=" + std::to_string(integral_gain)});
    s.cobot.joint_friction.coulomb = {0.5};
    return kMassOfBox * kGravity - ForceToHoldInTheAir(s, 12);
  };
  for (const double force : {5.0, 12.0}) EXPECT_NEAR(carried(force, 3), force, 0.02);
  EXPECT_GT(std::abs(carried(12, 0) - 12), 0.1);
}

TEST(HybridForcePosition, BoundsItsIntegralAndLeavesTheBoundAtOnce) {
  ControlledRobot robot(
      FlangeScene("hybrid_force_position", {"set_force=[0, 0, 30]", "force_integral_limit=8"}));
  ControllerInput input = robot.Input();
  for (int k = 0; k < 5000; ++k) robot.controller->Advance(input, 1e-3);
  EXPECT_EQ(robot.controller->memory()[2], 8);
  input.F_E_W[2] = -60;  // the load presses on the cobot
  robot.controller->Advance(input, 1e-3);
  EXPECT_NEAR(robot.controller->memory()[2], 8 - 1e-3 * 5 * 30, 1e-12);
}

TEST(HybridForcePosition, HoldsThePositionAlongTheOtherAxes) {
  World world(WithoutFriction("hybrid_force_position",
                              {"set_force=[0, 0, 19.62]", "stiffness_translation=[400, 800, 0]",
                               "damping_translation=80"}));
  const Vector3 start = world.state().end_effector.X_W.p;
  Guide(&world, 3, [](const WorldState&) { return Vector3(6, -8, 0); });
  const Vector3 moved = world.state().end_effector.X_W.p - start;
  EXPECT_NEAR(moved.x(), 6.0 / 400, 1e-4);
  EXPECT_NEAR(moved.y(), -8.0 / 800, 1e-4);
}

// Across a guide, the displacement must be F/K. Along the guide, the speed must be F/D. In a zone,
// the zone's damper is added.
TEST(VirtualFixtures, GuideAcrossAndLeaveFreeAlong) {
  const auto moved = [](const std::string& guide, const std::string& zone, FrameMotion* E) {
    World world(WithoutFriction("virtual_fixtures", {"object_mass=2", "damping_translation=50",
                                                     "guide=" + guide, "zone=" + zone}));
    const Vector3 start = world.state().end_effector.X_W.p;
    Guide(&world, 1.5, [](const WorldState&) { return Vector3(-4, 5, -8); });
    *E = world.state().end_effector;
    return Vector3(E->X_W.p - start);
  };
  FrameMotion E;
  Vector3 x = moved("{type: line, direction: [0, 0.5, 0], stiffness: 1000}", "{}", &E);
  EXPECT_NEAR(x.x(), -4.0 / 1000, 2e-4);
  EXPECT_NEAR(x.z(), -8.0 / 1000, 2e-4);
  EXPECT_NEAR(E.V_W[1], 5.0 / 50, 0.002);
  x = moved("{type: plane, direction: [0, 0, 1], stiffness: 2000}", "{}", &E);
  EXPECT_NEAR(x.z(), -8.0 / 2000, 2e-4);
  EXPECT_NEAR(E.V_W[0], -4.0 / 50, 0.004);  // Coriolis forces are not compensated
  EXPECT_NEAR(E.V_W[1], 5.0 / 50, 0.002);
  moved("{type: line, direction: [0, 1, 0]}", "{radius: 0.3, damping: 150}", &E);
  EXPECT_NEAR(E.V_W[1], 5.0 / (50 + 150), 0.001);
  moved("{type: line, direction: [0, 1, 0]}", "{center: [0, 0.5, 0], radius: 0.2}", &E);
  EXPECT_NEAR(E.V_W[1], 5.0 / 50, 0.002);
}

TEST(VirtualFixtures, RefuseAGuideWithoutDirection) {
  EXPECT_THROW(World(FlangeScene("virtual_fixtures",
                                 {"object_mass=2", "guide={type: line, direction: [0, 0, 0]}"})),
               InputError);
}

}  // namespace
}  // namespace predictor
