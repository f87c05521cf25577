// Tests the stability map: its search, its variations, its agreement with simulation, and the range
// in which its assumptions are valid.
#include "analysis/stability_map/stability_map.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "analysis/check/check.h"
#include "analysis/extents.h"
#include "analysis/scenarios.h"
#include "scenario/scenario_io.h"
#include "simulation/world.h"
#include "support/constants.h"
#include "support/soak.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

// ---- the search --------------------------------------------------------------------------------

FoundExtent Search(const std::vector<double>& hints, bool (*grows)(double), int* count = nullptr) {
  return FindExtent(hints, {20, 10000}, [&](double stiffness) {
    if (count) ++*count;
    Growth growth;
    growth.grows = grows(stiffness);
    growth.rate = growth.grows ? 0.1 : -0.1;
    return growth;
  });
}

TEST(FindExtent, FindsTheSignChangeForAnyPrediction) {
  for (const std::vector<double>& hints :
       {std::vector<double>{}, std::vector<double>{700}, std::vector<double>{60, 5000}}) {
    const FoundExtent found = Search(hints, [](double k) { return k > 703; });
    ASSERT_EQ(found.extent.boundaries.size(), 1u);
    EXPECT_TRUE(found.extent.stable_at_softest);
    EXPECT_NEAR(found.extent.critical()->stiffness / 703, 1, 0.04);
    EXPECT_FALSE(found.extent.least());
  }
}

TEST(FindExtent, FindsAnIslandOfStability) {
  const FoundExtent found = Search({}, [](double k) { return k < 90 || k > 2000; });
  EXPECT_FALSE(found.extent.stable_at_softest);
  ASSERT_TRUE(found.extent.least() && found.extent.critical());
  EXPECT_NEAR(found.extent.least()->stiffness / 90, 1, 0.04);
  EXPECT_NEAR(found.extent.critical()->stiffness / 2000, 1, 0.04);
  EXPECT_TRUE(found.extent.StableAt(500));
  EXPECT_FALSE(found.extent.StableAt(50));
  EXPECT_FALSE(found.extent.StableAt(3000));
}

TEST(FindExtent, NamesWhereNothingOrEverythingIsStable) {
  int count = 0;
  EXPECT_TRUE(Search(
                  {}, [](double) { return true; }, &count)
                  .extent.nothing_stable());
  EXPECT_LE(count, 6);  // no bisection without a change
  EXPECT_TRUE(Search({500}, [](double) { return false; }).extent.everything_stable());
}

// ---- the simulation ----------------------------------------------------------------------------

TEST(HoldScenario, IsAnOrdinaryScenarioThatNothingStops) {
  const Scenario s = Load("box_9kg.yaml");
  for (const bool tap : {false, true}) {
    const Scenario hold = HoldScenario(s, 0.01, tap);
    const Scenario read =
        ParseScenario(SaveScenario(hold), "hold", hold.folder());  // the values must be in their
                                                                   // allowed ranges
    EXPECT_EQ(SaveScenario(read), SaveScenario(hold));
    EXPECT_EQ(hold.operator_.script.size(), tap ? 3u : 1u);
    EXPECT_FALSE(hold.safety.oscillation.enabled);
    EXPECT_EQ(hold.operator_.hand.tremor_force, s.operator_.hand.tremor_force);  // noise stays on
  }
}

// Checks that the simulated growth has the rate and the frequency of the linear loop on both sides
// of its boundary.
void ExpectGrowthAsPredicted(const Variant& variant, double stiffness) {
  Scenario s = variant.scenario;
  s.operator_.hand = Varied(s.operator_.hand, s.operator_.hand.mass, stiffness);
  const HapticLoop loop(World(s).Linearise(), s, 1 / s.rate, LoopModel::kExact);
  double frequency = 0;
  const double predicted = loop.GrowthRate(s.operator_.hand, variant.lead, 1, &frequency);
  const Growth growth = MeasureGrowth(s, variant.lead);
  ASSERT_TRUE(growth.rate) << stiffness;
  EXPECT_EQ(growth.grows, predicted > 0) << stiffness;
  EXPECT_GE(growth.time, predicted > 0.5 ? 1 : 10) << stiffness;
  if (predicted > 0) {
    EXPECT_NEAR(*growth.rate, predicted, 0.1 + 0.2 * predicted) << stiffness;
    EXPECT_NEAR(growth.frequency / frequency, 1, 0.1) << stiffness;
  }
}

