// The stability map: its prediction compared with closed forms and with simulation, its search, its
// criteria, its stored results, and its plots.
#include "analysis/stability_map/stability_map.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <regex>

#include "analysis/check/check.h"
#include "analysis/scenarios.h"
#include "analysis/spring_and_mass.h"
#include "analysis/stability_map/store.h"
#include "core/error.h"
#include "scenario/scenario_io.h"
#include "simulation/world.h"
#include "support/constants.h"
#include "support/soak.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;
constexpr double kNone = 1e-3;  // growth rate that rounding alone can cause [1/s]
// ---- the prediction ----------------------------------------------------------------------------

// A hand that consists of a spring along x and a delayed reflex.
HandSpec SpringWithReflex(double stiffness, double reflex_gain, double reflex_delay) {
  HandSpec hand = Spring(stiffness);
  hand.reflex_gain = reflex_gain;
  hand.reflex_delay = reflex_delay;
  return hand;
}

// One arm without dynamics, except for a delay [s] from the virtual to the real handle and back.
Scenario PureDelay(double delay) {
  Scenario s;
  s.left_handle.emplace();
  s.device.left.emplace();
  s.device.left->loop = {20000, 1, delay};
  s.device.left->sensor.low_pass = 0;
  s.device.left->sensor.delay = 0;
  s.rendering.kp = s.rendering.ko = 0;
  return s;
}

// M s² + B s + K (1 + g e^−sT) = 0 at s = jω for ωT = 2π n + π/2: M ω² = K and B = g K/ω. If too
// few states model the delay, its phase is wrong at this frequency.
TEST(ExactLoop, KnowsTheReflexAfterWholeTurnsOfItsPhase) {
  const double T = 0.060, g = 0.4, mass = 2;
  for (const int turns : {0, 1}) {
    const double omega = (2 * kPi * turns + kPi / 2) / T;  // 4 Hz, 21 Hz
    const double stiffness = mass * omega * omega;
    const double critical = g * stiffness / omega;
    const Scenario s = PureDelay(0);
    const HandSpec hand = SpringWithReflex(stiffness, g, T);
    double frequency = 0;
    const HapticLoop less(Mass(mass, 0.97 * critical), s, kDt, LoopModel::kExact);
    const HapticLoop more(Mass(mass, 1.03 * critical), s, kDt, LoopModel::kExact);
    EXPECT_GT(less.GrowthRate(hand, 0, 1, &frequency), 0) << turns;
    EXPECT_NEAR(frequency, omega / (2 * kPi), 0.02 * omega / (2 * kPi)) << turns;
    EXPECT_LT(more.GrowthRate(hand, 0, 1), kNone) << turns;
  }
}

// M s² + B s + K e^−sT: M ω² = K cos ωT, B ω = K sin ωT. The model adds no tick to the delay.
TEST(ExactLoop, HasNoDelayButItsOwn) {
  const double T = 0.040, mass = 9, omega = 20;
  const double stiffness = mass * omega * omega / std::cos(omega * T);
  const double critical = stiffness * std::sin(omega * T) / omega;
  const Scenario s = PureDelay(T);
  const HandSpec hand = SpringWithReflex(stiffness, 0, T);
  for (const double share : {0.99, 1.01}) {
    const HapticLoop loop(Mass(mass, share * critical), s, kDt, LoopModel::kExact);
    EXPECT_EQ(loop.GrowthRate(hand, 0, 1) > kNone, share < 1) << share;
  }
  // The loop model that selects the leads has another tick and a half of delay: 2 or 3 % here.
  const HapticLoop reserved(Mass(mass, 1.01 * critical), s, kDt);
  EXPECT_GT(reserved.GrowthRate(hand, 0, 1), kNone);
}

