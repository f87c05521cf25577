#include "assessment/joint_quantities.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "assessment/assessment.h"
#include "assessment/output.h"
#include "assessment/person_chain.h"
#include "assessment/samples.h"
#include "core/normal.h"

namespace predictor::assessment {
namespace {

Scenario ScenarioWith(double strength = 1) {
  Scenario scenario = PersonScenario();
  scenario.operator_.body->strength.fill(strength);
  return scenario;
}

Assessment JointsAt(double height, double force, bool intervals = false, double strength = 1) {
  const Scenario scenario = ScenarioWith(strength);
  const SampleCollector run =
      Collect(scenario, 0.5, [&](std::uint64_t tick) { return RecordOf(tick, height, force); });
  return Assess(scenario, 9, run, {.intervals = intervals});
}

const QuantityResult& JointRow(const Assessment& a, const std::string& path) {
  for (const QuantityResult& q : a.quantities)
    if (path == q.kind->path) return q;
  throw std::out_of_range(path);
}

// The force of the hand at the handle causes the torques Jᵀ F.
TEST(JointQuantities, TheHandCausesTheTorquesOfItsForce) {
  const Scenario scenario = ScenarioWith();
  const SampleCollector run =
      Collect(scenario, 0.5, [&](std::uint64_t tick) { return RecordOf(tick, 1.0, 40); });
  const PersonSetup setup = SetupOf(scenario, RunOf(run).handles);
  const NominalChain chain = RunNominal(setup, run.samples(), {}, [](double) {});
  const person::BodyModel model(setup.body);
  const person::Placement at = person::Place(model, chain.postures.back().q);
  const Vector3 handle = setup.stance.X_WS.Inverse() * run.samples().back().body.hands[0].X_WD.p;
  const int first = person::Of(0, person::ArmJoint::kShoulderFlexion);
  const Assessment a = JointsAt(1.0, 40);
  double sum = 0;
  int joint = first;
  for (const char* name :
       {"shoulder_flexion", "shoulder_abduction", "shoulder_rotation", "elbow_flexion",
        "forearm_pronation", "wrist_flexion", "wrist_deviation"}) {
    const auto j = static_cast<std::size_t>(joint++);
    const double torque = at.axis[j].cross(handle - at.p[j]).z() * 40;
    const auto path = std::string("joints.left.") + name + ".torque_by_hands_nm";
    EXPECT_NEAR(JointRow(a, path).mean, std::abs(torque), 1e-3) << name;
    sum += std::abs(torque);
  }
  EXPECT_GT(sum, 10);
}

// Without a force of the hands, the arm holds only its own weight.
TEST(JointQuantities, WithoutAForceTheHandsCauseNothing) {
  const Assessment a = JointsAt(1.0, 0);
  EXPECT_NEAR(JointRow(a, "joints.left.elbow_flexion.torque_by_hands_nm").max, 0, 1e-9);
  EXPECT_GT(JointRow(a, "joints.left.elbow_flexion.torque_nm").mean, 1);
  EXPECT_NEAR(JointRow(a, "lower_back.moment_by_hands_nm").max, 0, 1e-9);
}

// The strength of people is normally distributed, with a standard deviation of 0.3 of the mean.
TEST(JointQuantities, TheShareOfPeopleFollowsFromTheUse) {
  const Assessment a = JointsAt(1.0, 90), strong = JointsAt(1.0, 90, false, 2);
  for (const char* side : {"left", "right"})
    for (const auto& [use, joint] : {std::pair{"elbow", "elbow"}, {"shoulder", "shoulder"}}) {
      const double share = JointRow(a, std::string("strength.") + side + "_" + use).values.back();
      const std::string path =
          std::string("joints.") + side + "." + joint + "_flexion.people_strong_enough";
      const double capable = JointRow(a, path).values.back();
      EXPECT_NEAR(capable, NormalProbability((1 - share) / 0.3), 1e-12) << path;
      EXPECT_LT(capable, 0.99) << path;
      // A stronger operator does not change other people.
      EXPECT_EQ(JointRow(strong, path).values.back(), capable) << path;
    }
}

TEST(JointQuantities, ALoadStiffensTheElbow) {
  const Assessment light = JointsAt(1.0, 10), heavy = JointsAt(1.0, 60);
  const char* path = "joints.right.elbow_flexion.stiffness_nm_per_rad";
  EXPECT_GT(JointRow(light, path).mean, 0);
  EXPECT_GT(JointRow(heavy, path).mean, 1.5 * JointRow(light, path).mean);
}

TEST(JointQuantities, ARaisedShoulderHasNoValues) {
  const Assessment a = JointsAt(1.85, 10);
  for (const QuantityResult& q : a.quantities) {
    if (!q.kind->of_joint) continue;
    const std::string path = q.kind->path;
    // The muscles that move the elbow and the forearm also act at the shoulder.
    const bool unknown =
        path.find("shoulder") != std::string::npos || path.find("stiffness") != std::string::npos;
    EXPECT_EQ(std::isnan(q.mean), unknown) << path;
  }
}

// Each quantity is a cell of the table, in text and page, with its interval.
TEST(JointQuantities, AreATable) {
  const Assessment a = JointsAt(1.0, 30, true);
  const auto rows = JointTable(a);
  ASSERT_EQ(rows.size(), 1U + 2 * person::kArmJoints);
  ASSERT_EQ(rows[0].size(), 5U);
  std::size_t known = 0;
  for (const auto& row : rows) {
    ASSERT_EQ(row.size(), rows[0].size());
    for (std::size_t i = 1; i < row.size(); ++i) known += row[i] == "–" ? 0 : 1;
  }
  const auto all =
      std::ranges::count_if(a.quantities, [](const QuantityResult& q) { return q.kind->of_joint; });
  EXPECT_EQ(known, rows[0].size() - 1 + static_cast<std::size_t>(all));
  const QuantityResult& elbow = JointRow(a, "joints.right.elbow_flexion.torque_nm");
  const auto row =
      std::ranges::find(rows, "right elbow flexion", [](const auto& r) { return r[0]; });
  ASSERT_NE(row, rows.end());
  EXPECT_EQ((*row)[1], ValueText(*elbow.kind, elbow.p95) + " (" +
                           RangeText(*elbow.kind, elbow.tail_interval) + ")");
  const std::string text = AssessmentText(a), page = AssessmentPage(a, "1.0");
  for (const std::string& cell : *row) {
    EXPECT_NE(text.find(cell), std::string::npos) << cell;
    EXPECT_NE(page.find(cell), std::string::npos) << cell;
  }
}

// Without the right handle, the table has no right arm.
TEST(JointQuantities, AnArmWithoutAHandleHasNoRows) {
  Scenario scenario = ScenarioWith();
  scenario.right_handle.reset();
  const SampleCollector run = Collect(scenario, 0.3, [&](std::uint64_t tick) {
    TickRecord record = RecordOf(tick, 1.0, 5);
    record.hands[1] = {};
    return record;
  });
  const auto rows = JointTable(Assess(scenario, 9, run, {.intervals = false}));
  EXPECT_EQ(rows.size(), 1U + person::kArmJoints);
  for (const auto& row : rows) EXPECT_FALSE(row[0].starts_with("right")) << row[0];
}

}  // namespace
}  // namespace predictor::assessment
