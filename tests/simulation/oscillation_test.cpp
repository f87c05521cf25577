// Compares the requested modes of the cobot with the modes of the linear model and of the
// simulation, without and with a load.
#include <gtest/gtest.h>

#include <complex>

#include "core/linear_algebra.h"
#include "core/text.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Vibration {
  double frequency = 0;  // undamped [Hz]
  double ratio = 0;
};

Vibration ToMode(Complex eigenvalue) {
  return {std::abs(eigenvalue) / (2 * M_PI), -eigenvalue.real() / std::abs(eigenvalue)};
}

std::vector<Vibration> OscillatingModes(const LinearModel& model) {
  std::vector<Vibration> modes;
  for (const Complex& eigenvalue : EigenvaluesOf(model.A)) {
    if (eigenvalue.imag() > 1e-3 * std::abs(eigenvalue)) modes.push_back(ToMode(eigenvalue));
  }
  return modes;
}

// Returns the mode with the largest vertical motion of the left handle, relative to its modal mass.
Vibration VerticalMode(const LinearModel& model) {
  const Modes modes = ModesOf(model.A);
  const Eigen::MatrixXd re = modes.eigenvectors.real(), im = modes.eigenvectors.imag();
  const Eigen::VectorXcd left = (model.C.row(2) + model.C.row(8)) * modes.eigenvectors;
  // The following lines solve the complex equation V right = B in real numbers.
  const Eigen::Index n = re.rows();
  MatrixXd V(2 * n, 2 * n);
  V << re, -im, im, re;
  VectorXd B = VectorXd::Zero(2 * n);
  B.head(n) = model.B.col(2) + model.B.col(8);
  const VectorXd right = Solve(V, B);
  const VectorXd share =
      left.cwiseAbs2().cwiseProduct(right.head(n).cwiseAbs2() + right.tail(n).cwiseAbs2());
  Eigen::Index best = 0;
  share.maxCoeff(&best);
  return ToMode(modes.eigenvalues[best]);
}

// Fits a single mode to equidistant samples of a free decay to rest, x_k = a x_(k−1) + b x_(k−2)
// (Prony's method).
Vibration FitDecay(const std::vector<double>& x, double interval) {
  const auto n = static_cast<Eigen::Index>(x.size()) - 2;
  MatrixXd past(n, 2);
  VectorXd now(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(k);
    past.row(k) << x[i + 1], x[i];
    now[k] = x[i + 2];
  }
  const VectorXd ab = Solve(past.transpose() * past, past.transpose() * now);
  const Complex z = 0.5 * (ab[0] + std::sqrt(Complex(ab[0] * ab[0] + 4 * ab[1])));
  return ToMode(std::log(z) / interval);
}

// Returns the height of the object above its start after a small push on the handles, every 10 ms.
std::vector<double> Decay(const Scenario& s, double duration) {
  World world(s);
  const double rest = world.state().object.X_W.p.z();
  Simulate(&world, Push(s, {0, 0, 1}), 0.1);
  std::vector<double> heights;
  int tick = 0;
  Simulate(&world, HandsOff(s), duration, [&](const WorldState& state) {
    if (++tick % 10 == 0) heights.push_back(state.object.X_W.p.z() - rest);
  });
  return heights;
}

// The load, the spring and the cobot's own inertia determine the frequency of the undamped mode.
TEST(Oscillation, LoadedFrequencyIsThatOfTheDesign) {
  const struct {
    double mass, low, high;  // [kg], [Hz]
  } cases[] = {{9, 0.91, 0.96}, {18, 0.72, 0.75}};
  for (const auto& c : cases) {
    Scenario s = BoxScene(c.mass);
    s.cobot.joint_friction.viscous = {0};
    s.cobot.controller.Set("damping_ratio=0.02");
    // In this posture, the arm is less folded, as it is after sagging, and Λ_zz is 5 to 6 kg. With
    // 18 kg in the default posture, Λ_zz is 8.4 kg, and the frequency of the mode is 0.70 Hz.
    if (c.mass == 18) s.cobot.posture = {0, -0.4, 0, -1.6, 0, 1.2, 0.785};
    const Vibration linear = VerticalMode(World(s).Linearise());
    EXPECT_GT(linear.frequency, c.low);
    EXPECT_LT(linear.frequency, c.high);
    const Vibration simulated = FitDecay(Decay(s, 1.5), 0.01);
    EXPECT_NEAR(simulated.frequency, linear.frequency, 0.01 * linear.frequency);
  }
}

TEST(Oscillation, LoadedFrequencyAndRatioAreThoseOfTheLinearisation) {
  for (const double mass : {9.0, 18.0}) {
    const Scenario s = BoxScene(mass);
    const Vibration linear = VerticalMode(World(s).Linearise());
    const Vibration simulated = FitDecay(Decay(s, 1.5), 0.01);
    EXPECT_NEAR(simulated.frequency, linear.frequency, 0.01 * linear.frequency) << mass;
    EXPECT_NEAR(simulated.ratio, linear.ratio, 0.05 * linear.ratio) << mass;
  }
}

