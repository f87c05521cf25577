// Axes, and what an SVG shows.
#include "report/plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <regex>

#include "core/text.h"
#include "report/oscillation_index.h"
#include "report/run_data.h"
#include "report/run_names.h"
#include "report/svg.h"

namespace predictor {
namespace {

TEST(Plot, TicksAreRoundAndCoverTheRange) {
  const AxisTicks ticks = LinearTicks(-0.13, 0.52, 5);
  EXPECT_EQ(ticks.text, (std::vector<std::string>{"-0.2", "0.0", "0.2", "0.4", "0.6"}));
  EXPECT_EQ(LinearTicks(0, 8.2, 10, true).high, 8.2);
  EXPECT_EQ(LogTicks(8, 3000, 10).text,
            (std::vector<std::string>{"10", "20", "50", "100", "200", "500", "1000", "2000"}));
}

TEST(Plot, NumbersHaveSensibleDigits) {
  EXPECT_EQ(Significant(0.012345), "0.0123");
  EXPECT_EQ(Significant(12345), "12345");
  EXPECT_EQ(Significant(-3.7945e-5, 3, 3), "0");
  EXPECT_EQ(Significant(NAN), "–");
  EXPECT_EQ(Round(30), "30");
  EXPECT_EQ(Round(0.300), "0.3");
  EXPECT_EQ(Round(20.053), "20.05");
}

Plot Simple() {
  Plot plot;
  plot.id = "simple";
  plot.title = "A & B";
  plot.x = {.label = "Time", .unit = "s"};
  PlotPanel panel{.title = "Force", .y = {.label = "Force", .unit = "N", .zero = true}};
  panel.series.push_back(
      {.label = "left <1>", .x = MakeSamples({0, 1, 2, 3}), .y = MakeSamples({0, 10, NAN, 20})});
  panel.limits = {{30, "stop above 30 N"}, {500, "far away"}};
  plot.panels.push_back(panel);
  plot.notes = {{1, "one"}, {1.01, "another beside it"}};
  return plot;
}

// Places of the words of an SVG's text elements.
std::vector<std::pair<double, double>> Places(const std::string& svg, const std::string& words) {
  std::vector<std::pair<double, double>> places;
  const std::regex text("<text x=\"([-0-9.]+)\" y=\"([-0-9.]+)\"[^>]*>" + words + "</text>");
  for (std::sregex_iterator it(svg.begin(), svg.end(), text), end; it != end; ++it)
    places.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  return places;
}

// Path of the first line of data; searched by hand, as std::regex recurses for each letter.
std::string DataLine(const std::string& svg) {
  const std::size_t line = svg.find("stroke-width=\"1.3\"");
  const std::size_t begin = line == std::string::npos ? line : svg.find(" d=\"", line);
  if (begin == std::string::npos) return "";
  return svg.substr(begin + 4, svg.find('"', begin + 4) - begin - 4);
}

TEST(Svg, HasUnitsLimitsAndBreaksTheLineAtGaps) {
  const std::string svg = ToSvg(Simple());
  for (const char* words : {"Time \\[s\\]", "Force \\[N\\]", "stop above 30 N", "far away ↑",
                            "left &lt;1&gt;", "A &amp; B"})
    EXPECT_EQ(Places(svg, words).size(), 1u) << words;
  const std::string d = DataLine(svg);
  ASSERT_FALSE(d.empty());
  EXPECT_EQ(std::count(d.begin(), d.end(), 'M'), 2);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

// Many long names and limits far away: rows of them, none over another, none outside.
TEST(Svg, ALegendThatIsTooLongStandsInRows) {
  Plot plot = Simple();
  PlotPanel& panel = plot.panels[0];
  PlotSeries series = panel.series[0];
  panel.series.clear();
  for (int k = 0; k < 8; ++k) {
    series.label = "bar_circle_2026-01-31_14-05-0" + std::to_string(k) + ".mcap, right";
    panel.series.push_back(series);
  }
  series.label = std::string(300, 'x');
  panel.series.push_back(series);
  panel.limits.push_back({2e6, "another one that is farther away than all that is drawn here"});
  const std::string svg = ToSvg(plot);
  const std::regex text(
      "<text x=\"([-0-9.]+)\" y=\"([-0-9.]+)\" text-anchor=\"start\"[^>]*>"
      "([^<]*)</text>");
  std::map<double, double> ends;  // by row
  int names = 0;
  for (std::sregex_iterator it(svg.begin(), svg.end(), text), end; it != end; ++it) {
    const std::string words = (*it)[3];
    if (words.find("mcap") == std::string::npos && words.find("xx") == std::string::npos &&
        words.find("↑") == std::string::npos && words != EscapeMarkup(panel.title))
      continue;
    ++names;
    const double x = std::stod((*it)[1]), y = std::stod((*it)[2]);
    const auto before = ends.find(y);
    if (before != ends.end()) {
      EXPECT_GT(x, before->second) << words;
    }
    ends[y] = x + 5.5 * static_cast<double>(words.size());  // a letter's mean width at 12 px
    EXPECT_GE(x, 0);
    EXPECT_LE(ends[y], 900 + 5.5 * 3) << words;  // "…" and "↑" are three bytes
  }
  EXPECT_EQ(names, 12);  // the panel's title, nine lines, two limits
  EXPECT_GE(ends.size(), 5u);
}

TEST(ShortNames, TellFilesApartByWhatIsNotCommon) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(ShortNames({{"runs/bar_circle_2026-01-31_14-05-09.mcap", ""},
                        {"runs/bar_circle_2026-01-31_14-07-22.mcap", ""}}),
            (Names{"14-05-09", "14-07-22"}));
  EXPECT_EQ(ShortNames({{"a/real_run.mcap", ""}, {"a/emulated_run.mcap", ""}}),
            (Names{"real", "emulated"}));
  EXPECT_EQ(ShortNames({{"box.mcap", ""}, {"box_2.mcap", ""}}), (Names{"box", "box_2"}));
}

TEST(ShortNames, TakeTheFolderWhereFilesHaveOneName) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(ShortNames({{"/x/first/run.mcap", ""}, {"/x/second/run.mcap", ""}}),
            (Names{"first", "second"}));
  EXPECT_EQ(ShortNames({{"/x/a/b/run.mcap", ""}, {"/x/c/b/run.mcap", ""}}), (Names{"a", "c"}));
  EXPECT_EQ(ShortNames({{"run.mcap", ""}, {"run.mcap", ""}}), (Names{"1: run", "2: run"}));
}

TEST(ShortNames, AreTheConditionsIfThoseTellThemApart) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(ShortNames({{"a.mcap", "real"}, {"b.mcap", "emulated"}}), (Names{"real", "emulated"}));
  EXPECT_EQ(ShortNames({{"a.mcap", "real"}, {"b.mcap", "real"}}), (Names{"a", "b"}));
  EXPECT_EQ(ShortNames({{"a.mcap", "real"}, {"b.mcap", ""}}), (Names{"a", "b"}));
  EXPECT_EQ(ShortNames({{"a.mcap", std::string(41, 'x')}, {"b.mcap", "y"}}), (Names{"a", "b"}));
}

