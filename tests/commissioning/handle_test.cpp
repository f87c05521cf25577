#include "commissioning/handle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/random.h"
#include "rig/force_sensor.h"

namespace predictor::commissioning {
namespace {

constexpr double kGravity = 9.81;

HandlePayloadSpec Handle() {
  HandlePayloadSpec handle;
  handle.mass = 0.43;
  handle.center_of_mass = {0.006, -0.011, 0.062};
  return handle;
}

// Returns orientations that a person can give to a handle on a robot: level, tilted by 60° to four
// sides, and partly turned over. The sensor itself is mounted at an angle.
std::vector<Quaternion> Tilts(int count, RandomStream* random) {
  std::vector<Vector3> turns = {{0, 0, 0},     {1.05, 0, 0},  {-1.05, 0, 0},  {0, 1.05, 0},
                                {0, -1.05, 0}, {1.9, 0.4, 0}, {0.5, -1.6, 0}, {0.7, 0.7, 1}};
  const Quaternion mounted = RotationFromVector({0.3, -0.2, 0.9});
  std::vector<Quaternion> tilts;
  for (int i = 0; i < count; ++i) {
    const Vector3 by_hand(0.1 * random->Normal(), 0.1 * random->Normal(), 0.1 * random->Normal());
    tilts.push_back(
        RotationFromVector(turns[static_cast<std::size_t>(i) % turns.size()] + by_hand) * mounted);
  }
  return tilts;
}

Vector3 GravityIn(const Quaternion& q_WS) { return q_WS.conjugate() * Vector3(0, 0, -kGravity); }

Wrench WeightIn(const Quaternion& q_WS, const HandlePayloadSpec& handle) {
  FrameMotion S;
  S.X_W.q = q_WS;
  return HandleLoad(handle, S, kGravity);  // the rig's Newton-Euler model
}

struct Truth {
  HandlePayloadSpec handle = Handle();
  Wrench bias = (Wrench() << 1.5, -2, 3, 0.05, -0.08, 0.04).finished();
  Wrench drift = Wrench::Zero();   // [N/s], [N·m/s]
  Wrench wander = Wrench::Zero();  // standard deviation of the bias from pose to pose
};

// Returns the poses that the recorder computes from a noisy sensor. There are ten seconds between
// consecutive poses. `last` receives the final bias.
std::vector<RestingPose> Poses(const Truth& truth, const SensorSpec& spec, int count,
                               std::uint64_t seed, Wrench* last = nullptr) {
  RandomStream random(seed, "poses");
  ForceSensor sensor(spec, Wrench::Zero(), 0.001, RandomStream(seed, "sensor"));
  PoseRecorder recorder(spec);
  std::vector<RestingPose> poses;
  Wrench bias = truth.bias;
  double time = 0;
  for (const Quaternion& q_WS : Tilts(count, &random)) {
    for (int i = 0; i < 6; ++i) bias[i] += truth.wander[i] * random.Normal();
    const Wrench weight = WeightIn(q_WS, truth.handle);
    const JointVector q = JointVector::Constant(6, 0.1);
    sensor.Reset(weight + bias);
    recorder.Begin();
    for (double t = time; !recorder.complete(); t += 0.001) {
      sensor.Step(weight + bias + t * truth.drift);
      recorder.Add(q, GravityIn(q_WS), sensor.reading(), t);
    }
    EXPECT_EQ(recorder.Refusal(), "");
    poses.push_back(recorder.pose());
    if (last) *last = bias + time * truth.drift;
    time += 10;
  }
  return poses;
}

std::string RefusalOf(const std::vector<RestingPose>& poses, const SensorSpec& sensor = {}) {
  try {
    CalibrateHandle(poses, sensor);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

SensorSpec Exact() {
  SensorSpec sensor;
  sensor.noise_force = sensor.noise_torque = sensor.force_resolution = sensor.torque_resolution = 0;
  return sensor;
}

TEST(CalibrateHandle, IsExactWithoutNoise) {
  const Truth truth;
  const HandleCalibration found = CalibrateHandle(Poses(truth, Exact(), 6, 1), Exact());
  EXPECT_NEAR(found.mass.value, truth.handle.mass, 1e-9);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(found.center_of_mass[i].value,
                truth.handle.center_of_mass[static_cast<Eigen::Index>(i)], 1e-9);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(found.bias[i].value, truth.bias[static_cast<Eigen::Index>(i)], 1e-8);
  EXPECT_LT(found.residual.norm(), 1e-8);
}

TEST(CalibrateHandle, SubtractsTheDriftOfAWarmingSensor) {
  Truth truth;
  truth.drift << 0.005, -0.003, 0.004, 1e-4, 2e-4, -1e-4;  // 0.3 N/min
  Wrench last;
  const auto poses = Poses(truth, Exact(), 7, 1, &last);
  const HandleCalibration found = CalibrateHandle(poses, Exact());
  EXPECT_NEAR(found.mass.value, truth.handle.mass, 1e-4);
  EXPECT_LT((found.drift - truth.drift).norm(), 1e-4);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(found.bias[i].value, last[static_cast<Eigen::Index>(i)], 0.003);
}

// Counts how often the interval of each parameter contains the true value, and keeps the largest
// errors.
struct Tally {
  int runs = 0;
  std::array<int, 10> held{};
  double mass = 0, center = 0, bias = 0;  // largest errors [1], [m], [N]

  void Add(const HandleCalibration& found, const Truth& truth, const Wrench& last) {
    ++runs;
    const auto add = [this](std::size_t place, const Estimate& estimate, double value) {
      const double error = std::abs(estimate.value - value);
      held[place] += error <= estimate.half_width;
      return error;
    };
    mass = std::max(mass, add(0, found.mass, truth.handle.mass) / truth.handle.mass);
    for (std::size_t i = 0; i < 3; ++i)
      center = std::max(center, add(1 + i, found.center_of_mass[i],
                                    truth.handle.center_of_mass[static_cast<Eigen::Index>(i)]));
    for (std::size_t i = 0; i < 6; ++i) {
      const double error = add(4 + i, found.bias[i], last[static_cast<Eigen::Index>(i)]);
      if (i < 3) bias = std::max(bias, error);
    }
  }
};

TEST(CalibrateHandle, ReachesItsAccuracyWithANoisySensorAndStatesItsUncertainty) {
  Truth truth;
  truth.drift << 0.002, -0.001, 0.0015, 5e-5, -5e-5, 2e-5;  // 0.1 N/min
  truth.wander << 0.004, 0.004, 0.004, 2e-4, 2e-4, 2e-4;
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Wrench last;
    const auto poses = Poses(truth, SensorSpec(), 6, seed, &last);
    tally.Add(CalibrateHandle(poses, SensorSpec()), truth, last);
  }
  RecordProperty("mass", std::to_string(tally.mass));
  EXPECT_LT(tally.mass, 0.01);
  EXPECT_LT(tally.center, 0.001);
  EXPECT_LT(tally.bias, 0.05);
  int all = 0;
  for (const int held : tally.held) {
    EXPECT_GE(held, 0.88 * tally.runs);
    all += held;
  }
  EXPECT_GE(all, 0.90 * 10 * tally.runs);
  std::printf(
      "largest errors: mass %.2f %%, centre %.2f mm, bias %.3f N; intervals correct: %.1f %%\n",
      100 * tally.mass, 1000 * tally.center, tally.bias, 10.0 * all / tally.runs);
}

TEST(CalibrateHandle, RefusesTooFewPoses) {
  const std::string refusal = RefusalOf(Poses({}, SensorSpec(), 5, 1));
  EXPECT_NE(refusal.find("5 poses are too few. Take at least 6"), std::string::npos) << refusal;
}

TEST(CalibrateHandle, RefusesPosesThatAreAlike) {
  for (const double tilt : {0.0, 0.2, 0.5}) {  // about one axis, by up to 30° in either direction
    std::vector<RestingPose> poses;
    for (int i = 0; i < 8; ++i) {  // a rotation about the vertical does not add tilt
      const Quaternion q =
          RotationFromVector({0, 0, 0.7 * i}) * RotationFromVector({tilt * (i % 3 - 1), 0, 0});
      poses.push_back({10.0 * i, GravityIn(q), WeightIn(q, Handle())});
    }
    EXPECT_NE(RefusalOf(poses).find("too alike"), std::string::npos) << tilt;
  }
}

TEST(CalibrateHandle, NamesThePoseInWhichTheHandleWasTouched) {
  for (std::size_t touched = 0; touched < 7; ++touched) {
    auto poses = Poses({}, SensorSpec(), 7, 3);
    poses[touched].F_S.head<3>() += Vector3(0.3, -0.5, 0.4);
    const std::string refusal = RefusalOf(poses);
    EXPECT_NE(refusal.find("Pose " + std::to_string(touched + 1) + " does not fit"),
              std::string::npos)
        << refusal;
    poses[touched].F_S.head<3>() -= Vector3(0.3, -0.5, 0.4);
    poses[touched].F_S.tail<3>() += Vector3(0.05, 0.03, -0.04);
    EXPECT_NE(RefusalOf(poses).find("Pose " + std::to_string(touched + 1) + " does not fit"),
              std::string::npos);
  }
}

TEST(CalibrateHandle, RefusesReadingsThatNoHandleExplains) {
  auto poses = Poses({}, SensorSpec(), 8, 4);
  auto turned = poses;
  for (std::size_t i = 0; i < 4; ++i)
    turned[i].g_S = RotationFromVector({0.6, 0, 0}) * turned[i].g_S;
  EXPECT_NE(RefusalOf(turned).find("No handle explains"), std::string::npos) << RefusalOf(turned);
  for (RestingPose& pose : poses) pose.F_S *= -1;
  EXPECT_NE(RefusalOf(poses).find("wrong sign"), std::string::npos) << RefusalOf(poses);
}

TEST(PoseRecorder, RefusesMotionAndATrembling) {
  const SensorSpec spec;
  const Vector3 g(0, 0, -kGravity);
  RandomStream random(1, "recorder");
  for (const double moves : {0.0, 0.01}) {
    for (const double trembles : {0.0, 1.0}) {
      PoseRecorder recorder(spec);
      recorder.Begin();
      EXPECT_NE(recorder.Refusal(), "");
      for (int k = 0; !recorder.complete(); ++k) {
        const JointVector q = JointVector::Constant(6, moves * k / PoseRecorder::kReadings);
        Wrench F = 3 * Wrench::Ones();
        for (double& f : F) f += spec.noise_torque * random.Normal();
        F[1] += trembles * std::sin(0.05 * k);
        recorder.Add(q, g, F, 0.001 * k);
      }
      const std::string refusal = recorder.Refusal();
      EXPECT_EQ(refusal.find("moved") != std::string::npos, moves > 0) << refusal;
      EXPECT_EQ(refusal.find("readings vary") != std::string::npos, moves == 0 && trembles > 0)
          << refusal;
    }
  }
}

TEST(WithCalibration, KeepsTheCentreOfAHandleWithoutWeight) {
  HandleCalibration found;
  found.mass = {0.002, 0.001};
  found.center_of_mass[0].value = 3;
  const HandlePayloadSpec after = WithCalibration(Handle(), found);
  EXPECT_EQ(after.mass, 0.002);
  EXPECT_EQ(after.center_of_mass, Handle().center_of_mass);
}

}  // namespace
}  // namespace predictor::commissioning
