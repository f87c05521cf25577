// Tests reports of complete runs.
#include "report/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <regex>
#include <set>

#include "report/page.h"
#include "report/pages.h"
#include "report/report_words.h"
#include "support/text.h"

namespace predictor {
namespace {

std::size_t Occurrences(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size())
    ++count;
  return count;
}

// Checks that a browser would load no other resources.
void ExpectSelfContained(const std::string& page) {
  const std::string html = WithoutScript(page);
  EXPECT_EQ(html.find(" src="), std::string::npos);
  EXPECT_EQ(html.find("<link"), std::string::npos);
  EXPECT_EQ(html.find("url("), std::string::npos);
  EXPECT_EQ(html.find("@import"), std::string::npos);
  EXPECT_EQ(html.find("import("), std::string::npos);
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
}

TEST(Report, OfARunHasAllItsChapters) {
  const CollectedRun run = Collect("box_9kg", 30);
  const ReportDocument report = MakeReport({run.data}, "test");
  Keep(report, "box_9kg");
  ExpectSelfContained(report.html);
  for (const char* chapter :
       {"summary", "tracking-errors", "hands", "oscillations", "path", "joint-motion", "rendering",
        "coupling-wrench", "energies", "timing", "latency", "events", "data"})
    EXPECT_EQ(Occurrences(report.html, std::string("<section id=\"") + chapter + "\""), 1u)
        << chapter;
  EXPECT_NE(report.html.find("There was no safety stop"), std::string::npos);
  EXPECT_NE(report.html.find("This page contains every tick"), std::string::npos);
  EXPECT_NE(report.html.find("damping_ratio"), std::string::npos);
  std::set<std::string> ids;
  for (const Plot& plot : report.plots) {
    EXPECT_TRUE(ids.insert(plot.id).second) << plot.id;
    EXPECT_FALSE(AxisTitle(plot.x).empty()) << plot.id;
    for (const PlotPanel& panel : plot.panels) {
      EXPECT_FALSE(AxisTitle(panel.y).empty()) << plot.id;
      for (const PlotSeries& series : panel.series)
        EXPECT_EQ(series.x->size(), series.y->size()) << plot.id << " " << series.label;
    }
  }
  EXPECT_LT(report.html.size(), 8e6);
}

TEST(Report, DrawsPrismaticJointsInMillimetres) {
  for (const auto& [name, prismatic, first] :
       {std::tuple("linear_axis", 1u, 200.0), std::tuple("mobile_base", 2u, 0.0)}) {
    const CollectedRun run = Collect(name, 1);
    const ReportDocument report = MakeReport({run.data}, "test");
    const auto plot = std::find_if(report.plots.begin(), report.plots.end(),
                                   [](const Plot& p) { return p.id == "joints"; });
    ASSERT_NE(plot, report.plots.end());
    const PlotPanel& slides = plot->panels.back();
    ASSERT_EQ(slides.series.size(), prismatic) << name;
    EXPECT_EQ(AxisTitle(slides.y), "Position [mm]");
    // The weight of the box moves both values by up to a few centimetres before the run starts.
    EXPECT_NEAR(slides.series[0].y->front(), first, 40) << name;
    const PlotPanel& turns = plot->panels[plot->panels.size() - 2];
    EXPECT_EQ(turns.series.size(), run.data.cobot_dof - prismatic) << name;
    EXPECT_EQ(AxisTitle(turns.y), "Angle [°]");
  }
}

TEST(Report, ReportsAStopAsTheEmulatorMeasuredIt) {
  const CollectedRun run = Collect("push", 12);
  ASSERT_EQ(run.data.stops.size(), 1u);
  const StopSummary& stop = run.data.stops[0].summary;
  EXPECT_EQ(stop.cause, StopCause::kForce);
  EXPECT_NEAR(stop.time, run.stop.time, 0.0011);
  EXPECT_NEAR(stop.duration, run.stop.duration, 0.0011);
  EXPECT_DOUBLE_EQ(stop.value, run.stop.status.value);
  const ReportDocument report = MakeReport({run.data}, "test");
  Keep(report, "push");
  EXPECT_EQ(Occurrences(report.html, "id=\"stop-1\""), 1u);
  const auto plot = std::find_if(report.plots.begin(), report.plots.end(),
                                 [](const Plot& p) { return p.id == "stop-1"; });
  ASSERT_NE(plot, report.plots.end());
  // The plot must contain the ten seconds before the decision, or the whole run if it was shorter.
  // The curve must cross the threshold at 0.
  const PlotSeries& force = plot->panels[0].series[static_cast<std::size_t>(stop.hand)];
  EXPECT_NEAR(
      force.x->front(),
      -std::min(10.0, run.data.TimeOf(run.data.stops[0].tick) - run.data.TimeOf(run.data.first)),
      0.002);
  for (std::size_t i = 0; i < force.x->size(); ++i) {
    if ((*force.x)[i] < -0.0005) {
      EXPECT_LE((*force.y)[i], stop.limit + 1e-3) << (*force.x)[i];
    }
  }
}

// The stop alone would hold the arms, but another fault removes the power at its end. The report
// must state this fault after the cause of the stop.
TEST(Report, ReportsWhySwitchedOffAtAStopsEnd) {
  const Scenario scenario =
      LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/push.yaml");
  Emulator emulator(scenario);
  RunCollector collector(TestInfo(scenario, "push"));
  std::uint64_t power_off = 0, stopped = 0;
  Simulate(&emulator, 12, [&](TickRecord record) {
    if (record.cause != StopCause::kNone && ++stopped > 20) {
      record.harder = {StopCause::kStale, 1, Quantity::kArmAge, 1, {}, 0.0214, 0.02};
      if (power_off == 0) power_off = record.tick;
    }
    collector.Add(record);
  });
  const RunData data = collector.Finish();
  ASSERT_EQ(data.stops.size(), 1u);
  EXPECT_EQ(data.stops[0].summary.harder.cause, StopCause::kStale);
  EXPECT_GT(power_off, data.stops[0].tick);
  EXPECT_EQ(data.stops[0].power_off, power_off);
  EXPECT_EQ(std::count_if(data.events.begin(), data.events.end(),
                          [&](const ReportedEvent& event) {
                            return event.text == "POWER OFF: stale" && event.tick == power_off;
                          }),
            1);
  const ReportDocument report = MakeReport({data}, "test");
  EXPECT_EQ(Occurrences(report.html,
                        "Power-off was requested because: Right hand: no new sample "
                        "from the arm arrived in time (21.4 ms, limit 20 ms)."),
            2u);  // once for the run and once for its stop
  int noted = 0;
  for (const Plot& plot : report.plots)
    for (const PlotNote& note : plot.notes) noted += note.label == "power off: stale";
  EXPECT_GE(noted, 1);
  const ReportDocument other = MakeReport({Collect("push", 12).data}, "test");
  EXPECT_EQ(other.html.find("The power was taken off"), std::string::npos);
  EXPECT_EQ(other.html.find("POWER OFF"), std::string::npos);
  EXPECT_EQ(other.html.find("power off: "), std::string::npos);
}

// Runs `push` until it stops, lets `more` add further ticks, and returns the collected data.
template <typename More>
RunData WithMore(const More& more) {
  const Scenario scenario =
      LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/push.yaml");
  Emulator emulator(scenario);
  RunCollector collector(TestInfo(scenario, "push"));
  TickRecord last{};
  Simulate(&emulator, 12, [&](const TickRecord& record) { collector.Add(last = record); });
  more(
      [&] {
        ++last.tick;
        collector.Add(last);
      },
      &last);
  return collector.Finish();
}

// If one record contains both the decision and the power-off, the power-off must belong to this
// stop and not to the previous one.
TEST(Report, ThePowerOffOfADecisionsOwnTickIsOfThatStop) {
  std::uint64_t second = 0;
  const RunData data = WithMore([&](const auto& add, TickRecord* record) {
    record->cause = StopCause::kEnabling;
    record->harder = {StopCause::kStale, 1, Quantity::kArmAge, 1, {}, 0.0214, 0.02};
    add();
    second = record->tick;
    add();
  });
  ASSERT_EQ(data.stops.size(), 2u);
  EXPECT_EQ(data.stops[0].power_off, 0u);
  EXPECT_EQ(data.stops[0].summary.harder.cause, StopCause::kNone);
  EXPECT_EQ(data.stops[1].tick, second);
  EXPECT_EQ(data.stops[1].power_off, second);
  EXPECT_EQ(data.stops[1].summary.harder.cause, StopCause::kStale);
  int noted = 0;
  for (const Plot& plot : MakeReport({data}, "test").plots)
    for (const PlotNote& note : plot.notes) {
      EXPECT_NE(note.label, "power off: none");
      noted += note.label == "power off: stale";
    }
  EXPECT_GE(noted, 1);
}

// If a run has more stops than the report keeps, the report must contain the power-off of a later
// stop. It must not assign this power-off to any of the kept stops.
TEST(Report, ThePowerOffOfAnUnlistedStopBelongsToNoStop) {
  const RunData data = WithMore([&](const auto& add, TickRecord* record) {
    for (std::size_t k = 0; k < StopLog::kMaxStops + 5; ++k) {
      record->cause = k % 2 == 0 ? StopCause::kEnabling : StopCause::kOperator;
      add();
    }
    record->harder = {StopCause::kStale, 1, Quantity::kArmAge, 1, {}, 0.0214, 0.02};
    add();
  });
  ASSERT_EQ(data.stops.size(), StopLog::kMaxStops);
  for (const ReportedStop& stop : data.stops) EXPECT_EQ(stop.power_off, 0u);
  EXPECT_TRUE(std::any_of(data.events.begin(), data.events.end(), [](const ReportedEvent& event) {
    return event.text == "POWER OFF: stale";
  }));
}

TEST(Report, StatesThatArmsDidNotRest) {
  const auto reported = [](bool restless, const std::string& what) {
    const RunData data = WithMore([&](const auto& add, TickRecord* record) {
      if (restless) record->harder = {StopCause::kDevice, 1, Quantity::kSpeed, 1, {}, 0.02, 0.0025};
      add();
    });
    const ReportDocument report = MakeReport({data}, "test");
    std::size_t notes = 0;
    for (const Plot& plot : report.plots)
      notes += static_cast<std::size_t>(
          std::count_if(plot.notes.begin(), plot.notes.end(),
                        [](const PlotNote& note) { return note.label == "at rest"; }));
    EXPECT_EQ(notes, restless ? 0u : 1u);
    return Occurrences(report.html, what);
  };
  // The text appears once for the run and once for the run's stop.
  EXPECT_EQ(reported(true, "The arms did not come to rest."), 2u);
  EXPECT_EQ(reported(true, "The arms came to rest"), 0u);
  EXPECT_EQ(reported(false, "The arms did not come to rest."), 0u);
  EXPECT_EQ(reported(false, "The arms came to rest"), 2u);
}

// Returns records of RUN in which the hands exert force(t) along x.
RunData OfForce(double seconds, const std::function<double(double)>& force) {
  RunCollector collector(TestInfo(Scenario(), "force"));
  TickRecord record{};
  record.ran = 1;
  for (int k = 0; k < std::lround(1e3 * seconds); ++k) {
    record.tick = static_cast<std::uint64_t>(k) + 1;
    record.run_time = 0.001 * k;
    for (HandRecord& hand : record.hands) {
      hand.present = 1;
      hand.wrench[0] = force(record.run_time);
    }
    collector.Add(record);
  }
  return collector.Finish();
}

// The force has 20 N at 0.75 Hz and 6 N at 5 Hz. The share of the force from 3 to 10 Hz is small,
// but the rms value of this part is still 4 N.
TEST(Report, ASmallPartOfALargeForceIsGivenInNewtons) {
  const RunData run = OfForce(8, [](double t) {
    return 20 * std::sin(1.5 * std::numbers::pi * t) + 6 * std::sin(10 * std::numbers::pi * t);
  });
  const std::string words = SummaryWords(run);
  EXPECT_EQ(words.find("No hand's force oscillated"), std::string::npos);
  std::smatch reported;
  ASSERT_TRUE(std::regex_search(words, reported, std::regex("an rms of at most ([0-9.]+) N")))
      << words;
  EXPECT_NEAR(std::stod(reported[1]), 6 / std::sqrt(2), 0.3);
}

// The largest index in the text must equal the largest one in the plot.
TEST(Report, TextAndPlotShowTheSameIndex) {
  // At first, the hand is at rest, and its force contains a little noise of 5 Hz. After that, the
  // force of the hand is slow and strong.
  const RunData run = OfForce(20, [](double t) {
    const double slow = t < 10 ? 0 : 20 * std::sin(1.5 * std::numbers::pi * t);
    return slow + 0.2 * std::sin(10 * std::numbers::pi * t);
  });
  double any = 0, reported = 0;
  for (const auto& window : run.oscillation[0]) {
    any = std::max(any, window.index);
    if (window.IsMeaningful()) reported = std::max(reported, window.index);
  }
  ASSERT_GT(any, 0.9);
  EXPECT_EQ(run.summary.Get<double>("oscillation.left.index"), reported);
  std::smatch words;
  const std::string summary = SummaryWords(run);
  ASSERT_TRUE(std::regex_search(summary, words, std::regex("index at most ([0-9.]+)"))) << summary;
  EXPECT_NEAR(std::stod(words[1]), reported, 0.006);
  double shown = 0;
  for (const Plot& plot : MakeReport({run}, "test").plots)
    if (plot.id == "oscillation")
      for (const double y : *plot.panels[0].series[0].y)
        if (!std::isnan(y)) shown = std::max(shown, y);
  EXPECT_EQ(shown, reported);
}

TEST(Report, ComparesRuns) {
  const CollectedRun first = Collect("bar_circle", 12);
  CollectedRun second = Collect("bar_circle", 12, {"operator.hand.stiffness=[400, 200, 200]"});
  second.data.info.name = "stiffer hand";
  const ReportDocument report = MakeReport({first.data, second.data}, "test");
  Keep(report, "comparison");
  ExpectSelfContained(report.html);
  EXPECT_NE(report.html.find("2 recordings compared"), std::string::npos);
  EXPECT_NE(report.html.find("stiffer hand"), std::string::npos);
  for (const Plot& plot : report.plots)
    for (const PlotPanel& panel : plot.panels)
      EXPECT_GE(panel.series.size(), 2u) << plot.id << " " << panel.title;
  Keep(MakeReport({Collect("bar_circle", 37).data}, "test"), "bar_circle");
}

// Each metric must appear in the report, although the report has no code that is specific to a
// metric.
TEST(Report, ShowsAndComparesEveryMetric) {
  const CollectedRun run = Collect("box_9kg", 8);
  const std::string one = MakeReport({run.data}, "test").html;
  for (const ResultGroup& group : GroupResults(run.data.summary.results)) {
    EXPECT_NE(one.find(group.title), std::string::npos) << group.title;
    for (const ResultGroup::Row& row : group.rows)
      EXPECT_NE(one.find("<th>" + row.label + "</th>"), std::string::npos) << row.label;
  }
  const std::string two = MakeReport({run.data, run.data}, "test").html;
  for (const Result& result : run.data.summary.results) {
    const std::string name =
        result.column.empty() ? result.group : result.label + ", " + result.column;
    if (result.compared && !IsMissing(result.value)) {
      EXPECT_NE(two.find("<th>" + name), std::string::npos) << result.path;
    }
  }
}

TEST(Report, OfOneArmAndOfDirectHoldingIsMadeToo) {
  const CollectedRun one = Collect("single_arm", 3);
  Keep(MakeReport({one.data}, "test"), "single_arm");
  EXPECT_NE(one.data.Present(0), one.data.Present(1));
  const CollectedRun direct = Collect("bar_circle", 3, {"mode=direct"});
  const ReportDocument report = MakeReport({direct.data}, "test");
  Keep(report, "direct");
  EXPECT_NE(report.html.find("the object held directly"), std::string::npos);
  EXPECT_EQ(report.html.find("<section id=\"rendering\""), std::string::npos);
  EXPECT_EQ(WithoutScript(report.html).find("nan"), std::string::npos);
}

TEST(Report, StatesWhetherTheHapticLoopWasPredictedUnstable) {
  CollectedRun run = Collect("box_9kg", 0.5);
  EXPECT_EQ(MakeReport({run.data}, "test").html.find(", stability margin"), std::string::npos);
  for (const double margin : {0.84, 2.1}) {
    run.data.summary.loop = PredictedLoop{0.0181, margin};
    const std::string html = MakeReport({run.data}, "test").html;
    EXPECT_NE(html.find("Lead 18.1 ms"), std::string::npos);
    EXPECT_EQ(html.find("PREDICTED UNSTABLE") != std::string::npos, margin < 1);
    EXPECT_EQ(html.find("predicted stable") != std::string::npos, margin >= 1);
  }
}

TEST(Report, WhatARecordingSaysIsNeverMarkup) {
  const Scenario scenario =
      LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml");
  RunInfo info = TestInfo(scenario, "<script>alert(1)</script>");
  info.scenario.name = "</title><b>x";
  info.labels["<i>"] = "\"><svg onload=x>";
  info.events.push_back({2, "</script><img onerror=x>"});
  TickRecord record{};
  record.tick = 1;
  record.ran = 1;
  const RunData data = [&] {
    RunCollector collector(std::move(info));
    for (int i = 0; i < 10; ++i, ++record.tick) collector.Add(record);
    return collector.Finish();
  }();
  const std::string html = MakeReport({data}, "test").html;
  for (const char* evil : {"<script>alert", "</title><b>", "<i>", "<svg onload", "</script><img"})
    EXPECT_EQ(html.find(evil), std::string::npos) << evil;
  EXPECT_NE(html.find("&lt;/script&gt;"), std::string::npos);
}

}  // namespace
}  // namespace predictor
