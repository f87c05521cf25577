#include "sensing/hand_estimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "core/motion.h"
#include "core/random.h"
#include "models/robot.h"
#include "rig/arms.h"
#include "rig/rig.h"
#include "sensing/motion_differentiator.h"
#include "support/allocation_guard.h"

namespace predictor {
namespace {

// An arm of the rig, and the steps of the emulator that estimate the hand's wrench.
class Bench {
 public:
  // `assumed` is the sensor and the handle that the estimator assumes, or nullptr for the true
  // ones.
  explicit Bench(const Scenario& scenario, std::unique_ptr<Operator> person = nullptr,
                 const ArmSpec* assumed = nullptr)
      : dt_(1 / scenario.rate),
        spec_(*scenario.device.left),
        rig_(scenario, ArmStart(1), std::move(person)),
        model_(RobotModel::Load({spec_.model, {}, spec_.remove_links, spec_.base.X_RB()})),
        data_(*model_),
        frame_(model_->Frame(spec_.end_effector)),
        differentiator_(dt_),
        estimator_((assumed ? assumed : &spec_)->sensor, (assumed ? assumed : &spec_)->payload,
                   spec_.handle.ToPose(), scenario.environment.gravity, dt_) {
    Step(JointVector::Zero(7));
  }

  void Step(const JointVector& v) {
    DeviceCommand command;
    command.state = RunState::kRun;
    command.v[0] = v;
    rig_.Step(command, dt_);
    rig_.Read(&sample_);
    data_.UpdateKinematics(*model_, sample_.arms[0].q, sample_.arms[0].v);
    motion_ = data_.MotionOf(*model_, frame_, differentiator_.Update(sample_.arms[0]));
    status_ = estimator_.Update(sample_.arms[0], motion_, &hand_);
  }

  Status Tare(int samples) {
    estimator_.BeginTare();
    for (int k = 0; k < samples; ++k) {
      Step(JointVector::Zero(7));
      const Status status = estimator_.Tare(sample_.arms[0], motion_.X_W);
      if (!status.ok()) return status;
    }
    return estimator_.FinishTare();
  }

  const Wrench& F() const { return hand_.F_H_W; }
  Status status() const { return status_; }
  HandEstimator& estimator() { return estimator_; }
  ArmSample& sample() { return sample_.arms[0]; }
  const FrameMotion& motion() const { return motion_; }
  // Returns the inertial force of the handle in W, which is its mass times the acceleration of its
  // centre of mass.
  Vector3 InertialForce() const {
    const FrameMotion& H = rig_.true_handles()[0];
    const Pose X_HS = spec_.handle.ToPose().Inverse() * spec_.sensor.pose.ToPose();
    return spec_.payload.mass *
           MotionOfFixed(H, {X_HS * spec_.payload.center_of_mass, {1, 0, 0, 0}}).A_W.head<3>();
  }

