// Tests the stored results of the stability map and its page.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "analysis/extents.h"
#include "analysis/stability_map/point_json.h"
#include "analysis/stability_map/stability_map.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

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

TEST(PointJson, IsReadBackOrRefused) {
  const MapPoint point = SomePoint();
  MapPoint read;
  ASSERT_TRUE(ReadPoint(nlohmann::ordered_json::parse(JsonOf(point).dump()), &read));
  EXPECT_EQ(read.value, point.value);
  ASSERT_TRUE(read.predicted.critical());
  EXPECT_EQ(read.predicted.critical()->stiffness, 218.25);
  ASSERT_EQ(read.found.samples.size(), point.found.samples.size());
  for (std::size_t k = 0; k < point.found.samples.size(); ++k) {
    EXPECT_EQ(read.found.samples[k].growth.rate, point.found.samples[k].growth.rate);
    EXPECT_EQ(read.found.samples[k].growth.limited, point.found.samples[k].growth.limited);
    EXPECT_EQ(read.found.samples[k].growth.stopped, point.found.samples[k].growth.stopped);
  }
  EXPECT_FALSE(ReadPoint({{"key", "x"}, {"value", "y"}}, &read));
  EXPECT_EQ(read.value, point.value);
}

// ---- plots -------------------------------------------------------------------------------------

// Returns a map in which every plot has the same point at each value, with two exceptions. Nothing
// is stable at the second value, and the cobot cannot carry the object at the last one.
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

// Checks that each opened element is closed, and in the right order.
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

// Returns the page without its script, which is not markup.
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

// The plot must show the points of the map in the plot's own unit. It must show crosses at the
// values at which nothing is stable.
TEST(MapPlot, ShowsPredictionsAndResults) {
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

TEST(MapPage, NeedsNoOtherFileAndShowsWhereNothingIsStable) {
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

}  // namespace
}  // namespace predictor