// M s² + B s + K (1 + τ s) e^−sT: a lead with unfiltered acceleration differs from a lead of zero.
TEST(ExactLoop, AnUnfilteredLeadLeads) {
  const double T = 0.040, lead = 0.020, mass = 9, omega = 15;
  const double c = std::cos(omega * T), si = std::sin(omega * T);
  const double stiffness = mass * omega * omega / (c + lead * omega * si);
  const double critical = stiffness * (si - lead * omega * c) / omega;
  Scenario s = PureDelay(T);
  s.rendering.lead_cutoff = 0;
  for (const double share : {0.97, 1.03}) {
    const HapticLoop loop(Mass(mass, share * critical), s, kDt, LoopModel::kExact);
    EXPECT_EQ(loop.GrowthRate(SpringWithReflex(stiffness, 0, T), lead, 1) > kNone, share < 1)
        << share;
  }
}

TEST(PredictExtent, FindsTheClosedForm) {
  const Scenario s = PureDelay(0.02);
  const HapticLoop loop(Mass(9, 15), s, kDt, LoopModel::kExact);
  const StableExtent extent = PredictExtent(loop, SpringWithReflex(100, 0, 0.06), 0, {20, 10000});
  ASSERT_TRUE(extent.stable_at_softest);
  ASSERT_EQ(extent.boundaries.size(), 1u);
  const double critical = extent.critical()->stiffness;
  const double omega = 2 * kPi * extent.critical()->frequency;
  EXPECT_NEAR(critical, 15 * omega / std::sin(omega * 0.02), 0.03 * critical);
  EXPECT_NEAR(9 * omega * omega, critical * std::cos(omega * 0.02), 0.03 * critical);
}

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

TEST(FindExtent, FindsWhereTheSignChangesWhateverIsPredicted) {
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

// The simulated growth, its rate and its frequency match the linear loop on both sides of its
// boundary.
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

// ---- where the assumptions are valid -----------------------------------------------------------

// Samples around a boundary at 1000 N/m. Their growth rates lie on a line, apart from `scatter`.
FoundExtent AboutAThousand(double scatter) {
  FoundExtent found;
  int sign = 1;
  for (const double k : {800.0, 950.0, 985.0, 1015.0, 1050.0, 1250.0}) {
    Growth growth;
    growth.rate = 2 * std::log(k / 1000) + scatter * sign;
    growth.grows = k > 1000;
    found.samples.push_back({k, growth});
    sign = -sign;
  }
  found.extent.boundaries = {{1000, true, 2}};
  return found;
}

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
  // Limiting far from the boundary or on its other side does not affect the boundary.
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
  found.samples[5].growth.rate.reset();  // two samples remain, and a line through two always fits
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

// This is why a slow loop is a departure: between its boundary and the predicted one, it grows.
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

// ---- stored results ----------------------------------------------------------------------------

MapPoint SomePoint() {
  MapPoint point;
  point.value = 0.015;
  point.simulated = true;
  point.predicted = {true, {{218.25, true, 1.56}}};
  point.found = AboutAThousand(0.1);
  point.found.samples[5].growth.rate.reset();
  point.found.samples[5].growth.stopped = "sensor";
  point.found.samples[4].growth.limited[2] = 0.25;
  return point;
}

TEST(MapStore, KeepsWhatIsFinishedThroughACut) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "points.jsonl";
  MapPoint read;
  {
    MapStore store(file);
    EXPECT_FALSE(store.Find("a", &read));
    store.Add("a", SomePoint());
    store.Add("b", SomePoint());
  }
  // As if the program was killed while it wrote the second line.
  fs::resize_file(file, fs::file_size(file) - 40);
  {
    MapStore store(file);
    ASSERT_TRUE(store.Find("a", &read));
    EXPECT_FALSE(store.Find("b", &read));
    store.Add("c", read);
  }
  MapStore store(file);
  for (const char* key : {"a", "c"}) {
    ASSERT_TRUE(store.Find(key, &read)) << key;
    const MapPoint point = SomePoint();
    EXPECT_EQ(read.value, point.value);
    ASSERT_TRUE(read.predicted.critical());
    EXPECT_EQ(read.predicted.critical()->stiffness, 218.25);
    ASSERT_EQ(read.found.samples.size(), point.found.samples.size());
    for (std::size_t k = 0; k < point.found.samples.size(); ++k) {
      EXPECT_EQ(read.found.samples[k].growth.rate, point.found.samples[k].growth.rate);
      EXPECT_EQ(read.found.samples[k].growth.limited, point.found.samples[k].growth.limited);
      EXPECT_EQ(read.found.samples[k].growth.stopped, point.found.samples[k].growth.stopped);
    }
  }
}