 private:
  double dt_;
  ArmSpec spec_;
  Rig rig_;
  std::shared_ptr<const RobotModel> model_;
  RobotData data_;
  FrameId frame_;
  MotionDifferentiator differentiator_;
  HandEstimator estimator_;
  DeviceSample sample_;
  FrameMotion motion_;
  HandWrench hand_;
  Status status_;
};

JointVector Wave(double t, double frequency, double amplitude) {
  const double w = 2 * std::numbers::pi * frequency;
  JointVector v(7);
  for (int j = 0; j < 7; ++j) v[j] = amplitude * std::sin(w * t) * (j % 2 == 0 ? 1 : -0.7);
  return v;
}

TEST(HandEstimator, StaticResidualIsSmallInAnyPosture) {
  Bench bench(ArmScenario(1));
  ASSERT_TRUE(bench.Tare(1000).ok());
  RandomStream random(5, "postures");
  double turned = 0;
  for (int posture = 0; posture < 6; ++posture) {
    const Quaternion before = bench.motion().X_W.q;
    JointVector v(7);
    for (int j = 0; j < 7; ++j) v[j] = random.Uniform() - 0.5;
    for (int k = 0; k < 700; ++k) bench.Step(v);
    for (int k = 0; k < 700; ++k) bench.Step(JointVector::Zero(7));
    turned += RotationError(bench.motion().X_W.q, before).norm();
    Wrench mean = Wrench::Zero(), squares = Wrench::Zero();
    double worst = 0;
    const int n = 1000;
    for (int k = 0; k < n; ++k) {
      bench.Step(JointVector::Zero(7));
      mean += bench.F() / n;
      squares += bench.F().cwiseProduct(bench.F()) / n;
      worst = std::max(worst, bench.F().head<3>().norm());
    }
    EXPECT_LT(worst, 0.3);  // bounds every single sample, including noise
    EXPECT_LT(std::sqrt(squares.tail<3>().sum()), 0.02);
    EXPECT_LT(mean.head<3>().norm(), 0.02);
    EXPECT_LT(mean.tail<3>().norm(), 0.003);
  }
  EXPECT_GT(turned, 1);  // the direction of the weight did change in the sensor [rad]
}

// Returns the part of the residual force that moves with the arm, divided by the inertial load [1].
// The residual is evaluated at the frequency of the motion and at twice this frequency, where the
// centripetal acceleration and the rotating weight appear.
double MovingResidual(const Scenario& scenario, const ArmSpec& assumed, double frequency) {
  Bench bench(scenario, nullptr, &assumed);
  EXPECT_TRUE(bench.Tare(500).ok());
  const double amplitude = 0.4 / std::max(1.0, frequency);  // [rad/s]
  const double w = 2 * std::numbers::pi * frequency;
  const int settle = static_cast<int>(scenario.rate), n = 4 * settle;  // whole periods
  Eigen::Matrix<std::complex<double>, 3, 2> residual, load;
  residual.setZero();
  load.setZero();
  for (int k = 0; k < settle + n; ++k) {
    const double t = k / scenario.rate;
    bench.Step(Wave(t, frequency, amplitude));
    if (k < settle) continue;
    for (const int harmonic : {1, 2}) {
      const std::complex<double> turn = std::exp(std::complex<double>(0, -harmonic * w * t));
      residual.col(harmonic - 1) += 2.0 / n * turn * bench.F().head<3>();
      load.col(harmonic - 1) += 2.0 / n * turn * bench.InertialForce();
    }
  }
  return residual.norm() / load.norm();
}

double MovingResidual(const Scenario& scenario, double frequency) {
  return MovingResidual(scenario, *scenario.device.left, frequency);
}

TEST(HandEstimator, MovingResidualIsASmallPartOfTheInertialLoad) {
  for (const double frequency : {0.5, 1.0, 2.0, 3.0}) {
    const double residual = MovingResidual(ArmScenario(1), frequency);
    EXPECT_LT(residual, 0.05) << frequency << " Hz";
    RecordProperty("residual_at_" + std::to_string(frequency) + "_Hz", std::to_string(residual));
  }
}

TEST(HandEstimator, MovingResidualIsSmallForOtherSensorsAndTicks) {
  for (const double rate : {1000.0, 500.0}) {
    for (const double delay : {0.0, 0.0025, 0.008}) {
      for (const double low_pass : {0.0, 30.0}) {
        Scenario scenario = ArmScenario(1);
        scenario.rate = rate;
        scenario.device.left->sensor.delay = delay;
        scenario.device.left->sensor.cutoff_frequency = low_pass;
        EXPECT_LT(MovingResidual(scenario, 3), 0.05) << rate << " " << delay << " " << low_pass;
      }
    }
  }
}

TEST(HandEstimator, MovingResidualShowsAWrongEstimator) {
  const Scenario scenario = ArmScenario(1);
  ArmSpec late = *scenario.device.left, light = late;
  late.sensor.delay += 0.010;
  light.payload.mass *= 0.8;
  EXPECT_GT(MovingResidual(scenario, late, 3), 0.1);
  EXPECT_GT(MovingResidual(scenario, light, 3), 0.15);
}

// A hand that exerts a sinusoidal force and torque.
class Shaker final : public Operator {
 public:
  static constexpr double kFrequency = 5;  // [Hz]
  void Step(const OperatorInput& input, OperatorOutput* output) noexcept override {
    time_ += input.dt;
    const double s = std::sin(2 * std::numbers::pi * kFrequency * time_);
    output->F_H_W[0] << 10 * s, -5 * s, 8 * s, 0.5 * s, -1 * s, 0.7 * s;
  }
  void Reset() noexcept override { time_ = 0; }
  void Archive(StateArchive&) noexcept override {}

