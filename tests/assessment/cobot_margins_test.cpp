#include "assessment/safety/cobot_margins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "assessment/person_chain.h"
#include "assessment/safety/safety.h"
#include "assessment/samples.h"
#include "models/robot.h"
#include "support/temporary_folder.h"

namespace predictor::assessment {
namespace {

// A planar arm with two links of 1 m, whose joints turn about y, on a slide along y. Its
// translational manipulability is the determinant of the planar arm, |sin q| with the elbow angle
// q.
constexpr const char* kPlanarArm = R"(<robot name="planar">
  <link name="base"/>
  <link name="slider"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"
    iyz="0"/></inertial></link>
  <link name="upper"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"
    iyz="0"/></inertial></link>
  <link name="lower"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"
    iyz="0"/></inertial></link>
  <link name="tip"/>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="slider"/><axis xyz="0 1 0"/>
    <limit lower="-0.5" upper="0.5" velocity="1" effort="100"/></joint>
  <joint name="shoulder" type="revolute"><parent link="slider"/><child link="upper"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="1" effort="100"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
    <origin xyz="1 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2.5" velocity="1" effort="100"/></joint>
  <joint name="end" type="fixed"><parent link="lower"/><child link="tip"/><origin xyz="1 0 0"/>
  </joint>
</robot>)";

TEST(CobotMargins, AreThoseOfAPlanarArm) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "planar.urdf") << kPlanarArm;
  Scenario scenario = PersonScenario();
  scenario.cobot.end_effector = "tip";
  CobotMargins margins(scenario, RobotModel::Load({"planar.urdf", folder.path(), {}, Pose{}}));
  ASSERT_TRUE(margins.known());
  const auto at = [&](std::uint64_t tick, double slide, double shoulder, double elbow) {
    TickRecord record = RecordOf(tick, 1, 0);
    record.cobot_dof = 3;
    record.cobot_q[0] = slide;
    record.cobot_q[1] = shoulder;
    record.cobot_q[2] = elbow;
    record.link_distance = HUGE_VAL;
    for (int i = 0; i < 10; ++i) margins.Add(record);
  };
  at(1000, 0.1, 0.5, 1.2);
  at(2000, 0.3, 1.5, 0.4);
  const std::vector<Margin> results = margins.results();
  ASSERT_EQ(results.size(), 4U);
  EXPECT_NEAR(results[0].smallest, 0.5, 1e-12);  // the shoulder, 2 - 1.5
  EXPECT_EQ(results[0].joint, "shoulder");
  EXPECT_EQ(results[0].time, 2);
  EXPECT_NEAR(results[1].smallest, 0.2, 1e-12);
  EXPECT_EQ(results[1].joint, "slide");
  EXPECT_EQ(results[2].what, "smallest singular value of the Jacobian");
  // The slide is orthogonal to the other joints. Of these, BᵀB contains the products of the tip's
  // velocities and of the weighted rotations.
  const double c = std::cos(0.4), L = scenario.rendering.characteristic_length;
  const double p = 2 + 2 * c + L * L, r = 1 + L * L, q = 1 + c + L * L;
  EXPECT_NEAR(results[2].smallest, std::sqrt((p + r - std::hypot(p - r, 2 * q)) / 2), 1e-9);
  EXPECT_NEAR(results[3].smallest, std::sin(0.4), 1e-12);
  EXPECT_EQ(results[3].time, 2);
}

TEST(CobotMargins, WithoutAModelAreNotEvaluable) {
  const Scenario scenario = PersonScenario();
  SafetyCollector run(scenario);
  for (std::uint64_t tick = 1; tick <= 20; ++tick) {
    TickRecord record = RecordOf(tick, 1, 0);
    record.link_distance = 0.07;
    run.Add(record);
  }
  const PersonSetup setup = SetupOf(scenario, RecordOf(1, 1, 0));
  const SafetyAssessment safety = JudgeSafety(scenario, setup, run, {});
  ASSERT_EQ(safety.margins.size(), 1U);  // the record contains the distance of the links
  EXPECT_EQ(safety.margins[0].smallest, 0.07);
  EXPECT_TRUE(std::ranges::any_of(safety.not_evaluable, [](const NotEvaluable& n) {
    return n.why == "the recording has lost the model of the cobot";
  }));
}

}  // namespace
}  // namespace predictor::assessment
