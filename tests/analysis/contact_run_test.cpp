// Tests what the report says about contact.
#include "analysis/contact_run/contact_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "analysis/scenarios.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"

namespace predictor {
namespace {

constexpr double kHalfHeight = 0.1;  // of the box of 9 kg [m]
constexpr double kPlane = -1;        // height of the fixture [m]

std::string Fixtures(const std::string& keys) {
  return "environment.fixtures=[{name: ground, shape: plane, xyz: [0, 0, -1], " + keys + "}]";
}

// Returns the record of a box whose lower face is `depth` [m] below the plane and moves at `speed`
// [m/s] along z, while a hand presses down on it with 20 N.
TickRecord Pressed(double depth, double speed) {
  TickRecord record{};
  record.ran = 1;
  record.object.pose = {{0.5, 0.2, kPlane + kHalfHeight - depth}, {1, 0, 0, 0}};
  record.object.twist = {0, 0, speed, 0, 0, 0};
  record.hands[0].present = 1;
  record.hands[0].wrench = {5, 0, -20, 0, 0, 0};
  return record;
}

TEST(ContactCollector, FindsDepthForceAndTimeOfAPressedBox) {
  ContactCollector collector(
      Load("box_9kg.yaml", {Fixtures("stiffness: 20000, damping: 60"), "environment.floor=false"}));
  collector.Add(Pressed(-0.01, 0));  // above
  EXPECT_EQ(collector.facts()[0].time, 0);
  for (int k = 0; k < 100; ++k) collector.Add(Pressed(0.001, -0.01));
  for (int k = 0; k < 20; ++k) collector.Add(Pressed(0.0005, 0.01));
  TickRecord paused = Pressed(0.002, 0);
  paused.ran = 0;
  collector.Add(paused);
  ASSERT_EQ(collector.facts().size(), 1U);
  const ContactFacts& facts = collector.facts()[0];
  EXPECT_NEAR(facts.time, 0.12, 1e-9);
  EXPECT_NEAR(facts.depth, 0.001, 1e-6);
  EXPECT_NEAR(facts.force, 4 * (20000 * 0.001 + 60 * 0.01), 0.1);  // at four points
  EXPECT_NEAR(facts.pressing, 20, 1e-9);
}

TEST(ContactCollector, ARigidFixtureHasNoModelledForce) {
  ContactCollector collector(Load("box_9kg.yaml", {Fixtures("friction: 0.2")}));
  collector.Add(Pressed(0.001, -0.01));
  EXPECT_EQ(collector.facts()[0].force, 0);
  EXPECT_NEAR(collector.facts()[0].depth, 0.001, 1e-6);
}

// Movable objects that rest on a fixture are not contact of the carried object.
TEST(ContactCollector, IgnoresMovableObjectsOnAFixture) {
  const Scenario s = Load("push_boxes.yaml");
  const double table = s.environment.fixtures[0].xyz.z() + s.environment.fixtures[0].size.z() / 2;
  ContactCollector collector(s);
  TickRecord record = Pressed(-0.01, 0);
  record.object.pose.p = {0.465, 0, table + kHalfHeight + 0.01};
  collector.Add(record);
  EXPECT_EQ(collector.facts()[0].time, 0);
  record.object.pose.p[2] = table + kHalfHeight - 0.001;
  collector.Add(record);
  EXPECT_NEAR(collector.facts()[0].time, 0.001, 1e-12);
  EXPECT_NEAR(collector.facts()[0].depth, 0.001, 1e-6);
}

// The floor is at z = 0, and the table at 0.3 m.
TEST(ContactCollector, DistinguishesFloorAndTable) {
  ContactCollector collector(
      Load("box_9kg.yaml", {"environment.table={size: [0.4, 0.4, 0.1], top: [0.5, 0.2, 0.3]}"}));
  ASSERT_EQ(collector.facts().size(), 2U);
  const ContactFacts &table = collector.facts()[0], &floor = collector.facts()[1];
  EXPECT_EQ(table.surface.kind, Surface::Kind::kTable);
  EXPECT_EQ(floor.surface.kind, Surface::Kind::kFloor);
  TickRecord record = Pressed(0, 0);
  record.object.pose.p = {0.5, 0.2, 0.3 + kHalfHeight - 0.001};
  collector.Add(record);
  EXPECT_NEAR(table.time, 0.001, 1e-12);
  EXPECT_NEAR(table.depth, 0.001, 1e-6);
  EXPECT_NEAR(table.pressing, 20, 1e-9);
  EXPECT_EQ(floor.time, 0);
  record.object.pose.p = {-1, 0.2, kHalfHeight - 0.002};
  collector.Add(record);
  EXPECT_NEAR(table.time, 0.001, 1e-12);
  EXPECT_NEAR(floor.time, 0.001, 1e-12);
  EXPECT_NEAR(floor.depth, 0.002, 1e-6);
}

TEST(ContactCollector, FindsTheFloorWithoutOtherBodies) {
  ContactCollector collector(Load("box_9kg.yaml"));
  TickRecord record = Pressed(0, 0);
  record.object.pose.p = {0.5, 0.2, kHalfHeight - 0.002};
  collector.Add(record);
  ASSERT_EQ(collector.facts().size(), 1U);
  EXPECT_NEAR(collector.facts()[0].depth, 0.002, 1e-6);
}

// A movable object that the carried object holds does not touch it.
TEST(ContactCollector, FindsAPushedMovableObject) {
  ContactCollector collector(Load(
      "box_9kg.yaml", {"environment.objects=[{name: crate, primitive: {shape: box, size: [0.2, "
                       "0.2, 0.2], mass: 3}, xyz: [0.5, 0.2, 0.1]}]"}));
  const auto crate = std::ranges::find(collector.facts(), Surface{Surface::Kind::kMovable, 0},
                                       &ContactFacts::surface);
  ASSERT_NE(crate, collector.facts().end());
  TickRecord record = Pressed(0, 0);
  record.movable_count = 1;
  record.movables[0] = {{0.5, 0.2, 0.5}, {1, 0, 0, 0}};
  record.object.pose.p = {0.5, 0.2, 0.6 + kHalfHeight - 0.001};
  record.held = 1;
  collector.Add(record);
  EXPECT_EQ(crate->time, 0);
  record.held = 0;
  collector.Add(record);
  EXPECT_NEAR(crate->time, 0.001, 1e-12);
  EXPECT_NEAR(crate->depth, 0.001, 1e-6);
  EXPECT_NEAR(crate->pressing, 20, 1e-9);
}

// An obstacle counts only after it has appeared, not while it waits because it overlaps the object.
TEST(ContactCollector, AnObstacleIsThereWhenItHasAppeared) {
  const Scenario s = Load(
      "box_9kg.yaml", {Fixtures("stiffness: 20000, damping: 60"),
                       "events=[{event: obstacle_appears, fixture: ground, trigger: {after: 4}}]"});
  ContactCollector collector(s);
  TickRecord touching = Pressed(0.001, 0), away = Pressed(-0.01, 0);
  collector.Add(touching);
  EXPECT_EQ(collector.facts()[0].time, 0);
  touching.events = away.events = 1;
  collector.Add(touching);
  EXPECT_EQ(collector.facts()[0].time, 0);
  collector.Add(away);
  collector.Add(touching);
  EXPECT_NEAR(collector.facts()[0].time, 0.001, 1e-12);
}

// Returns the chapter about a run of a scenario.
std::string ChapterOf(const Scenario& s, double seconds, ContactRun* run,
                      std::vector<Plot>* plots) {
  Emulator emulator(s);
  ContactCollector collector(s);
  Simulate(&emulator, seconds, [&](const TickRecord& record) { collector.Add(record); });
  run->scenario = s;
  run->facts = collector.facts();
  PredictContacts(emulator.setup().lead.lead, run);
  ReportPage page("Run");
  AddContactChapter(*run, &page);
  *plots = page.plots();
  return page.Finish();
}

TEST(ContactChapter, StatesWhatTheDeviceCannotRender) {
  const Scenario s = Load("slide_on_table.yaml");
  ContactRun run;
  std::vector<Plot> plots;
  const std::string page = ChapterOf(s, 10, &run, &plots);
  EXPECT_NE(page.find("<section id=\"contact\""), std::string::npos);
  EXPECT_EQ(run.problem, "");
  ASSERT_EQ(run.facts.size(), 3U);
  EXPECT_GT(run.facts[0].time, 1);  // the table
  EXPECT_LT(run.facts[0].depth, 2e-3);
  EXPECT_GT(run.facts[0].pressing, 1);
  for (const char* words : {"rigid", "not recorded", "(modelled)", "measured (simulated sensors)"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  ASSERT_EQ(run.predictions.size(), 2U);
  ASSERT_EQ(plots.size(), 2U);
  for (std::size_t k = 0; k < plots.size(); ++k) {
    EXPECT_EQ(AxisTitle(plots[k].x), "Frequency [Hz]");
    EXPECT_EQ(AxisTitle(plots[k].panels[0].y), "Magnitude [MN/m]");
    for (const PlotSeries& series : plots[k].panels[0].series) {
      EXPECT_EQ(series.x->front(), 0.1);
      EXPECT_EQ(series.x->back(), 40);
    }
    EXPECT_EQ((*plots[k].panels[0].series[1].y)[10],
              std::abs(run.predictions[k].spectrum[10].felt.rendered) / 1e6);
  }
}

TEST(ContactChapter, NamesTheFixturesAndTheirStiffness) {
  ContactRun run;
  std::vector<Plot> plots;
  const std::string page = ChapterOf(
      Load("box_9kg.yaml", {Fixtures("stiffness: 20000, damping: 60")}), 0.1, &run, &plots);
  ASSERT_EQ(run.predictions.size(), 1U);
  EXPECT_NE(page.find("0 (ground)"), std::string::npos);
  EXPECT_NE(page.find("20 kN/m, 60 N·s/m"), std::string::npos);
  EXPECT_EQ(run.facts[0].time, 0);
}

TEST(ContactChapter, IsAbsentIfOnlyTheFloorExistsAndIsNotTouched) {
  ContactRun run;
  std::vector<Plot> plots;
  const std::string page = ChapterOf(Load("box_9kg.yaml"), 0.1, &run, &plots);
  EXPECT_EQ(page.find("id=\"contact\""), std::string::npos);
  EXPECT_TRUE(plots.empty());
}

TEST(ContactChapter, DescribesTheTable) {
  ContactRun run;
  std::vector<Plot> plots;
  const std::string page = ChapterOf(Load("hybrid_force_position.yaml"), 0.1, &run, &plots);
  ASSERT_EQ(run.predictions.size(), 1U);
  EXPECT_EQ(run.facts[0].surface.kind, Surface::Kind::kTable);
  EXPECT_GT(run.facts[0].time, 0.05);
  EXPECT_NE(page.find("<th>table</th>"), std::string::npos);
  EXPECT_NE(page.find("not given"), std::string::npos);
  EXPECT_EQ(page.find("<th>floor</th>"), std::string::npos);
}

TEST(ContactChapter, InDirectModeNoArmsRenderTheContact) {
  ContactRun run;
  std::vector<Plot> plots;
  const std::string page =
      ChapterOf(Load("slide_on_table.yaml", {"mode=direct"}), 0.1, &run, &plots);
  EXPECT_TRUE(run.predictions.empty());
  EXPECT_NE(page.find("no arms render the contact"), std::string::npos);
}

}  // namespace
}  // namespace predictor
