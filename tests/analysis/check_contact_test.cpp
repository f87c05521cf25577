// Tests what `check` reports about contact with fixtures.
#include <gtest/gtest.h>

#include "analysis/check/check.h"
#include "scenarios.h"

namespace predictor {
namespace {

CheckReport Checked(const Scenario& s) {
  CheckOptions options;
  options.search = false;
  return Check(s, options);
}

// A plane far below box_9kg.
std::string Plane(const std::string& keys) {
  return "environment.fixtures=[{shape: plane, xyz: [0, 0, -1], " + keys + "}]";
}

TEST(CheckContact, HasAReportForEachSideOfTheObject) {
  const CheckReport report = Checked(Load("slide_on_table.yaml"));
  ASSERT_EQ(report.contacts.size(), 2u);  // a table below, and a stop at its left
  EXPECT_LT((report.contacts[0].wall.normal - Vector3::UnitZ()).norm(), 1e-12);
  EXPECT_LT((report.contacts[1].wall.normal + Vector3::UnitY()).norm(), 1e-12);
  for (const ContactReport& contact : report.contacts) {
    EXPECT_FALSE(contact.yields);
    EXPECT_TRUE(contact.stable);
  }
  EXPECT_NE(CheckText(report).find("fixture 1, normal [0.00, -1.00, 0.00]: stable"),
            std::string::npos);
}

TEST(CheckContact, FixturesOfOneKindOnOneSideShareAReport) {
  const CheckReport report = Checked(Load("peg_in_hole.yaml"));
  std::size_t fixtures = 0;
  for (const ContactReport& contact : report.contacts) fixtures += contact.fixtures.size();
  EXPECT_EQ(fixtures, Load("peg_in_hole.yaml").environment.fixtures.size());
  EXPECT_LT(report.contacts.size(), fixtures);
}

TEST(CheckContact, TheHandsFeelTheFixtureAndTheCobotsSpring) {
  const CheckReport report =
      Checked(Load("box_9kg.yaml", {Plane("stiffness: 20000, damping: 60")}));
  ASSERT_EQ(report.contacts.size(), 1u);
  const ContactReport& contact = report.contacts[0];
  EXPECT_TRUE(contact.stable);
  EXPECT_NEAR(contact.at_rest.requested.real(), 20000 + 500, 0.02 * 20500);
  EXPECT_NEAR(contact.at_rest.rendered.real(), 20000 + 500, 0.02 * 20500);
  // The handle's motion is late.
  EXPECT_GT(contact.moving.rendered.imag(), contact.moving.requested.imag());
  EXPECT_NE(CheckText(report).find("felt at rest     2.05e+04 N/m of 2.05e+04"), std::string::npos);
}

TEST(CheckContact, AStiffnessThatTheLoopCannotRenderIsAWarning) {
  // Heavy hands.
  const CheckReport report =
      Checked(Load("box_9kg.yaml", {"rendering.lead=0", "operator.hand.stiffness=[50, 50, 50]",
                                    "operator.hand.visual_stiffness=[0, 0, 0]",
                                    "operator.hand.mass=3", Plane("stiffness: 150000")}));
  ASSERT_EQ(report.contacts.size(), 1u);
  EXPECT_GE(report.stability->margin.gain, 1);  // without contact, the loop is stable
  EXPECT_FALSE(report.contacts[0].stable);
  EXPECT_LT(report.contacts[0].limit.stiffness, 4 * 150000);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_EQ(report.warnings.back().find("environment.fixtures.0: the haptic loop oscillates"), 0u)
      << report.warnings.back();
}

}  // namespace
}  // namespace predictor
