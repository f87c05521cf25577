// Tests the part of the stability map that is about walls.
#include "analysis/stability_map/wall_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/scenarios.h"
#include "simulation/world.h"
#include "support/soak.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

constexpr const char* kPlane =
    "environment.fixtures=[{shape: plane, xyz: [0, 0, -1], stiffness: 20000, damping: 60}]";

TEST(WallMap, AssumesAWallBelowAnObjectThatMeetsNoFixture) {
  const MapBase base = BaseOf(Load("box_9kg.yaml"));
  const std::vector<WallPicture> pictures = WallPicturesOf(base);
  ASSERT_EQ(pictures.size(), 1U);
  EXPECT_TRUE(pictures[0].at.surfaces.empty());
  EXPECT_EQ(pictures[0].at.wall.normal, Vector3::UnitZ());
  EXPECT_EQ(pictures[0].at.Varying().damping, 0);
  EXPECT_EQ(WallInWords(pictures[0]),
            "assumed wall below the object, normal [0.00, 0.00, 1.00], no damping");
  std::vector<double> delays;
  for (const WallLine& line : pictures[0].lines) {
    delays.push_back(line.delay);
    std::vector<double> masses;
    for (const MapPoint& point : line.points) masses.push_back(point.value);
    EXPECT_EQ(masses, MapValues(base, MapAxis::kHandMass));
  }
  EXPECT_EQ(delays, MapValues(base, MapAxis::kDelay));
}

TEST(WallMap, HasAPictureForEachSideThatCanTouch) {
  const std::vector<WallPicture> pictures = WallPicturesOf(BaseOf(Load("slide_on_table.yaml")));
  ASSERT_EQ(pictures.size(), 2U);  // a table below, and a stop at its left
  EXPECT_EQ(WallInWords(pictures[1]), "fixture 1, normal [0.00, -1.00, 0.00], no damping");
}

const WallLine& OwnLine(const MapBase& base, const WallPicture& picture) {
  return *std::find_if(picture.lines.begin(), picture.lines.end(), [&](const WallLine& line) {
    return IsOwn(base, MapAxis::kDelay, line.delay);
  });
}

TEST(WallMap, EachLineHasTheLeadOfARunWithItsDelay) {
  const MapBase chosen = BaseOf(Load("box_9kg.yaml"));
  const WallPicture picture = WallPicturesOf(chosen)[0];
  EXPECT_EQ(OwnLine(chosen, picture).lead, chosen.lead);
  EXPECT_GT(picture.lines.back().lead, 2 * picture.lines.front().lead);
  const MapBase set = BaseOf(Load("box_9kg.yaml", {"rendering.lead=0.01"}));
  const WallPicture with_lead = WallPicturesOf(set)[0];
  for (const WallLine& line : with_lead.lines) EXPECT_EQ(line.lead, 0.01);
}

// Each point is the largest stiffness that is predicted for the same hand, delay and wall.
TEST(WallMap, PointsAreTheSinglePredictions) {
  const Scenario s = Load("box_9kg.yaml", {kPlane});
  const MapBase base = BaseOf(s);
  const ContactWall at = WallPicturesOf(base)[0].at;
  EXPECT_EQ(at.Varying().damping, 60);
  const LinearModel world = World(s).Linearise();
  double before = kStiffestWall;
  for (const double mass : {1.0, 1.5, 2.4}) {
    Scenario other = s;
    other.operator_.hand.mass = mass;
    for (ArmSpec* arm : {&*other.device.left, &*other.device.right}) arm->loop.delay = 0.006;
    Wall wall = at.wall;
    wall.damping = 60, wall.inertia = 0;
    const WallLimit limit =
        StiffestStableWall(world, other, other.operator_.hand, 0.018, wall, LoopModel::kExact);
    const StableExtent extent =
        PredictWall(base, WallVariantOf(base, {0.006, 0.018, {}}, mass), at);
    ASSERT_TRUE(limit.reached && limit.stiffness > 0) << mass;
    ASSERT_TRUE(extent.critical()) << mass;
    EXPECT_EQ(extent.critical()->stiffness, limit.stiffness) << mass;
    EXPECT_EQ(extent.critical()->frequency, limit.frequency) << mass;
    EXPECT_LT(limit.stiffness, before) << mass;  // a heavier hand allows less
    before = limit.stiffness;
  }
}

