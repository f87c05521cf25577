#include "report/report.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/text.h"
#include "report/page.h"
#include "report/report_words.h"
#include "report/run_plots.h"

namespace predictor {
namespace {

std::string Header(const RunData& run, const std::string& program_version) {
  std::string words = "<p>" + EscapeMarkup(run.info.name);
  if (!run.info.file.empty()) words += " · " + EscapeMarkup(run.info.file);
  if (!run.info.date.empty()) words += " · " + EscapeMarkup(run.info.date);
  if (!run.info.program_version.empty())
    words += " · recorded by PREDICTOR " + EscapeMarkup(run.info.program_version);
  if (run.info.program_version != program_version)
    words += " · reported by PREDICTOR " + EscapeMarkup(program_version);
  for (const auto& [key, value] : run.info.labels)
    words += " · " + EscapeMarkup(key) + "=" + EscapeMarkup(value);
  return words + "</p>\n";
}

void AddStops(const RunCurves& curves, ReportPage* page) {
  constexpr std::size_t kMaxListed = 4;
  const RunData& run = curves.run();
  if (run.stops.empty()) return;
  page->Section("stops", run.stops.size() == 1 ? "The stop" : "The stops");
  for (std::size_t i = 0; i < run.stops.size() && i < kMaxListed; ++i) {
    page->Html(StopWords(run, run.stops[i]));
    page->Figure(StopPlot(curves, run.stops[i], i + 1));
  }
  if (run.stops.size() > kMaxListed)
    page->Paragraph("And " + std::to_string(run.stops.size() - kMaxListed) +
                    " more stops; see the events.");
}

// Describes which limits were active, how often they were active, and which joints were limited
// most often.
std::string ActiveWords(const RunData& run) {
  const auto share = [&run](std::uint64_t ticks) {
    const auto solved = static_cast<double>(run.summary.Get<std::uint64_t>("qp.solved"));
    return Significant(100 * static_cast<double>(ticks) / solved, 2) + " %";
  };
  std::vector<std::pair<std::uint64_t, std::string>> joints;
  for (std::size_t i = 0; i < kHands; ++i)
    for (std::size_t j = 0; j < kMaxArmJoints; ++j)
      if (const std::uint64_t ticks = run.bound_ticks[i][j]; ticks > 0)
        joints.emplace_back(ticks, std::string(kHandNames[i]) + " arm's joint " +
                                       std::to_string(j + 1) + " in " + share(ticks));
  std::sort(joints.rbegin(), joints.rend());
  std::vector<std::string> named;
  for (std::size_t k = 0; k < joints.size() && k < 3; ++k) named.push_back(joints[k].second);
  return "A joint limit (position, velocity or acceleration) restricted the command in " +
         share(run.bounded_ticks) + " of them" +
         (named.empty() ? "" : ", most often the " + Join(named, ", the ")) +
         "; the distance between links in " + share(run.row_ticks) + ".";
}

void AddRendering(const Runs& runs, ReportPage* page) {
  const RunData& run = runs.front().run();
  const std::string results = ResultTables(run, Chapter::kRendering);
  if (results.empty()) return;
  page->Section("rendering", "Rendering");
  page->Html(results);
  const auto& iterations = run.summary.Get<Statistics>("qp.iterations");
  page->Paragraph(Significant(iterations.mean(), 2) + " iterations on average, " +
                  Significant(iterations.max(), 2) + " at most. " +
                  (run.summary.Get<std::uint64_t>("qp.solved") > 0 ? ActiveWords(run) : ""));
  page->Figure(SlackPlot(runs));
}

void AddForces(const Runs& runs, ReportPage* page) {
  page->Figure(ForcePlot(runs));
  page->Figure(ForceAxesPlot(runs));
  page->Section("oscillations", "Oscillation");
  page->Figure(OscillationPlot(runs));
}

void AddPath(const Runs& runs, ReportPage* page) {
  page->Section("path", "Path");
  for (const Plot& plot : PathPlots(runs)) page->Figure(plot);
  page->Figure(ObjectPlot(runs));
}

ReportDocument SingleReport(const RunData& run, const std::string& program_version,
                            const AddChapters& chapters) {
  const Runs runs = {RunCurves(run)};
  const RunCurves& curves = runs.front();
  const std::string title = run.info.scenario.name.empty() ? run.info.name : run.info.scenario.name;
  ReportPage page(title, Header(run, program_version));
  page.Section("summary", "Summary");
  page.Html(SummaryWords(run) + ResultTables(run, Chapter::kSummary));
  AddStops(curves, &page);
  if (run.summary.ticks() > 0) {
    page.Section("tracking-errors", "Tracking");
    page.Html(ResultTables(run, Chapter::kTracking));
    page.Figure(TrackingPlot(runs));
  }
  page.Section("hands", "Forces");
  page.Html(ResultTables(run, Chapter::kForces));
  AddForces(runs, &page);
  chapters(&page);
  AddPath(runs, &page);
  page.Section("joint-motion", "Joints");
  page.Figure(JointPlot(curves));
  AddRendering(runs, &page);
  if (!run.summary.events.empty() || run.summary.cobot_stop) {
    page.Section("hazards", "Hazards");
    page.Html(HazardTable(run));
  }
  page.Section("coupling-wrench", "Coupling");
  page.Figure(CouplingPlot(runs));
  page.Section("energies", "Energy");
  page.Html(EnergyTable(run));
  page.Figure(EnergyPlot(curves));
  page.Section("timing", "Timing");
  page.Html(ResultTables(run, Chapter::kTiming));
  page.Figure(TickPlot(curves));
  page.Figure(TickHistogram(runs));
  page.Section("latency", "Latency");
  page.Html(LatencyTable(run));
  page.Section("events", "Events");
  page.Html(EventTable(run));
  page.Section("data", "About the data");
  page.Html(DetailWords(runs));
  if (!run.info.scenario_yaml.empty())
    page.Folded("The scenario, with all values of the run", run.info.scenario_yaml);
  return {page.Finish(), page.plots()};
}

ReportDocument Comparison(const std::vector<RunData>& data, const std::string& program_version,
                          const AddChapters& chapters) {
  Runs runs;
  for (const RunData& run : data) runs.emplace_back(run);
  std::string words = "<p>Differences are relative to the first, " +
                      EscapeMarkup(data.front().info.name) +
                      ". Limits and guidance are those of the first.</p>\n";
  for (const RunData& run : data) words += Header(run, program_version);
  ReportPage page(std::to_string(data.size()) + " recordings compared", words);
  page.Section("summary", "Summary");
  page.Html(ComparisonTable(data));
  for (const RunData& run : data)
    page.Html("<h3>" + EscapeMarkup(run.info.name) + "</h3>\n" + SummaryWords(run));
  page.Section("tracking-errors", "Tracking");
  page.Figure(TrackingPlot(runs));
  page.Section("hands", "Forces");
  AddForces(runs, &page);
  chapters(&page);
  AddPath(runs, &page);
  page.Section("coupling-wrench", "Coupling and rendering");
  page.Figure(CouplingPlot(runs));
  page.Figure(SlackPlot(runs));
  page.Section("timing", "Timing");
  page.Figure(TickHistogram(runs));
  page.Section("data", "About the data");
  page.Html(DetailWords(runs));
  for (const RunData& run : data)
    if (!run.info.scenario_yaml.empty())
      page.Folded("The scenario of " + run.info.name, run.info.scenario_yaml);
  return {page.Finish(), page.plots()};
}

}  // namespace

ReportDocument MakeReport(const std::vector<RunData>& runs, const std::string& program_version,
                          const AddChapters& chapters) {
  return runs.size() == 1 ? SingleReport(runs.front(), program_version, chapters)
                          : Comparison(runs, program_version, chapters);
}

}  // namespace predictor
