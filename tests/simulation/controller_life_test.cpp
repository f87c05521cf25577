// Tests controllers with memory, a wrist sensor, a period and a delay.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/archive.h"
#include "core/error.h"
#include "core/linear_algebra.h"
#include "scenes.h"
#include "simulation/control_timing.h"
#include "simulation/controlled_scene.h"
#include "simulation/world.h"
#include "simulation/wrist_sensor.h"
#include "support/find_plugins.h"

namespace predictor {
namespace {

constexpr double kSubStep = 1e-3;  // [s]

Scenario AdmittanceScene(const std::vector<std::string>& parameters = {}) {
  return FlangeScene("admittance", parameters);
}

WorldInput Push(const Vector3& force) {
  WorldInput input;
  input.present = {true, false};
  input.F_H_W[0].head<3>() = force;
  return input;
}

void RunFor(World* world, const WorldInput& input, double time) {
  for (int k = 0; k < std::lround(time / kSubStep); ++k)
    ASSERT_TRUE(world->Step(input, kSubStep).ok());
}

// ---- the wrist sensor --------------------------------------------------------------------------

// At rest, the load's weight acts on the end-effector, and its lever adds a moment about the
// flange.
TEST(WristSensor, MeasuresTheWeightOfTheLoad) {
  Scenario s = AdmittanceScene();
  s.object.primitive->center_of_mass = {0.1, 0, 0};
  ControlledScene scene(s, EventSequence(s));
  Engine& engine = scene.engine();
  Engine::Values q = engine.positions();
  for (int j = 0; j < 7; ++j)
    q[engine.layout().q[static_cast<std::size_t>(j)]] = scene.posture()[j];
  ASSERT_TRUE(scene.Update(&engine));
  // Holds the joints still, so that the load does not accelerate.
  engine.joint_forces().setZero();
  ASSERT_TRUE(engine.ComputeAccelerations(false));
  Eigen::VectorXd forces(engine.dof());
  engine.Forces(forces);
  engine.joint_forces() = -forces;
  ASSERT_TRUE(engine.ComputeAccelerations(true));
  EXPECT_LT(engine.accelerations().lpNorm<Eigen::Infinity>(), 1e-9);
  const Wrench F = scene.WristWrench(engine);
  const Vector3 weight = {0, 0, -2 * kGravity};
  const Vector3 com = engine.object_com();
  EXPECT_LT((F.head<3>() - weight).norm(), 1e-6);
  EXPECT_LT((F.tail<3>() - (com - scene.end_effector().X_W.p).cross(weight)).norm(), 1e-6);
}

TEST(WristSensor, AddsBiasAndNoiseToAFilteredWrench) {
  WristSensorSpec spec;
  spec.bias = {1, 2, 3, 0.1, 0.2, 0.3};
  spec.noise_force = 0.5;
  spec.cutoff_frequency = 20;
  WristSensor sensor(spec, kSubStep, 5);
  Wrench F = Wrench::Constant(4);
  sensor.Reset(Wrench::Zero());
  EXPECT_EQ(sensor.reading()[2], 3);
  double sum = 0, squares = 0;
  const int count = 20000;
  for (int k = 0; k < count; ++k) {
    sensor.Step(F);
    if (k == 19) {  // compares the step response of the filter after 20 ms
      EXPECT_NEAR(sensor.filtered()[0], 4 * (1 - std::exp(-sensor.cutoff() * 0.02)), 1e-9);
    }
    const double noise = sensor.reading()[0] - sensor.filtered()[0] - 1;
    sum += noise, squares += noise * noise;
  }
  EXPECT_NEAR(sum / count, 0, 0.02);
  EXPECT_NEAR(std::sqrt(squares / count), 0.5, 0.02);
  EXPECT_NEAR(sensor.reading()[5], 4.3, 1e-9);  // torque has no noise
}

// ---- period and delay --------------------------------------------------------------------------

TEST(ControlTiming, HoldsAndDelays) {
  ControlSpec spec;
  spec.rate = 250;
  spec.delay = 0.003;
  ControlTiming timing(spec, kSubStep);
  EXPECT_EQ(timing.period(), 4);
  EXPECT_DOUBLE_EQ(timing.mean_delay(), 0.0045);
  timing.Reset(JointVector::Constant(2, -1));
  JointVector computed = JointVector::Constant(2, -1);
  std::vector<double> acting;
  for (int k = 0; k < 12; ++k) {
    if (timing.is_due()) computed.setConstant(k);
    acting.push_back(timing.Apply(computed)[0]);
  }
  EXPECT_EQ(acting, (std::vector<double>{-1, -1, -1, 0, 0, 0, 0, 4, 4, 4, 4, 8}));
}

TEST(ControlTiming, RefusesPartsOfASubStep) {
  ControlSpec spec;
  spec.rate = 300;
  try {
    ControlTiming timing(spec, kSubStep);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cobot.control.rate is 300 Hz"), std::string::npos)
        << error.what();
  }
  spec = {};
  spec.delay = 0.0005;
  EXPECT_THROW(ControlTiming(spec, kSubStep), InputError);
}

// ---- admittance --------------------------------------------------------------------------------

// Without virtual stiffness, a constant force must move the end-effector at F/D.
TEST(Admittance, MovesAtForceOverDamping) {
  World world(AdmittanceScene({"damping_translation=80"}));
  const Vector3 start = world.state().end_effector.X_W.p;
  RunFor(&world, Push({0, 8, 0}), 1.5);
  const FrameMotion& E = world.state().end_effector;
  EXPECT_NEAR(E.V_W[1], 8.0 / 80, 0.002);
  EXPECT_NEAR(E.V_W[2], 0, 0.002);
  EXPECT_GT(E.X_W.p.y(), start.y() + 0.08);
}

// With virtual stiffness, the displacement must settle at F/K.
TEST(Admittance, SettlesAtForceOverStiffness) {
  World world(AdmittanceScene({"virtual_stiffness.translation=[200, 200, 200]"}));
  const Vector3 start = world.state().end_effector.X_W.p;
  RunFor(&world, Push({0, 0, 10}), 4);
  const Vector3 moved = world.state().end_effector.X_W.p - start;
  EXPECT_NEAR(moved.z(), 10.0 / 200, 0.0015);
  EXPECT_NEAR(moved.y(), 0, 0.0015);
  RunFor(&world, Push({0, 0, 0}), 4);
  EXPECT_LT((world.state().end_effector.X_W.p - start).norm(), 0.0015);
}

// The tare includes the load and the sensor's bias, so nothing may move without hands.
TEST(Admittance, RestsWithoutHands) {
  Scenario s = AdmittanceScene();
  s.cobot.wrist_sensor.bias = {5, -5, 5, 0.5, 0, 0};
  World world(s);
  const Vector3 start = world.state().end_effector.X_W.p;
  RunFor(&world, Push({0, 0, 0}), 2);
  EXPECT_LT((world.state().end_effector.X_W.p - start).norm(), 1e-6);
}

// ---- saved states, reset, linearisation --------------------------------------------------------

// A controller with parameters.
struct WithMemory {
  const char* type;
  std::vector<std::string> parameters = {};
};

// Without hands, these controllers must keep the cobot at rest.
const WithMemory kWithMemory[] = {
    {"admittance"},
    {"hybrid_force_position", {"set_force=[0, 0, 19.62]", "force_integral_gain=2"}},
    {"load_sharing", {"object_mass=2", "share=1", "inertia_share=0.5"}},
    {"minimum_jerk_intention"},
    {"variable_impedance", {"adaptation=intention"}},
    {"plugin", {"library=package://plugins/following_spring.so", "parameters=yielding=0.02"}},
};

std::string TypeOf(const testing::TestParamInfo<WithMemory>& info) { return info.param.type; }

Scenario SceneOf(const WithMemory& controller) {
  test::FindPlugins();
  return FlangeScene(controller.type, controller.parameters);
}

Scenario Everything(const WithMemory& controller) {
  Scenario s = SceneOf(controller);
  s.cobot.control.rate = 500;
  s.cobot.control.delay = 0.002;
  s.cobot.wrist_sensor.noise_force = 0.3;
  return s;
}

class ControllerMemory : public testing::TestWithParam<WithMemory> {};
INSTANTIATE_TEST_SUITE_P(Controllers, ControllerMemory, testing::ValuesIn(kWithMemory), TypeOf);

TEST_P(ControllerMemory, IsInTheSavedState) {
  World a(Everything(GetParam())), b(Everything(GetParam()));
  RunFor(&a, Push({3, 5, -4}), 0.4333);
  std::vector<std::byte> bytes(1 << 16);
  StateArchive save = StateArchive::ToSave(bytes);
  a.Archive(save);
  ASSERT_TRUE(save.ok());
  StateArchive load = StateArchive::ToLoad(std::span(bytes).first(save.used()));
  b.Archive(load);
  ASSERT_TRUE(load.ok());
  RunFor(&a, Push({0, 2, 0}), 0.3);
  RunFor(&b, Push({0, 2, 0}), 0.3);
  EXPECT_EQ(a.state().q, b.state().q);
  EXPECT_EQ(a.state().torque, b.state().torque);
}

TEST_P(ControllerMemory, ReturnsToTheStartOnReset) {
  World a(Everything(GetParam())), b(Everything(GetParam()));
  RunFor(&a, Push({3, 5, -4}), 0.5);
  a.Reset();
  RunFor(&a, Push({0, 2, 0}), 0.3);
  RunFor(&b, Push({0, 2, 0}), 0.3);
  EXPECT_EQ(a.state().q, b.state().q);
}

// After a small push, the state must equal the state of the linear model, which includes all states
// of the sensor, the controller and the delay.
void ExpectLinearMotion(const Scenario& s, double tolerance) {
  World world(s);
  const LinearModel model = world.Linearise();
  const Eigen::Index n = model.A.rows();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  // A matrix exponential gives the exact solution of a step, [x' = A x + B u, u' = 0].
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(n + 1, n + 1);
  const double force = 0.05;  // [N]
  both.topLeftCorner(n, n) = model.A;
  both.topRightCorner(n, 1) = force * model.B.col(1);
  Eigen::MatrixXd step = Eigen::MatrixXd::Identity(n + 1, n + 1), term = step;
  const double h = kSubStep / 64;
  for (int k = 1; k < 8; ++k) {
    term = term * both * h / k;
    step += term;
  }
  for (int k = 0; k < 6; ++k) step = step * step;
  Eigen::VectorXd x = Eigen::VectorXd::Unit(n + 1, n);
  double largest = 0, worst = 0;
  for (int k = 0; k < 400; ++k) {
    ASSERT_TRUE(world.Step(Push({0, force, 0}), kSubStep).ok());
    x = step * x;
    const double predicted = model.C.row(1) * x.head(n);
    largest = std::max(largest, std::abs(predicted));
    worst = std::max(worst, std::abs(world.state().handle[0].V_W[1] - predicted));
  }
  EXPECT_LT(worst, tolerance * largest) << "of " << largest << " m/s";
}

TEST_P(ControllerMemory, IsInTheLinearModel) { ExpectLinearMotion(SceneOf(GetParam()), 0.03); }

TEST(Linearisation, DescribesPeriodAndDelay) {
  Scenario s = AdmittanceScene({"inner_frequency=5"});
  s.cobot.control.delay = 0.004;
  ExpectLinearMotion(s, 0.05);
  s.cobot.control.rate = 250;
  ExpectLinearMotion(s, 0.05);
}

// The test can detect errors in the delay, because the delay changes the slowest decay of an
// oscillation.
TEST(Linearisation, ContainsTheDelay) {
  const auto slowest = [](double delay) {
    Scenario s = AdmittanceScene({"inner_frequency=5"});
    s.cobot.control.delay = delay;
    double rate = -1e9;
    for (const auto& root : EigenvaluesOf(World(s).Linearise().A))
      if (root.imag() > 1) rate = std::max(rate, root.real());
    return rate;
  };
  EXPECT_GT(std::abs(slowest(0.02) - slowest(0)), 1e-2);
}

}  // namespace
}  // namespace predictor