 private:
  double time_ = 0;
};

TEST(HandEstimator, GivesTheHandsWrenchAtTheHandleWithTheSensorsLagOnly) {
  const Scenario scenario = ArmScenario(1);
  Bench bench(scenario);  // the tare with hands off removes the bias
  ASSERT_TRUE(bench.Tare(1000).ok());
  Bench shaken(scenario, std::make_unique<Shaker>());
  const Wrench bias = bench.estimator().bias();
  const double w = 2 * std::numbers::pi * Shaker::kFrequency;
  Eigen::Matrix<std::complex<double>, 6, 1> phasor;
  phasor.setZero();
  const int n = 2000;
  shaken.estimator() = bench.estimator();
  EXPECT_EQ(shaken.estimator().bias(), bias);
  for (int k = 2; k < 1000 + n; ++k) {
    shaken.Step(JointVector::Zero(7));
    const double t = 0.001 * k;
    if (k >= 1000) phasor += 2.0 / n * std::exp(std::complex<double>(0, -w * t)) * shaken.F();
  }
  phasor /= std::complex<double>(0, -1);  // the phasor of a sine
  Wrench amplitude;
  amplitude << 10, -5, 8, 0.5, -1, 0.7;
  const SensorSpec& sensor = scenario.device.left->sensor;
  const double sensor_lag =
      std::atan(Shaker::kFrequency / sensor.cutoff_frequency) / w + sensor.delay;
  for (int i = 0; i < 6; ++i) {
    const std::complex<double> response = phasor[i] / amplitude[i];
    EXPECT_NEAR(std::abs(response), 1, 0.01) << i;
    EXPECT_NEAR(-std::arg(response) / w, sensor_lag, 2e-4) << i;
  }
}

TEST(HandEstimator, RefusesReadingsThatCannotBeTrue) {
  Bench bench(ArmScenario(1));
  HandWrench out;
  ArmSample sample = bench.sample();
  sample.sensor_saturated = true;
  sample.F_S_raw[1] = -200;
  Status status = bench.estimator().Update(sample, bench.motion(), &out);
  EXPECT_EQ(status.cause, StopCause::kSensor);
  EXPECT_EQ(status.value, 200);
  EXPECT_EQ(out.F_H_W.norm(), 0);
  sample = bench.sample();
  for (int i = 0; i < 6; ++i) {
    for (const double x :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      sample.F_S_raw = bench.sample().F_S_raw;
      sample.F_S_raw[i] = x;
      EXPECT_EQ(bench.estimator().Update(sample, bench.motion(), &out).cause, StopCause::kSensor);
      EXPECT_EQ(out.F_H_W.norm(), 0);
    }
  }
  // The estimator must refuse a reading beyond the sensor's range, whether or not the sensor
  // reports it.
  const SensorSpec& sensor = ArmScenario(1).device.left->sensor;
  for (int i = 0; i < 6; ++i) {
    const double range = i < 3 ? sensor.range_force : sensor.range_torque;
    for (const double x : {range, -range}) {
      sample.F_S_raw = bench.sample().F_S_raw;
      sample.F_S_raw[i] = x;
      EXPECT_TRUE(bench.estimator().Update(sample, bench.motion(), &out).ok());
      sample.F_S_raw[i] = 1.001 * x;
      status = bench.estimator().Update(sample, bench.motion(), &out);
      EXPECT_EQ(status.cause, StopCause::kSensor);
      EXPECT_TRUE(status.power_off);
      EXPECT_EQ(out.F_H_W.norm(), 0);
    }
  }
  // A bad reading must have no effect on later ones.
  EXPECT_TRUE(bench.estimator().Update(bench.sample(), bench.motion(), &out).ok());
  EXPECT_TRUE(out.F_H_W.allFinite());
}

TEST(HandEstimator, TareFindsTheBias) {
  Scenario scenario = ArmScenario(1);
  Bench bench(scenario);
  ASSERT_TRUE(bench.Tare(2000).ok());
  const Wrench bias(scenario.rig.sensor_bias.data());
  EXPECT_LT((bench.estimator().bias() - bias).head<3>().norm(), 0.01);
  EXPECT_LT((bench.estimator().bias() - bias).tail<3>().norm(), 0.0005);
}

TEST(HandEstimator, TareRefusesAHandleThatIsTouchedAndTooFewReadings) {
  Bench bench(ArmScenario(1), std::make_unique<Shaker>());
  Status status = bench.Tare(1000);
  EXPECT_EQ(status.cause, StopCause::kSensor);
  EXPECT_GT(status.value, status.limit);
  EXPECT_EQ(bench.estimator().bias().norm(), 0);
  Bench quiet(ArmScenario(1));
  status = quiet.Tare(HandEstimator::kTareSamples - 1);
  EXPECT_EQ(status.cause, StopCause::kSensor);
  EXPECT_TRUE(quiet.Tare(HandEstimator::kTareSamples).ok());
}

TEST(HandEstimator, AllocatesNothing) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  Bench bench(ArmScenario(1));
  const JointVector v = JointVector::Constant(7, 0.02);
  test::AllocationGuard guard;
  const bool tared = bench.Tare(100).ok();
  for (int k = 0; k < 2000; ++k) bench.Step(v);
  bench.estimator().Reset();
  for (int k = 0; k < 100; ++k) bench.Step(v);
  EXPECT_EQ(guard.count(), 0);
  EXPECT_TRUE(tared);
}

TEST(HandEstimator, WeightAndInertiaAgreeWithTheRigsToRounding) {
  // Two independent derivations, with exact sensors and true accelerations, must give the same
  // load.
  Scenario scenario = ArmScenario(1);
  MakeExact(&scenario);
  scenario.device.left->payload.inertia = {3e-3, 2e-3, 1e-3};
  scenario.device.left->payload.center_of_mass = {0.02, -0.03, 0.08};
  const ArmSpec& arm = *scenario.device.left;
  Rig rig(scenario, ArmStart(1), nullptr);
  HandEstimator estimator(arm.sensor, arm.payload, arm.handle.ToPose(), 9.81, 0.001, 0);
  DeviceSample sample;
  HandWrench out;
  double largest = 0;
  for (int k = 0; k < 1000; ++k) {
    DeviceCommand command;
    command.v[0] = Wave(0.001 * k, 2, 0.4);
    rig.Step(command, 0.001);
    rig.Read(&sample);
    const FrameMotion E = MotionOfFixed(rig.true_handles()[0], arm.handle.ToPose().Inverse());
    ASSERT_TRUE(estimator.Update(sample.arms[0], E, &out).ok());
    ASSERT_LT(out.F_H_W.norm(), 1e-9) << k;
    largest = std::max(largest, E.A_W.head<3>().norm());
  }
  EXPECT_GT(largest, 2);
}

}  // namespace
}  // namespace predictor