TEST(MapStore, SaysWhenThereIsNoRoom) {
  const test::TemporaryFolder folder;
  const auto add_without_room = [&] {
    MapStore store(folder.path() / "points.jsonl");
    const rlimit limit = {4000, 4000};  // size of a file [bytes]; the error message must fit as
                                        // well
    setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, SIG_IGN);
    try {
      for (int k = 0; k < 100; ++k) store.Add(std::to_string(k), SomePoint());
    } catch (const InputError& error) {
      std::fputs(error.what(), stderr);
      std::_Exit(0);
    }
    std::_Exit(1);
  };
  EXPECT_EXIT(add_without_room(), testing::ExitedWithCode(0), "disk with free space");
}

TEST(MapStore, PassesOverWhatIsNoPoint) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "points.jsonl";
  std::ofstream(file) << "no json\n[1]\n{\"key\": 3}\n{\"key\": \"x\", \"value\": \"y\"}\n\n";
  MapStore store(file);
  MapPoint read;
  EXPECT_FALSE(store.Find("x", &read));
}

TEST(HashOf, IsFowlerNollVo) {
  EXPECT_EQ(HashOf(""), "cbf29ce484222325");
  EXPECT_EQ(HashOf("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(HashOf("foobar"), "85944171f73967e8");
}

// ---- plots -------------------------------------------------------------------------------------

// Every plot has the same point at each value, but nothing is stable at the second value, and the
// cobot cannot carry the object at the last value.
StabilityMap SomeMap() {
  StabilityMap map;
  map.base.scenario.name = "A <box> & more";
  map.base.scenario.left_handle.emplace();
  map.base.scenario.device.left.emplace();
  map.base.lag = 0.022;
  map.base.object_mass = 9;
  for (int k = 0; k < kMapAxes; ++k) {
    MapPicture& picture = map.pictures[static_cast<std::size_t>(k)];
    picture.axis = static_cast<MapAxis>(k);
    for (const double value : MapValues(map.base, picture.axis)) {
      picture.points.push_back(SomePoint());
      picture.points.back().value = value;
    }
    picture.points[1].predicted = picture.points[1].found.extent = {false, {}};
    picture.points.back().impossible = "The cobot cannot hold it.";
  }
  return map;
}

// Every element that is opened is closed, in the right order.
void ExpectWellFormed(const std::string& xml) {
  std::vector<std::string> open;
  const std::regex tag(R"re(<(/?)([a-zA-Z][a-zA-Z0-9]*)((?:[^<>"]|"[^"]*")*?)(/?)>)re");
  for (std::sregex_iterator it(xml.begin(), xml.end(), tag), end; it != end; ++it) {
    if ((*it)[1].length() > 0) {
      ASSERT_FALSE(open.empty()) << it->str();
      ASSERT_EQ(open.back(), (*it)[2]) << it->str();
      open.pop_back();
    } else if ((*it)[4].length() == 0 && (*it)[2] != "meta") {
      open.push_back((*it)[2]);
    }
  }
  EXPECT_TRUE(open.empty()) << open.back();
}

// The page without its script, which is not markup.
std::string WithoutScript(const std::string& page) {
  const std::size_t end = page.rfind("</script>");
  return page.substr(0, page.rfind("<script>")) + page.substr(end + sizeof "</script>" - 1);
}

std::size_t Occurrences(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++count;
  return count;
}

const PlotSeries* SeriesOf(const Plot& plot, const std::string& label) {
  for (const PlotSeries& series : plot.panels.at(0).series)
    if (series.label == label) return &series;
  return nullptr;
}