// Without friction, every mode of the cobot alone must have the requested damping ratio, for any
// stiffness and posture.
TEST(Oscillation, CobotAloneShowsTheRatioAskedFor) {
  const char* stiffnesses[] = {"{translation: [5, 5, 500], rotation: [100, 100, 100]}",
                               "{translation: [300, 80, 500], rotation: [20, 60, 5]}",
                               "{translation: [1000, 1000, 1000], rotation: [50, 50, 50]}"};
  const std::vector<std::vector<double>> postures = {{0, -0.3, 0, -2.0, 0, 1.7, 0.785},
                                                     {0.5, 0.4, -0.6, -1.2, 0.3, 1.2, -0.4},
                                                     {-1, -0.8, 0.9, -2.4, 1.1, 2.2, 1.5}};
  for (int k = 0; k < 3; ++k) {
    for (const auto& posture : postures) {
      for (const double ratio : {0.1, 0.7}) {
        Scenario s = EmptyScene();
        s.cobot.posture = posture;
        s.cobot.controller.Set(std::string("stiffness=") + stiffnesses[k]);
        s.cobot.controller.Set("damping_ratio=" + FormatNumber(ratio));
        s.cobot.controller.Set("posture_damping_ratio=" + FormatNumber(ratio));
        const std::vector<Vibration> modes = OscillatingModes(World(s).Linearise());
        ASSERT_EQ(modes.size(), 7U);
        for (const Vibration& mode : modes) EXPECT_NEAR(mode.ratio, ratio, 2e-3 * ratio);
      }
    }
  }
}

TEST(Oscillation, CobotAloneShowsTheRatioInASimulation) {
  for (const double ratio : {0.1, 0.7}) {
    Scenario s = EmptyScene();
    s.cobot.controller.Set("stiffness.translation=[0, 0, 500]");
    s.cobot.controller.Set("stiffness.rotation=[0, 0, 0]");
    s.cobot.controller.Set("damping_ratio=" + FormatNumber(ratio));
    const Vibration mode = FitDecay(Decay(s, 0.5), 0.01);
    EXPECT_NEAR(mode.ratio, ratio, 0.02);
  }
}

TEST(Oscillation, JointImpedanceShowsItsRatio) {
  Scenario s = EmptyScene();
  s.cobot.controller = {"joint_impedance", {}};
  s.cobot.controller.Set("joint_stiffness=[400, 300, 200, 150, 50, 30, 20]");
  s.cobot.controller.Set("joint_damping_ratio=0.4");
  const std::vector<Vibration> modes = OscillatingModes(World(s).Linearise());
  ASSERT_EQ(modes.size(), 7U);
  for (const Vibration& mode : modes) EXPECT_NEAR(mode.ratio, 0.4, 1e-3);
}

// Compares the matrices B and C of the linear model with the world itself. A force acts for one
// tick in the model and in the world, and the resulting twists must agree.
TEST(Linearise, PredictsTheFirstTick) {
  Scenario s = BoxScene(9);
  const LinearModel model = World(s).Linearise();
  for (int i = 0; i < 12; ++i) {
    World world(s);
    WorldInput input = HandsOff(s);
    input.F_H_W[static_cast<std::size_t>(i / 6)][i % 6] = 0.1;
    ASSERT_TRUE(world.Step(input, kTick).ok());
    const VectorXd expected = model.C * model.B.col(i) * 0.1 * kTick;
    VectorXd twists(12);
    twists << world.state().handle[0].V_W, world.state().handle[1].V_W;
    // The test compares one implicit step with the derivative at its start, so the friction of 1
    // N·m·s/rad causes a noticeable difference.
    EXPECT_LT((twists - expected).norm(), 0.1 * expected.norm()) << i;
  }
}

TEST(Linearise, LeavesTheWorldAsItWas) {
  const Scenario s = BoxScene(9);
  World a(s), b(s);
  Simulate(&a, Push(s, {3, 2, 5}), 0.3);
  Simulate(&b, Push(s, {3, 2, 5}), 0.1);
  (void)b.Linearise();
  Simulate(&b, Push(s, {3, 2, 5}), 0.2);
  EXPECT_EQ(a.state().object.X_W.p, b.state().object.X_W.p);
  EXPECT_EQ(a.state().energy, b.state().energy);
}

TEST(Linearise, LeavesAnAbsentHandleAtZero) {
  Scenario s = BoxScene(9);
  s.right_handle.reset();
  const LinearModel model = World(s).Linearise();
  EXPECT_TRUE(model.B.rightCols(6).isZero(0));
  EXPECT_TRUE(model.C.bottomRows(6).isZero(0));
  EXPECT_FALSE(model.B.leftCols(6).isZero(0));
}

}  // namespace
}  // namespace predictor
