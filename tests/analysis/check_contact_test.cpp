// Tests what `check` reports about contact with fixtures.
#include <gtest/gtest.h>

#include <numbers>

#include "analysis/check/check.h"
#include "analysis/scenarios.h"
#include "scenario/json_schema.h"
#include "simulation/world.h"

namespace predictor {
namespace {

CheckReport Checked(const Scenario& s) {
  CheckOptions options;
  options.search = false;
  return Check(s, options);
}

// Returns a plane far below the object of box_9kg.
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
    // The wall has damping, but the springs with which a rigid wall is compared have none.
    EXPECT_GT(contact.wall.damping, 0);
    EXPECT_EQ(contact.Varying().damping, 0);
  }
  EXPECT_NE(CheckText(report).find("stiffness        rigid"), std::string::npos);
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
  // The delay of the handle's motion increases the imaginary part of the rendered stiffness.
  EXPECT_GT(contact.moving.rendered.imag(), contact.moving.requested.imag());
  EXPECT_NE(CheckText(report).find("felt at rest     stiffness 20.5 kN/m (requested 20.5)"),
            std::string::npos);
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

TEST(CheckContact, TheSpectrumGoesFromRestToTheOscillationsOfTheArms) {
  const Scenario s = Load("box_9kg.yaml", {Plane("stiffness: 20000, damping: 60")});
  const CheckReport report = Checked(s);
  ASSERT_EQ(report.contacts.size(), 1u);
  const ContactReport& contact = report.contacts[0];
  ASSERT_EQ(contact.spectrum.size(), 54u);
  EXPECT_EQ(contact.spectrum.front().frequency, 0.1);
  EXPECT_EQ(contact.spectrum.back().frequency, 40);
  const LinearModel touching = WithWall(World(s).Linearise(), contact.wall);
  for (const std::size_t k : {0U, 20U, 53U}) {
    const FeltAt& at = contact.spectrum[k];
    const FeltImpedance felt = ImpedanceAt(touching, s, report.stability->lead, 1 / s.rate,
                                           Vector3::UnitZ(), at.frequency);
    EXPECT_LT(std::abs(at.felt.rendered - felt.rendered), 1e-9 * std::abs(felt.rendered));
    EXPECT_LT(std::abs(at.felt.requested - felt.requested), 1e-9 * std::abs(felt.requested));
  }
}

TEST(CheckContact, ADamperIsItsDamping) {
  constexpr double kFrequency = 3, kDamping = 40;
  const std::complex<double> impedance(700, 2 * std::numbers::pi * kFrequency * kDamping);
  EXPECT_NEAR(DampingOf(impedance, kFrequency), kDamping, 1e-12);
}

// The scenarios differ in whether they have contacts, two arms, proposals and problems.
TEST(CheckJson, ConformsToItsSchema) {
  const Json schema = Json::parse(CheckSchema());
  const CheckReport report =
      Checked(Load("box_9kg.yaml", {Plane("stiffness: 20000, damping: 60")}));
  const Json json = Json::parse(CheckJson(report));
  EXPECT_TRUE(Validates(schema, json));
  ASSERT_EQ(json["contacts"].size(), 1u);
  const Json& contact = json["contacts"][0];
  EXPECT_EQ(contact["stiffness_n_m"], 20000);
  EXPECT_EQ(contact["damping_ns_m"], 60);
  EXPECT_EQ(contact["largest_stable_stiffness_n_m"], report.contacts[0].limit.stiffness);
  EXPECT_EQ(contact["at_5_hz"]["rendered"]["imaginary_n_m"],
            report.contacts[0].moving.rendered.imag());
  EXPECT_EQ(contact["impedance"].size(), report.contacts[0].spectrum.size());
  for (const char* name : {"single_arm.yaml", "slide_on_table.yaml", "linear_axis.yaml"})
    EXPECT_TRUE(Validates(schema, Json::parse(CheckJson(Checked(Load(name)))))) << name;
  EXPECT_TRUE(
      Validates(schema, Json::parse(CheckJson(Checked(Load("single_arm.yaml", {"mode=direct"}))))));
  const CheckReport lost =
      Check(Load("single_arm.yaml", {"device.arms.left.base.xyz=[-2, 0, 0]"}), {});
  ASSERT_TRUE(lost.proposal);
  EXPECT_TRUE(Validates(schema, Json::parse(CheckJson(lost))));
  Json broken = json;
  broken["contacts"][0].erase("yields");
  EXPECT_FALSE(Validates(schema, broken));
}

}  // namespace
}  // namespace predictor