TEST(MapPlot, HasLabelsWithUnitsAndALegend) {
  const StabilityMap map = SomeMap();
  for (const MapPicture& picture : map.pictures) {
    const Plot plot = MapPlot(map, picture);
    const MapAxisText& text = TextOf(picture.axis);
    EXPECT_EQ(AxisTitle(plot.x), std::string(text.quantity) + " [" + text.unit + "]");
    EXPECT_NE(AxisTitle(plot.panels.at(0).y).find("[N/m]"), std::string::npos);
    for (const char* label : {"predicted: stiffest stable hand", "within 20 % of it",
                              "predicted: unstable", "impossible variant (see the table)",
                              "simulated: nothing is stable", "the scenario as it is"})
      EXPECT_TRUE(SeriesOf(plot, label)) << label;
    EXPECT_FALSE(SeriesOf(plot, "simulated: all stable up to here"));  // the map has no such point
  }
}

// The plot shows the points of the map in its own unit. Crosses mark the values at which nothing is
// stable.
TEST(MapPlot, ShowsWhatWasPredictedAndFound) {
  const StabilityMap map = SomeMap();
  for (const MapPicture& picture : map.pictures) {
    const Plot plot = MapPlot(map, picture);
    const double per_si = TextOf(picture.axis).per_si;
    const PlotSeries* predicted = SeriesOf(plot, "predicted: stiffest stable hand");
    const PlotSeries* nothing = SeriesOf(plot, "simulated: nothing is stable");
    ASSERT_TRUE(predicted && nothing);
    ASSERT_EQ(predicted->x->size(), picture.points.size());
    for (std::size_t k = 0; k < picture.points.size(); ++k) {
      const MapPoint& point = picture.points[k];
      EXPECT_EQ((*predicted->x)[k], per_si * point.value);
      const bool known = point.impossible.empty() && point.predicted.critical();
      EXPECT_EQ(std::isfinite((*predicted->y)[k]), known) << k;
      if (known) {
        EXPECT_EQ((*predicted->y)[k], 218.25);
      }
    }
    EXPECT_EQ(*nothing->x, (std::vector<double>{per_si * picture.points[1].value}));
    std::size_t found = 0;  // held and limited boundaries, stiffest and softest
    for (const PlotSeries& series : plot.panels[0].series)
      if (series.kind == SeriesKind::kMarkers && &series != nothing)
        for (const double y : *series.y) found += y == 1000;
    EXPECT_EQ(found, picture.points.size() - 2);
    for (const PlotSeries& series : plot.panels[0].series)
      EXPECT_EQ(series.x->size(), series.y->size()) << series.label;
  }
}

TEST(MapPage, NeedsNoOtherFileAndSaysWhereNothingIsStable) {
  const StabilityMap map = SomeMap();
  if (const char* folder = std::getenv("PREDICTOR_REPORTS"))  // for inspection
    std::ofstream(fs::path(folder) / "map.html") << MapPage(map);
  const std::string page = WithoutScript(MapPage(map));
  ExpectWellFormed(page);
  EXPECT_EQ(page.find("src="), std::string::npos);
  EXPECT_EQ(Occurrences(page, "href="), Occurrences(page, "href=\"#"));  // within the page
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_NE(page.find("A &lt;box&gt; &amp; more"), std::string::npos);
  EXPECT_NE(page.find("Predicted: no hand is stable at"), std::string::npos);
  EXPECT_NE(page.find("Simulated: no hand is stable at"), std::string::npos);
  EXPECT_NE(page.find("The cobot cannot hold it."), std::string::npos);
  const std::string text = MapText(map);
  EXPECT_NE(text.find("nothing stable"), std::string::npos);
  EXPECT_NE(text.find("impossible variant"), std::string::npos);
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

// Takes minutes: computes the maps of the paper's two scenarios and checks that a second call
// computes nothing again.
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

}  // namespace
}  // namespace predictor
