// Compares a cobot with one sliding joint and a fixed object with closed forms.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "scenario/scenario_io.h"
#include "scenes.h"
#include "simulation/world.h"
#include "support/temporary_folder.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

constexpr double kCarriage = 3, kLoad = 2;  // [kg]

// Returns a scenario with a carriage of 3 kg on a rail along `axis`, springs of 400 N/m and a load
// of 2 kg.
class SlidingCobot : public testing::Test {
 protected:
  Scenario On(const std::string& axis, const std::vector<std::string>& overrides = {}) {
    std::ofstream(folder_.path() / "slider.urdf") << R"(<robot name="slider"><link name="rail"/>
      <link name="carriage"><inertial><mass value="3"/>
        <inertia ixx="0.02" iyy="0.03" izz="0.025"/></inertial></link>
      <joint name="slide" type="prismatic"><parent link="rail"/><child link="carriage"/>
        <axis xyz=")" + axis + R"("/>
        <limit lower="-0.5" upper="0.5" velocity="2" effort="100"/></joint></robot>)";
    std::ofstream(folder_.path() / "slider.yaml") << R"(predictor: 1
name: A carriage
mode: direct
cobot:
  model: slider.urdf
  end_effector: carriage
  posture: [0.1 m]
  base: {xyz: [0, 0, 2]}
  joint_friction: {viscous: 0}
  controller: {type: joint_impedance, joint_stiffness: 400, joint_damping_ratio: 0}
object:
  primitive: {shape: box, size: [0.1, 0.1, 0.1], mass: 2}
  attachment: {joint: fixed}
handles: {left: {xyz: [0, 0, 0]}}
operator: {type: virtual, script: []}
environment: {floor: false}
)";
    return LoadScenario(folder_.path() / "slider.yaml", overrides);
  }
  std::string ErrorOf(const std::vector<std::string>& overrides) {
    try {
      World world(On("0 0 1", overrides));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryFolder folder_;
};

// The carriage's own weight is compensated. The load's weight along the axis stretches the spring
// by m g n_z / k.
TEST_F(SlidingCobot, SagsByTheLoadsWeightAlongTheAxis) {
  for (const auto& [axis, n_z] :
       {std::pair("0 0 1", 1.0), std::pair("1 0 0", 0.0), std::pair("0 3 4", 0.8)}) {
    const World world(On(axis));
    const double q = world.state().q[0];
    EXPECT_NEAR(q, 0.1 - kLoad * kGravity * n_z / 400, 1e-9) << axis;
    EXPECT_NEAR(world.state().torque[0], (kCarriage + kLoad) * kGravity * n_z, 1e-6) << axis;
  }
}

// The poles of the linearised world have the undamped frequency sqrt(k / (m + M)) and the decay
// rate friction / (2 (m + M)).
TEST_F(SlidingCobot, SwingsAsMassAndSpring) {
  const World world(On("0 3 4", {"cobot.joint_friction.viscous=4"}));
  const LinearModel linear = world.Linearise();
  const double mass = kCarriage + kLoad;
  const Eigen::VectorXcd poles = linear.A.eigenvalues();
  double nearest = 1;
  const std::complex<double> expected(-4 / (2 * mass),
                                      std::sqrt(400 / mass - 16 / (4 * mass * mass)));
  for (const std::complex<double>& z : poles) nearest = std::min(nearest, std::abs(z - expected));
  EXPECT_LT(nearest, 1e-4) << poles;
}

// On a horizontal rail, the force of a hand along the rail is the external force in the joint. The
// force grows slowly, so that carriage and load hardly accelerate.
TEST_F(SlidingCobot, StopsItselfAtAnExternalForce) {
  const auto stop_under = [&](double force, const std::string& limit) {
    const Scenario s = On("0 1 0", {limit, "cobot.joint_friction.viscous=4"});
    World world(s);
    for (int k = 0; k < 5000; ++k)
      EXPECT_TRUE(
          world.Step(Push(s, Vector3(0, std::min(1.0, k / 4000.0) * force, 0)), kTick).ok());
    return static_cast<CobotStop>(world.state().cobot_stop);
  };
  EXPECT_EQ(stop_under(5.7, "cobot.safety.joint_force=6"), CobotStop::kNone);
  EXPECT_EQ(stop_under(6.3, "cobot.safety.joint_force=6"), CobotStop::kJointTorque);
  EXPECT_EQ(stop_under(-6.3, "cobot.safety.joint_force=6"), CobotStop::kJointTorque);
  EXPECT_EQ(stop_under(6.3, "cobot.safety.joint_torque=6"), CobotStop::kNone);
}

TEST_F(SlidingCobot, WordsHaveTheUnitsOfItsJoint) {
  EXPECT_NE(
      ErrorOf({"cobot.posture=[30 deg]"})
          .find("cobot.posture.0 is \"30 deg\", but joint \"slide\" slides. Give its position "
                "in m."),
      std::string::npos)
      << ErrorOf({"cobot.posture=[30 deg]"});
  EXPECT_NE(ErrorOf({"cobot.posture=[0.7]"}).find("at 0.7 m is outside its limits, -0.5 to 0.5 m"),
            std::string::npos);
  EXPECT_NE(ErrorOf({"cobot.effort_limit=30"}).find("effort limit of 30 N ("), std::string::npos)
      << ErrorOf({"cobot.effort_limit=30"});
}

TEST(TurningCobot, RefusesALengthForAnAngle) {
  try {
    const World world(LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml",
                                   {"cobot.posture=[0.1 m, -0.3, 0, -2.0, 0, 1.7, 0.785]"}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("turns. Give its angle in rad or deg."),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace predictor