// Returns a map with made-up predictions, which fall with mass and delay. For the heaviest hand, no
// stiffness is stable, and for the lightest hand, every stiffness is.
StabilityMap MadeUp() {
  StabilityMap map;
  map.base = BaseOf(Load("box_9kg.yaml", {kPlane}));
  map.walls = WallPicturesOf(map.base);
  for (WallLine& line : map.walls[0].lines) {
    for (MapPoint& point : line.points)
      point.predicted = {true, {{500 / (point.value * (0.01 + line.delay)), true, 20}}};
    line.points.front().predicted = {true, {}};
    line.points.back().predicted = {false, {}};
  }
  return map;
}

TEST(WallMap, PlotsOneLineForEachDelay) {
  const StabilityMap map = MadeUp();
  const Plot plot = WallPlot(map, 0);
  EXPECT_EQ(AxisTitle(plot.x), "mass of each hand [kg]");
  EXPECT_EQ(AxisTitle(plot.panels[0].y), "Largest stiffness of the wall [kN/m]");
  const auto& lines = map.walls[0].lines;
  ASSERT_EQ(plot.panels[0].series.size(), lines.size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const PlotSeries& series = plot.panels[0].series[k];
    const bool is_own = IsOwn(map.base, MapAxis::kDelay, lines[k].delay);
    EXPECT_EQ(series.style == LineStyle::kSolid, is_own);
    EXPECT_EQ(series.label.find("(the scenario)") != std::string::npos, is_own);
    ASSERT_EQ(series.x->size(), lines[k].points.size());
    EXPECT_EQ((*series.x)[1], lines[k].points[1].value);
    EXPECT_EQ((*series.y)[1], lines[k].points[1].predicted.critical()->stiffness / 1000);
    EXPECT_TRUE(std::isnan(series.y->front()) && std::isnan(series.y->back()));
  }
  ASSERT_EQ(plot.panels[0].limits.size(), 1U);
  EXPECT_EQ(plot.panels[0].limits[0].value, 20);
  EXPECT_NE(plot.caption.find("oscillates even without a wall: at 0 ms: 6 kg; at 2 ms: 6 kg"),
            std::string::npos)
      << plot.caption;
}

TEST(WallMap, AloneMakesAPageAndATable) {
  const StabilityMap map = MadeUp();
  const std::string page = MapPage(map), text = MapText(map);
  EXPECT_NE(page.find("<section id=\"walls\""), std::string::npos);
  EXPECT_EQ(page.find("<section id=\"boundaries\""), std::string::npos);
  EXPECT_NE(text.find("Largest stable wall [kN/m], predicted: fixture 0"), std::string::npos);
  EXPECT_NE(text.find("> 1000"), std::string::npos);
  EXPECT_NE(text.find("none"), std::string::npos);
  EXPECT_EQ(text.find("Stability map"), std::string::npos);
}

TEST(WallMap, IsComputedOnceSoak) {
  if (!InFull()) GTEST_SKIP() << "set PREDICTOR_SOAK";
  const test::TemporaryFolder folder;
  MapOptions options;
  options.folder = folder.path();
  options.only_walls = true;
  const Scenario s = Load("box_9kg.yaml", {kPlane});
  const StabilityMap map = MakeStabilityMap(s, options);
  EXPECT_EQ(map.kept, 0);
  EXPECT_FALSE(map.has_hands());
  const StabilityMap again = MakeStabilityMap(s, options);
  const MapBase base = BaseOf(s);
  const std::size_t points =
      MapValues(base, MapAxis::kHandMass).size() * MapValues(base, MapAxis::kDelay).size();
  EXPECT_EQ(static_cast<std::size_t>(again.kept), points);
  EXPECT_EQ(MapPage(again), MapPage(map));
  std::printf("soak: count=%d\n", again.kept);
}

}  // namespace
}  // namespace predictor