// Whatever they are, the words of a limit are crossed by no other limit's line, and cover no other
// words; where there is no room for that, the line is drawn first and interrupted by the words'
// rim.
TEST(Svg, NoLineRunsThroughTheWordsOfALimit) {
  for (const double apart : {0.0, 0.5, 1.0, 2.0, 4.0, 8.0}) {
    Plot plot = Simple();
    plot.panels[0].limits = {{10, "first"}, {10 + apart, "second"}};
    const std::string svg = ToSvg(plot);
    const std::regex line("<path d=\"M[-0-9.]+ ([-0-9.]+)L[^>]*stroke-dasharray=\"7 4\"");
    std::vector<double> lines;
    std::size_t last = 0;
    for (std::sregex_iterator it(svg.begin(), svg.end(), line), end; it != end; ++it) {
      lines.push_back(std::stod((*it)[1]));
      last = static_cast<std::size_t>(it->position());
    }
    ASSERT_EQ(lines.size(), 2u);
    const double first = Places(svg, "first").at(0).second;
    const double second = Places(svg, "second").at(0).second;
    EXPECT_GE(std::abs(first - second), 12) << apart;
    EXPECT_LT(last, svg.find(">first</text>")) << apart;
    for (const double at : {first, second})
      for (const double y : lines) EXPECT_FALSE(y > at - 9 && y < at + 2) << apart;
  }
}