TEST(StabilityMap, SimulationGrowsWhereItIsPredictedTo) {
  const MapBase box = BaseOf(Load("box_9kg.yaml"));
  Variant variant = VariantOf(box, MapAxis::kLead, 0);
  const World world(variant.scenario);
  const HapticLoop loop(world.Linearise(), variant.scenario, kDt, LoopModel::kExact);
  const StableExtent extent =
      PredictExtent(loop, variant.scenario.operator_.hand, variant.lead, {50, 2000});
  ASSERT_TRUE(extent.critical());
  for (const double beside : {1 - kAgreement, 1 + kAgreement})
    ExpectGrowthAsPredicted(variant, beside * extent.critical()->stiffness);
}

TEST(StabilityMap, SimulationGrowsWhereItIsPredictedToForALightHandOnTheBar) {
  const MapBase bar = BaseOf(Load("bar_circle.yaml"));
  const Variant variant = VariantOf(bar, MapAxis::kHandMass, 0.375);
  for (const double stiffness : {590.0, 890.0}) ExpectGrowthAsPredicted(variant, stiffness);
}

// ---- variations --------------------------------------------------------------------------------

TEST(VariantOf, AnObjectOfTheSameMassIsTheScenariosOwn) {
  const MapBase base = BaseOf(Load("bar_circle.yaml"));
  const Variant same = VariantOf(base, MapAxis::kObjectMass, base.object_mass);
  const Variant nearly = VariantOf(base, MapAxis::kObjectMass, 1.001 * base.object_mass);
  EXPECT_EQ(SaveScenario(same.scenario), SaveScenario(base.scenario));
  ASSERT_TRUE(nearly.scenario.object.primitive);
  const LinearModel a = World(same.scenario).Linearise(), b = World(nearly.scenario).Linearise();
  EXPECT_LT((a.A - b.A).norm(), 0.01 * a.A.norm());
  EXPECT_LT((a.B - b.B).norm(), 0.01 * a.B.norm());
}

TEST(VariantOf, BasesFollowAHeavierObjectsHandles) {
  const MapBase base = BaseOf(Load("bar_circle.yaml"));
  const Variant heavier = VariantOf(base, MapAxis::kObjectMass, 2 * base.object_mass);
  const World before(base.scenario), after(heavier.scenario);
  EXPECT_NEAR(after.object_mass(), 2 * base.object_mass, 1e-9);
  for (int i = 0; i < kHands; ++i) {
    const auto h = static_cast<std::size_t>(i);
    const Vector3 a = before.state().handle[h].X_W.p - base.scenario.arm(i).base.xyz;
    const Vector3 b = after.state().handle[h].X_W.p - heavier.scenario.arm(i).base.xyz;
    EXPECT_LT((a - b).norm(), 1e-9);
    EXPECT_GT((after.state().handle[h].X_W.p - before.state().handle[h].X_W.p).norm(), 0.01);
  }
}

TEST(MapValues, HoldTheScenariosOwn) {
  for (const char* name : {"box_9kg.yaml", "bar_circle.yaml", "single_arm.yaml"}) {
    const MapBase base = BaseOf(Load(name));
    for (int k = 0; k < kMapAxes; ++k) {
      const auto axis = static_cast<MapAxis>(k);
      const auto values = MapValues(base, axis);
      EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
      EXPECT_EQ(std::count_if(values.begin(), values.end(),
                              [&](double v) { return IsOwn(base, axis, v); }),
                1)
          << name << k;
    }
  }
}

// ---- the complete map --------------------------------------------------------------------------

TEST(StabilityMap, RefusesAFolderThatCannotBe) {
  const std::string command = std::string(PREDICTOR_BINARY) +
                              " check --quiet --no-search --map /dev/null/map " +
                              (kScenarios / "single_arm.yaml").string() + " > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 2);
}

// This test takes minutes. The test computes the maps of the paper's two scenarios and checks that
// a second call reuses all results.
TEST(StabilityMap, SoakSimulatedBoundaryIsThePredictedOne) {
  if (Count(0, 1) == 0) GTEST_SKIP() << "set PREDICTOR_SOAK";
  for (const char* name : {"box_9kg.yaml", "bar_circle.yaml"}) {
    const test::TemporaryFolder folder;
    MapOptions options;
    options.folder = folder.path();
    const StabilityMap map = MakeStabilityMap(Load(name), options);
    EXPECT_EQ(map.kept, 0);
    const MapAgreement agreement = AgreementOf(map);
    EXPECT_GE(agreement.held, 20) << name;
    EXPECT_EQ(agreement.held_agree, agreement.held) << name << MapText(map);
    EXPECT_EQ(agreement.one_sided, 0) << name << MapText(map);
    const StabilityMap again = MakeStabilityMap(Load(name), options);
    EXPECT_GT(again.kept, 40);
    EXPECT_EQ(MapPage(again), MapPage(map));
    const StabilityMap other = MakeStabilityMap(Load(name, {"seed=2"}), options);
    EXPECT_EQ(other.kept, 0);
  }
}

