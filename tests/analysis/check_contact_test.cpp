// Tests what `check` reports about contact of the carried object.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

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
  EXPECT_NE(CheckText(report).find("fixture 1 (stop), normal [0.00, -1.00, 0.00]: stable"),
            std::string::npos);
}

TEST(CheckContact, FixturesOfOneKindOnOneSideShareAReport) {
  const CheckReport report = Checked(Load("peg_in_hole.yaml"));
  std::size_t fixtures = 0;
  for (const ContactReport& contact : report.contacts) fixtures += contact.surfaces.size();
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
  EXPECT_NE(CheckText(report).find("felt at rest     stiffness 20.5 kN/m (requested 20.5 kN/m)"),
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

Surface Only(const ContactReport& report) {
  EXPECT_EQ(report.surfaces.size(), 1u);
  return report.surfaces[0];
}

// Without a stiffness of its own, a wall counts as a spring without damping. Therefore, the table
// and a fixture of the same shape have the same limit.
TEST(CheckContact, TheTableHasTheLimitOfAnEqualFixture) {
  const std::vector<std::string> heavy = {
      "rendering.lead=0", "operator.hand.stiffness=[50, 50, 50]",
      "operator.hand.visual_stiffness=[0, 0, 0]", "operator.hand.mass=3"};
  const auto with = [&](const char* body) {
    std::vector<std::string> overrides = heavy;
    overrides.emplace_back(body);
    return Checked(Load("box_9kg.yaml", overrides));
  };
  const CheckReport table = with("environment.table={size: [1, 1, 0.1], top: [0.5, 0, -0.5]}");
  const CheckReport fixture =
      with("environment.fixtures=[{shape: box, size: [1, 1, 0.1], xyz: [0.5, 0, -0.55]}]");
  ASSERT_EQ(table.contacts.size(), 1u);
  ASSERT_EQ(fixture.contacts.size(), 1u);
  const ContactReport& of_table = table.contacts[0];
  EXPECT_EQ(Only(of_table).kind, Surface::Kind::kTable);
  EXPECT_EQ(of_table.wall.normal, fixture.contacts[0].wall.normal);
  EXPECT_TRUE(of_table.limit.reached);
  EXPECT_GT(of_table.limit.stiffness, 1e4);
  EXPECT_EQ(of_table.limit.stiffness, fixture.contacts[0].limit.stiffness);
  EXPECT_EQ(of_table.limit.frequency, fixture.contacts[0].limit.frequency);
  EXPECT_NE(CheckText(table).find("  table, normal [0.00, 0.00, 1.00]: "), std::string::npos);
  EXPECT_NE(CheckText(table).find("stiffness        not given (in the simulation, "),
            std::string::npos);
}

// A box that rests on the table at the start feels this contact as it is, once, not twice.
TEST(CheckContact, AContactAtTheStartCountsOnce) {
  const Scenario hanging = Load("box_9kg.yaml");
  const double bottom = World(hanging).state().object.X_W.p.z() - 0.1;
  const Scenario s = Load("box_9kg.yaml", {"environment.table={size: [1, 1, 0.1], top: [0.5, 0, " +
                                           std::to_string(bottom + 0.05) + "]}"});
  const World world(s);
  ASSERT_GT(world.SupportAtStart().other, 10);
  const auto stiffness = [&](const LinearModel& model) {
    return ImpedanceAt(model, s, 0, 1 / s.rate, Vector3::UnitZ(), 0.05).requested.real();
  };
  EXPECT_GT(stiffness(world.Linearise()), 1e5);
  EXPECT_NEAR(stiffness(world.LineariseWithoutContacts()), 500, 0.05 * 500);
  EXPECT_GT(stiffness(world.Linearise()), 1e5);  // the contacts act again
  const CheckReport report = Checked(s);
  ASSERT_EQ(report.contacts.size(), 1u);
  const ContactReport& contact = report.contacts[0];
  EXPECT_TRUE(contact.at_start);
  EXPECT_NEAR(contact.at_rest.requested.real(), stiffness(world.Linearise()),
              0.01 * contact.at_rest.requested.real());
  EXPECT_TRUE(contact.stable);
  // Without its contact at the start, this cobot's force control would drift.
  const CheckReport pressing = Checked(Load("hybrid_force_position.yaml"));
  ASSERT_EQ(pressing.contacts.size(), 1u);
  EXPECT_TRUE(pressing.contacts[0].at_start);
  EXPECT_TRUE(pressing.contacts[0].stable);
  EXPECT_NE(CheckText(pressing).find("  table as at the start, normal [0.00, 0.00, 1.00]: stable"),
            std::string::npos);
}

TEST(CheckContact, TheFloorCountsIfTheScriptBringsTheObjectNearIt) {
  EXPECT_TRUE(Checked(Load("box_9kg.yaml")).contacts.empty());
  const auto down_by = [](double way) {
    return "operator.script=[{action: grip, start: 0.5}, {action: move, start: 1, duration: 4, by: "
           "[0, 0, " +
           std::to_string(-way) + "]}]";
  };
  Scenario s = Load("box_9kg.yaml");
  const Pose X_WO = World(s).state().object.X_W;
  const double height = X_WO.p.z() - 0.1;  // of the lower face
  EXPECT_FALSE(CanReachFloor(Load("box_9kg.yaml", {down_by(height - 0.07)}), X_WO));
  s = Load("box_9kg.yaml", {down_by(height - 0.03)});
  EXPECT_TRUE(CanReachFloor(s, X_WO));
  const CheckReport report = Checked(s);
  ASSERT_EQ(report.contacts.size(), 1u);
  EXPECT_EQ(Only(report.contacts[0]).kind, Surface::Kind::kFloor);
  s.environment.floor = false;
  EXPECT_FALSE(CanReachFloor(s, X_WO));
  s = Load("box_9kg.yaml");
  s.operator_.type = "person";  // who may do anything
  EXPECT_TRUE(CanReachFloor(s, X_WO));
}

TEST(CheckContact, TheLowestPointIsThatOfTheCorners) {
  ObjectModel object;
  ModelShape box;
  box.size = {0.2, 0.4, 0.6};
  box.X_LG = PoseFromXyzRpy({0.1, 0, 0.05}, {0.3, -0.5, 0.8});
  object.collisions = {box};
  const Pose X_WO = PoseFromXyzRpy({0, 0, 1}, {0.7, 0.2, -1});
  double lowest = 1e9;
  for (const double x : {-0.1, 0.1})
    for (const double y : {-0.2, 0.2})
      for (const double z : {-0.3, 0.3})
        lowest = std::min(lowest, (X_WO * (box.X_LG * Vector3(x, y, z))).z());
  EXPECT_NEAR(LowestPoint(object, X_WO), lowest, 1e-12);
}

// A body that moves with the object adds −m ω² to the impedance. The handles of this scenario are
// on both sides of the object's origin, so that their mean motion is that of the origin.
TEST(CheckContact, APushedObjectAddsItsMass) {
  const CheckReport report =
      Checked(Load("box_9kg.yaml",
                   {"environment.objects=[{name: crate, primitive: {shape: box, size: [0.2, 0.2, "
                    "0.1], mass: 3}, xyz: [0.5, 0, 0.05]}]"}));
  ASSERT_EQ(report.contacts.size(), 1u);
  const ContactReport& contact = report.contacts[0];
  EXPECT_TRUE(contact.is_movable());
  EXPECT_EQ(contact.wall.normal, Vector3::UnitZ());
  EXPECT_FALSE(contact.held);
  ASSERT_TRUE(contact.pushed);
  EXPECT_NEAR(contact.pushed->mass, 3, 1e-12);
  EXPECT_TRUE(contact.pushed->stable);
  const Scenario s = Load("box_9kg.yaml");
  const FeltImpedance free = ImpedanceAt(World(s).Linearise(), s, report.stability->lead,
                                         1 / s.rate, Vector3::UnitZ(), kFeltFrequency);
  const double omega = 2 * std::numbers::pi * kFeltFrequency;
  const std::complex<double> added = contact.pushed->moving.requested - free.requested;
  EXPECT_NEAR(added.real(), -3 * omega * omega, 0.02 * 3 * omega * omega);
  EXPECT_NEAR(added.imag(), 0, 0.02 * 3 * omega * omega);
  EXPECT_NE(CheckText(report).find("  movable object 0 (crate) that cannot move, normal"),
            std::string::npos);
}

TEST(CheckContact, APickedObjectIsHeld) {
  const CheckReport report = Checked(Load("lift_crates.yaml"));
  int held = 0;
  for (const ContactReport& contact : report.contacts) {
    EXPECT_EQ(contact.held.has_value(), contact.is_movable());
    if (!contact.held) continue;
    EXPECT_TRUE(contact.held->stable);
    ++held;
  }
  EXPECT_EQ(held, 2);
}

TEST(CheckContact, NamesTheContactsOfLinksThatItDoesNotPredict) {
  const CheckReport report =
      Checked(Load("box_9kg.yaml",
                   {"environment.fixtures=[{shape: sphere, size: [0.1, 0, 0], xyz: [0.9, 0, 1.5], "
                    "keep_out: true}]",
                    "cobot.touches=[object]"}));
  EXPECT_TRUE(report.contacts.empty());
  EXPECT_EQ(report.link_contacts,
            (std::vector<std::string>{"environment.fixtures.0", "cobot.touches"}));
  EXPECT_NE(CheckText(report).find("contact that environment.fixtures.0, cobot.touches allows is "
                                   "not predicted."),
            std::string::npos);
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
  for (const char* name : {"single_arm.yaml", "slide_on_table.yaml", "linear_axis.yaml",
                           "hybrid_force_position.yaml", "lift_crates.yaml"})
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