TEST(Svg, NotesThatAreNearOneAnotherStandInRows) {
  const std::string svg = ToSvg(Simple());
  const auto one = Places(svg, "one"), another = Places(svg, "another beside it");
  ASSERT_EQ(one.size(), 1u);
  ASSERT_EQ(another.size(), 1u);
  EXPECT_GE(std::abs(one[0].second - another[0].second), 14);
}

TEST(Svg, OfAMillionPointsIsSmallAndLosesNoSpike) {
  std::vector<double> x, y;
  for (int i = 0; i < 1'000'000; ++i) {
    x.push_back(1e-3 * i);
    y.push_back(i == 654'321 ? 50 : std::sin(1e-3 * i));
  }
  Plot plot = Simple();
  plot.notes.clear();
  plot.panels[0].limits.clear();
  plot.panels[0].series[0].x = MakeSamples(std::move(x));
  plot.panels[0].series[0].y = MakeSamples(std::move(y));
  const std::string svg = ToSvg(plot);
  EXPECT_LT(svg.size(), 120'000u);
  // The spike is the line's highest point: its place on the page is above all others.
  const std::string d = DataLine(svg);
  ASSERT_FALSE(d.empty());
  double top = 1e9, second = 1e9;
  const std::regex point("[ML]([-0-9.]+) ([-0-9.]+)");
  for (std::sregex_iterator it(d.begin(), d.end(), point), end; it != end; ++it) {
    const double py = std::stod((*it)[2]);
    if (py < top) {
      second = top;
      top = py;
    } else {
      second = std::min(second, py);
    }
  }
  EXPECT_GT(second - top, 100);
}

TEST(Svg, AMetreIsAsLongAlongBothAxesOfAPath) {
  Plot plot;
  plot.id = "path";
  plot.equal_axes = true;
  plot.x = {.label = "x", .unit = "m"};
  PlotSeries series{.kind = SeriesKind::kPath};
  series.x = MakeSamples({0, 1, 1, 0, 0});
  series.y = MakeSamples({0, 0, 1, 1, 0});
  PlotPanel panel{.y = {.label = "y", .unit = "m"}};
  panel.series.push_back(series);
  plot.panels.push_back(panel);
  const std::string svg = ToSvg(plot);
  std::smatch line;
  ASSERT_TRUE(std::regex_search(svg, line,
                                std::regex("d=\"M([-0-9.]+) ([-0-9.]+)L([-0-9.]+) "
                                           "([-0-9.]+)L([-0-9.]+) ([-0-9.]+)L")));
  const double width = std::stod(line[3]) - std::stod(line[1]);
  const double height = std::stod(line[4]) - std::stod(line[6]);
  EXPECT_GT(width, 50);
  EXPECT_NEAR(width, height, 0.3);
}

// A force that sways slowly and trembles at f: the trembling's part is known.
TEST(OscillationIndex, IsThePartOfThePowerFromThreeToTenHertz) {
  for (const double f : {4.0, 6.25, 9.0}) {
    OscillationIndex index(0.001);
    for (int i = 0; i < 9'000; ++i) {
      const double t = 1e-3 * i;
      index.Add(t, Vector3(3 * std::sin(2 * M_PI * t), 2 * std::cos(2 * M_PI * f * t), 7));
    }
    ASSERT_EQ(index.windows().size(), 3u);
    for (const auto& window : index.windows()) {
      EXPECT_NEAR(window.index, 4.0 / (4 + 9), 0.01) << f;
      EXPECT_NEAR(window.rms, 2 / std::sqrt(2), 0.02) << f;
      EXPECT_NEAR(window.total, std::sqrt(6.5), 0.03) << f;
    }
    EXPECT_NEAR(index.windows()[1].time, 4, 0.01);
  }
}

TEST(PortEnergy, TellsWhatCameBackAndHowLowTheSumFell) {
  PortEnergy port;
  for (int i = 0; i < 1000; ++i) port.Add(2, 0.001);
  for (int i = 0; i < 1000; ++i) port.Add(-3, 0.001);
  for (int i = 0; i < 1000; ++i) port.Add(4, 0.001);
  EXPECT_NEAR(port.sum, 3, 1e-9);
  EXPECT_NEAR(port.lowest, -1, 1e-9);
  EXPECT_NEAR(port.returned, 3, 1e-9);
  EXPECT_EQ(port.peak_return, 3);
  EXPECT_EQ(port.episodes, 1);
}

}  // namespace
}  // namespace predictor