// ---- where the assumptions are valid -----------------------------------------------------------

TEST(DeparturesAt, NoneWhereNothingInterferes) {
  const FoundExtent found = AboutAThousand(0);
  EXPECT_TRUE(DeparturesAt(found, found.extent.boundaries[0]).empty());
  EXPECT_NEAR(UncertaintyOf(found, found.extent.boundaries[0]).value(), 0, 1e-6);
}

TEST(DeparturesAt, ALimitOnTheStableSide) {
  FoundExtent found = AboutAThousand(0);
  auto& limited = found.samples[2].growth.limited;
  limited[static_cast<std::size_t>(Limiting::kAcceleration)] = kLimitedShare / 2;
  EXPECT_TRUE(DeparturesAt(found, found.extent.boundaries[0]).empty());
  limited[static_cast<std::size_t>(Limiting::kAcceleration)] = 2 * kLimitedShare;
  const auto departures = DeparturesAt(found, found.extent.boundaries[0]);
  ASSERT_EQ(departures.size(), 1u);
  EXPECT_NE(departures[0].find("acceleration"), std::string::npos);
  // A limit that acts far from the boundary or on its other side is not a departure, because it
  // does not affect the boundary.
  FoundExtent elsewhere = AboutAThousand(0);
  for (const std::size_t k : {0u, 1u, 3u, 4u, 5u}) elsewhere.samples[k].growth.limited.fill(1);
  EXPECT_TRUE(DeparturesAt(elsewhere, elsewhere.extent.boundaries[0]).empty());
}

TEST(DeparturesAt, NoiseThatReachesALimitAtOnce) {
  FoundExtent found = AboutAThousand(0);
  found.samples[3].growth.rate.reset();
  EXPECT_EQ(DeparturesAt(found, found.extent.boundaries[0]).size(), 1u);
}

TEST(DeparturesAt, GrowthThatScattersTooMuch) {
  EXPECT_TRUE(DeparturesAt(AboutAThousand(0.01), AboutAThousand(0).extent.boundaries[0]).empty());
  EXPECT_EQ(DeparturesAt(AboutAThousand(0.5), AboutAThousand(0).extent.boundaries[0]).size(), 1u);
}

TEST(DeparturesAt, GrowthThatWasMeasuredTooSeldomToJudge) {
  FoundExtent found = AboutAThousand(0);
  const Boundary boundary = found.extent.boundaries[0];
  for (const std::size_t k : {0u, 1u, 4u}) found.samples[k].growth.rate.reset();
  EXPECT_TRUE(UncertaintyOf(found, boundary));
  EXPECT_TRUE(DeparturesAt(found, boundary).empty());
  found.samples[5].growth.rate.reset();  // two samples remain, and any line fits two samples
  EXPECT_FALSE(UncertaintyOf(found, boundary));
  EXPECT_EQ(DeparturesAt(found, boundary).size(), 1u);
}

TEST(DeparturesOf, SlowLoopsAndReadingsAreNamed) {
  EXPECT_TRUE(DeparturesOf(Load("box_9kg.yaml")).empty());
  EXPECT_TRUE(DeparturesOf(Load("box_9kg.yaml", {"rate=500"})).empty());
  for (const char* slow : {"rate=100", "device.arms.left.sample_rate=100",
                           "device.arms.right.sensor.sample_rate=100"}) {
    const auto departures = DeparturesOf(Load("box_9kg.yaml", {slow}));
    ASSERT_EQ(departures.size(), 1u) << slow;
    EXPECT_NE(departures[0].find("100 Hz"), std::string::npos) << departures[0];
  }
}

// A slow loop counts as a departure because it grows between its own boundary and the predicted
// one.
TEST(DeparturesOf, ASlowLoopGrowsWhereItIsPredictedToDecay) {
  for (const auto& [rate, grows] : {std::pair{"rate=1000", false}, {"rate=100", true}}) {
    const Variant v = VariantOf(BaseOf(Load("box_9kg.yaml", {rate})), MapAxis::kLead, 0);
    Scenario s = v.scenario;
    s.operator_.hand = Varied(s.operator_.hand, s.operator_.hand.mass, 196);
    const HapticLoop loop(World(s).Linearise(), s, 1 / s.rate, LoopModel::kExact);
    EXPECT_LT(loop.GrowthRate(s.operator_.hand, v.lead, 1), 0) << rate;
    EXPECT_EQ(MeasureGrowth(s, v.lead).grows, grows) << rate;
  }
}

}  // namespace
}  // namespace predictor
