// Tests the reader of MyoArm with a small arm of the same structure, which the test writes, and
// with MyoArm itself if the package myo-sim is installed.
#include "muscles/myo_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/format.h"
#include "muscles/arms.h"
#include "muscles/general_solver.h"
#include "support/temporary_folder.h"

namespace predictor::muscles::myo {
namespace {

// The points are given in MyoArm's axes [m]. In these axes, x points forward, y points up and z
// points to the right.
const Vector3 kPivot(-0.02, 0.05, -0.1);           // of the shoulder blade
const Vector3 kShoulder(0.01, 0, 0.02);            // in the zero posture
constexpr double kSlope = 0.35, kCurvature = 0.1;  // of blade angle versus elevation

constexpr const char* kNames[] = {
    "DELT1", "DELT2",  "DELT3", "SUPSP",  "INFSP",   "SUBSC",    "TMIN",    "TMAJ", "PECM1",
    "PECM2", "PECM3",  "LAT1",  "LAT2",   "LAT3",    "CORB",     "TRIlong", "ANC",  "BRA",
    "SUP",   "TRIlat", "BRD",   "TRImed", "BIClong", "BICshort", "PT",      "PQ",   "ECRL",
    "ECRB",  "ECU",    "FCR",   "FCU",    "FDS2",    "FDS3",     "FDS4",    "FDS5", "FDP2",
    "FDP3",  "FDP4",   "FDP5",  "EDC2",   "EDC3",    "EDC4",     "EDC5"};
constexpr int kStrands = static_cast<int>(std::size(kNames));
constexpr int kOnUpperArm = 15;  // number of strands that end at the upper arm

// The following two functions return the ends of strand `i`. The origin of an even strand is on the
// shoulder blade and that of an odd strand on the torso, both in the torso's axes.
Vector3 OriginOf(int i) {
  return kShoulder + Vector3(0.03 * std::sin(i), 0.02 + 0.004 * (i % 5), -0.02 * std::cos(2 * i));
}
Vector3 EndOf(int i) {
  return {0.015 * std::cos(3 * i), -0.04 - 0.002 * i, 0.012 * std::sin(5 * i)};
}

std::string Site(int i, const char* end, const Vector3& p) {
  return Formatted("<site name=\"%s_%s\" pos=\"%.9g %.9g %.9g\"/>", kNames[i], end, p.x(), p.y(),
                   p.z());
}
std::string Sites(int begin, int end, int step, const char* what, const Vector3& about,
                  Vector3 (*of)(int)) {
  std::string text;
  for (int i = begin; i < end; i += step) text += Site(i, what, of(i) - about);
  return text;
}
std::string Hinge(const char* name, const char* axis) {
  return Formatted("<joint name=\"%s_r\" axis=\"%s\" armature=\"0.01\"/>", name, axis);
}
std::string Body(const Vector3& p) {
  return Formatted(
      "<body pos=\"%.9g %.9g %.9g\"><inertial pos=\"0 0 0\" mass=\"1\" "
      "diaginertia=\"0.1 0.1 0.1\"/>",
      p.x(), p.y(), p.z());
}
std::string Follows(const char* name, const char* leader, double slope, double curvature) {
  return Formatted("<joint joint1=\"%s_r\" joint2=\"%s_r\" polycoef=\"0 %g %g 0 0\"/>", name,
                   leader, slope, curvature);
}

// Returns an arm whose shoulder blade turns about x with the elevation, like MyoArm's.
std::string SmallArm() {
  std::string text =
      "<mujoco><compiler angle=\"radian\"/><worldbody>" + Body({0, 0, 0}) +
      Sites(1, kStrands, 2, "a", {0, 0, 0}, OriginOf) + Body(kPivot) + Hinge("blade", "1 0 0") +
      Sites(0, kStrands, 2, "a", kPivot, OriginOf) + Body(kShoulder - kPivot) +
      Hinge("unrothum_r1", "1 0 0") + Hinge("unrothum_r3", "0 0 1") +
      Hinge("unrothum_r2", "0 1 0") + Body({0, 0, 0}) + Hinge("elv_angle", "0 1 0") +
      Hinge("shoulder_elv", "-1 0 0") + Hinge("shoulder1_r2", "0 1 0") + Body({0, 0, 0}) +
      Hinge("shoulder_rot", "0 1 0") + Sites(0, kOnUpperArm, 1, "b", {0, 0, 0}, EndOf) +
      Body({0, -0.29, 0}) + Hinge("elbow_flexion", "0 0 1") +
      Sites(kOnUpperArm, 20, 1, "b", {0, 0, 0}, EndOf) + Body({0.01, 0, 0.01}) +
      Hinge("pro_sup", "0 1 0") + Sites(20, 26, 1, "b", {0, 0, 0}, EndOf) + Body({0, -0.25, 0}) +
      Hinge("deviation", "0 0 1") + Hinge("flexion", "1 0 0") +
      Sites(26, kStrands, 1, "b", {0, 0, 0}, EndOf);
  for (int i = 0; i < 8; ++i) text += "</body>";
  text += "</worldbody><equality>" + Follows("blade", "shoulder_elv", kSlope, kCurvature) +
          Follows("unrothum_r1", "shoulder_elv", -kSlope, -kCurvature) +
          Follows("shoulder1_r2", "elv_angle", -1, 0) + "</equality><tendon>";
  for (const char* name : kNames)
    text += Formatted(
        "<spatial name=\"%s_tendon\"><site site=\"%s_a\"/><site site=\"%s_b\"/></spatial>", name,
        name, name);
  text += "</tendon><actuator>";
  for (int i = 0; i < kStrands; ++i)
    text += Formatted(
        "<general name=\"%s\" tendon=\"%s_tendon\" gainprm=\"0.5 1.5 %d\" "
        "lengthrange=\"0.1 0.2\"/>",
        kNames[i], kNames[i], 100 + 10 * i);
  return text + "</actuator></mujoco>";
}

class MyoArmTest : public testing::Test {
 protected:
  std::string Write(const std::string& text) const {
    const std::string file = folder_.path() / "arm.xml";
    std::ofstream(file) << text;
    return file;
  }
  const test::TemporaryFolder folder_;
};

// Returns the largest difference of the moment arms from the slopes of the lengths, over random
// postures of the working range [m].
double WorstSlope(const ArmPaths& paths, int postures) {
  constexpr double kStep = 1e-6;
  constexpr double kEnds[person::kArmJoints][2] = {{0, 90},   {0, 60},   {-30, 45}, {0, 130},
                                                   {-70, 70}, {-45, 45}, {-10, 25}};
  RandomStream random(5, "slopes");
  double worst = 0;
  for (int n = 0; n < postures; ++n) {
    ArmVector q;
    for (int i = 0; i < person::kArmJoints; ++i)
      q[i] = Radians(kEnds[i][0] + (kEnds[i][1] - kEnds[i][0]) * random.Uniform());
    const MomentArms R = paths.LinesAt(q).moment_arm;
    for (int j = 0; j < person::kArmJoints; ++j) {
      const ArmVector step = kStep * ArmVector::Unit(j);
      const MuscleVector slope =
          (paths.LinesAt(q + step).length - paths.LinesAt(q - step).length) / (2 * kStep);
      worst = std::max(worst, (slope + R.row(j).transpose()).cwiseAbs().maxCoeff());
    }
  }
  return worst;
}

TEST_F(MyoArmTest, MomentArmsAreTheSlopesAlongTheCoupledPath) {
  const auto paths = LoadMyoArm(Write(SmallArm()));
  EXPECT_LT(WorstSlope(*paths, 100), 1e-7);
}

// The upper arm must have the orientation of our body model, and the shoulder blade must follow its
// elevation. The test computes the lengths without MuJoCo.
TEST_F(MyoArmTest, TheUpperArmHasOurOrientationAndTheBladeFollows) {
  const auto paths = LoadMyoArm(Write(SmallArm()));
  const person::BodyModel body{BodySpec{}};
  Matrix3 C;  // from our axes to MyoArm's
  C.col(0) = Vector3::UnitX();
  C.col(1) = -Vector3::UnitZ();
  C.col(2) = Vector3::UnitY();
  for (const ArmVector& q : {ArmVector(ArmVector::Zero()), WorkPosture(),
                             ArmVector(2 * WorkPosture() + ArmVector::Constant(0.2))}) {
    person::BodyVector all = person::BodyVector::Zero();
    all.segment<person::kArmJoints>(person::kRightArm) = q;
    const Matrix3 R = C * person::Place(body, all).R[person::kRightArm + 2] * C.transpose();
    const double elevation = std::acos(std::min(1.0, R(1, 1)));
    const double angle = kSlope * elevation + kCurvature * elevation * elevation;
    const Matrix3 turn = RotationFromVector({angle, 0, 0}).toRotationMatrix();
    const Vector3 shoulder = kPivot + turn * (kShoulder - kPivot);
    const MuscleVector length = paths->LinesAt(q).length;
    for (int i = 0; i < 12; ++i) {  // strands that are separate muscles
      const Vector3 origin =
          i % 2 == 0 ? Vector3(kPivot + turn * (OriginOf(i) - kPivot)) : OriginOf(i);
      EXPECT_NEAR(length[i], (shoulder + R * EndOf(i) - origin).norm(), 1e-9) << kNames[i];
    }
  }
}

TEST_F(MyoArmTest, StrandsAreAddedAndParametersAreRead) {
  const auto paths = LoadMyoArm(Write(SmallArm()));
  const MuscleParameters& one = paths->muscle(IndexOf("deltoid_anterior"));
  EXPECT_NEAR(one.max_force, 100, 1e-9);
  EXPECT_NEAR(one.fibre_length, 0.1, 1e-12);
  EXPECT_NEAR(one.tendon_slack, 0.1 - 0.5 * 0.1, 1e-12);
  EXPECT_NEAR(paths->muscle(IndexOf("latissimus_lower")).max_force, 220 + 230, 1e-9);
}

// A hanging arm is singular in MyoArm's angles of the shoulder, but not in ours.
TEST_F(MyoArmTest, AHangingArmHasMomentArms) {
  const auto paths = LoadMyoArm(Write(SmallArm()));
  const ArmVector hanging = ArmVector::Zero();
  const MuscleLines at = paths->LinesAt(hanging);
  ASSERT_TRUE(at.moment_arm.allFinite());
  const ArmVector near = 1e-5 * ArmVector::Unit(1);
  EXPECT_LT((paths->LinesAt(near).length - at.length).cwiseAbs().maxCoeff(), 1e-5);
  const ArmVector turn = 1e-6 * ArmVector::Unit(2);
  const MuscleVector slope = (paths->LinesAt(turn).length - paths->LinesAt(-turn).length) / 2e-6;
  EXPECT_LT((slope + at.moment_arm.row(2).transpose()).cwiseAbs().maxCoeff(), 1e-8);
}

TEST_F(MyoArmTest, AnArmModelScalesIt) {
  const auto paths = LoadMyoArm(Write(SmallArm()));
  BodySpec spec;
  spec.upper_arm = 1.1 * kTableUpperArm;
  for (int hand = 0; hand < kHands; ++hand) {
    const ArmModel arm(spec, hand, paths);
    const MuscleLines lines = arm.LinesAt(WorkPosture()), raw = paths->LinesAt(WorkPosture());
    EXPECT_LT((lines.length - 1.1 * raw.length).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((lines.moment_arm - 1.1 * raw.moment_arm).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NEAR(arm.muscle(0).fibre_length, 1.1 * paths->muscle(0).fibre_length, 1e-12);
  }
}

// Returns a small arm whose middle deltoid passes through a point of the upper arm at this height
// above the plane of x and y, in the axes of the upper arm [m].
std::string ArmWithDeltoidPoint(const char* point, double z) {
  std::string text = SmallArm();
  const auto insert = [&](const std::string& before, const std::string& added) {
    text.insert(text.find(before), added);
  };
  insert("<site name=\"DELT2_b\"",
         Formatted("<site name=\"%s\" pos=\"0.006 -0.03 %g\"/>", point, z));
  insert("<site site=\"DELT2_b\"", Formatted("<site site=\"%s\"/>", point));
  return text;
}

// MyoArm has this point on the inner side, where z is negative.
TEST_F(MyoArmTest, TheMiddleDeltoidPassesOutsideTheUpperArm) {
  const int deltoid = IndexOf("deltoid_middle");
  const auto at = [&](const char* point, double z) {
    return LoadMyoArm(Write(ArmWithDeltoidPoint(point, z)))->LinesAt(WorkPosture());
  };
  const MuscleLines outside = at("DELT2_DELT2-P2_r", 0.03), inside = at("DELT2_DELT2-P2_r", -0.03);
  EXPECT_NEAR(inside.length[deltoid], outside.length[deltoid], 1e-12);
  EXPECT_LT((inside.moment_arm - outside.moment_arm).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(at("DELT2_DELT2-P2", -0.03).length[deltoid], outside.length[deltoid], 1e-12);
  // Other points stay where they are.
  EXPECT_GT(std::abs(at("other", -0.03).length[deltoid] - outside.length[deltoid]), 1e-3);
}

std::string ErrorOf(const std::string& file) {
  try {
    LoadMyoArm(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(MyoArmTest, RefusesWhatIsNotMyoArm) {
  const auto expect = [](const std::string& error, const char* words) {
    EXPECT_NE(error.find(words), std::string::npos) << error;
  };
  expect(ErrorOf("/nowhere"), "cannot be read");
  expect(ErrorOf(folder_.path()), "myoarm_r_chain.xml");
  expect(ErrorOf(Write("<mujoco>")), "MuJoCo cannot read this model. Give the folder");
  EXPECT_EQ(ErrorOf(Write("<mujoco>")).find("\\x0a"), std::string::npos);
  expect(ErrorOf(Write("<mujoco/>")), "no joint \"elv_angle\"");
  std::string text = SmallArm();
  text.replace(text.find("general name=\"BRA\""), 18, "general name=\"BRB\"");
  expect(ErrorOf(Write(text)), "no muscle \"BRA\"");
}

// Solves random problems of an arm with our solver and a general one.
void ExpectSameCost(const ArmModel& arm) {
  RandomStream random(12, "costs");
  GeneralSolver general;
  for (int n = 0; n < 100; ++n) {
    ArmVector torque;
    const double scale = 30 * random.Uniform();
    for (int i = 0; i < person::kArmJoints; ++i)
      torque[i] = (i < 4 ? 1 : 0.15) * scale * random.Normal();
    const ActivationProblem problem = ProblemAt(arm, RandomArm(arm, &random), torque);
    const ActivationResult result = Activate(problem);
    ASSERT_TRUE(result.converged) << n;
    const double cost = general.CostOf(problem);
    ASSERT_NEAR(result.cost, cost, 2e-5 * std::max(1.0, cost)) << n;
  }
}

// Returns the folder of the optional package, which need_myo in ./dev installs, or an empty name.
std::filesystem::path Package() {
  if (const char* given = std::getenv("PREDICTOR_MYOARM")) return given;
  const std::filesystem::path lib = std::filesystem::path(PREDICTOR_SOURCE_DIR) / ".deps/myo/lib";
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(lib, error)) {
    const auto models = entry.path() / "site-packages/myo_sim/models";
    if (std::filesystem::exists(models)) return models;
  }
  return {};
}

class MyoArmPackage : public testing::Test {
 protected:
  void SetUp() override {
    if (Package().empty())
      GTEST_SKIP() << "The optional package myo-sim is absent: ./dev soak MyoArm fetches it.";
    paths_ = LoadMyoArm(Package());
  }
  std::shared_ptr<const ArmPaths> paths_;
};

TEST_F(MyoArmPackage, MomentArmsAreTheSlopesSoak) {
  const double worst = WorstSlope(*paths_, 200);
  std::printf("largest difference from the slope of the length: %.1e m\n", worst);
  EXPECT_LT(worst, 1e-6);
}

TEST_F(MyoArmPackage, ActivationsAgreeWithAGeneralSolverSoak) {
  ExpectSameCost(ArmModel({}, 1, paths_));
}

// A middle deltoid that does not abduct the arm would leave this torque to the supraspinatus. In
// the working range, the line must also stay within the lengths that MyoArm gives for the muscle.
TEST_F(MyoArmPackage, TheMiddleDeltoidAbductsSoak) {
  const ArmModel myo({}, 1, paths_);
  const int deltoid = IndexOf("deltoid_middle");
  constexpr double kShortest = 0.14984, kLongest = 0.207283;  // lengthrange of DELT2 [m]
  for (const double abduction : {5.0, 15.0, 30.0, 45.0, 60.0})
    for (const double flexion : {0.0, 30.0, 60.0}) {
      ArmVector q = WorkPosture();
      q[0] = Radians(flexion);
      q[1] = Radians(abduction);
      const auto abducts = static_cast<int>(person::ArmJoint::kShoulderAbduction);
      EXPECT_GT(myo.LinesAt(q).moment_arm(abducts, deltoid), 0.005) << flexion << " " << abduction;
      const double length = paths_->LinesAt(q).length[deltoid];
      EXPECT_GT(length, kShortest) << flexion << " " << abduction;
      EXPECT_LT(length, kLongest) << flexion << " " << abduction;
    }
}

// Prints the comparison in docs/concepts/muscles.md.
TEST_F(MyoArmPackage, PullsLikeTheBuiltInModelSoak) {
  const ArmModel own({}, 1);
  const ArmModel myo({}, 1, paths_);
  struct Case {
    const char* key;
    person::ArmJoint joint;
  };
  using enum person::ArmJoint;
  for (const Case& c : {Case{"deltoid_anterior", kShoulderFlexion},
                        {"deltoid_posterior", kShoulderFlexion},
                        {"deltoid_middle", kShoulderAbduction},
                        {"supraspinatus", kShoulderAbduction},
                        {"pectoralis_sternal", kShoulderAbduction},
                        {"latissimus_lower", kShoulderFlexion},
                        {"subscapularis", kShoulderRotation},
                        {"infraspinatus", kShoulderRotation},
                        {"teres_minor", kShoulderRotation},
                        {"biceps_long", kElbowFlexion},
                        {"brachialis", kElbowFlexion},
                        {"brachioradialis", kElbowFlexion},
                        {"triceps_long", kElbowFlexion},
                        {"pronator_teres", kPronation},
                        {"supinator", kPronation},
                        {"fcr", kWristFlexion},
                        {"ecrb", kWristFlexion},
                        {"ecu", kWristDeviation},
                        {"ecrl", kWristDeviation}}) {
    std::printf("| %s |", c.key);
    for (const double flexion : {0.0, 30.0, 60.0, 90.0}) {
      ArmVector q = WorkPosture();
      q[0] = Radians(flexion);
      q[3] = Radians(flexion + 30);
      const auto of = [&](const ArmModel& arm) {
        return 1e3 * arm.LinesAt(q).moment_arm(static_cast<int>(c.joint), IndexOf(c.key));
      };
      std::printf(" %.0f / %.0f |", of(own), of(myo));
      // At the shoulder, even the sign of the moment arms may differ between the models.
      if (c.joint >= kElbowFlexion) {
        EXPECT_GT(of(own) * of(myo), 0) << c.key;
      }
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace predictor::muscles::myo
