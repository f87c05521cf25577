// Writes the results of a hazard study as text.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "analysis/hazard_study/hazard_study.h"
#include "core/format.h"
#include "core/text.h"
#include "evaluation/censored.h"
#include "evaluation/statistics_samples.h"

namespace predictor {
namespace {

constexpr double kInTime = 0.003 + 1e-9;  // the times are rounded [s]

// Returns the values of the runs in which the hazard began. Values below `least` count as missing
// and are omitted.
std::vector<double> ValuesOf(const HazardCell& cell, double HazardRun::*value, double least = 0) {
  std::vector<double> values;
  for (const HazardRun& run : cell.runs)
    if (run.begin >= 0 && run.*value >= least) values.push_back(run.*value);
  return values;
}

// Returns the largest forces after the hazard began. A stop by the emulator also ends the force, so
// the largest force of a stopped run is a lower bound. If only the cobot stopped itself, the force
// is not a lower bound, because the person would have experienced this stop too.
std::vector<CensoredValue> ForcesOf(const HazardCell& cell) {
  std::vector<CensoredValue> forces;
  for (const HazardRun& run : cell.runs)
    if (run.begin >= 0) forces.push_back({run.after, run.cause != StopCause::kNone});
  return forces;
}

template <class E>
std::map<std::string, int> CountBy(const HazardCell& cell, E HazardRun::*cause) {
  std::map<std::string, int> counts;
  for (const HazardRun& run : cell.runs)
    if (run.begin >= 0) ++counts[Name(run.*cause)];
  counts.erase(Name(E::kNone));
  return counts;
}

// Returns the shares of the causes as text, for example "force 80 %, oscillation 20 %".
std::string Shares(const std::map<std::string, int>& counts, std::size_t runs) {
  std::vector<std::string> parts;
  for (const auto& [name, count] : counts)
    parts.push_back(
        Formatted("%s %.0f %%", name.c_str(), 100.0 * count / static_cast<double>(runs)));
  return Join(parts, ", ");
}

// Describes the cause of the stop, the delay of the stop and the force, for example "force 80 %
// after 0.42 s; at least 30.2 N (10.1 N before)".
std::string CellWords(const HazardCell& cell) {
  if (cell.impossible.find("would have no effect") != std::string::npos) return "no effect";
  if (!cell.impossible.empty()) return "impossible";
  const std::vector<CensoredValue> after = ForcesOf(cell);
  if (after.empty()) return "did not begin";
  const std::map<std::string, int> causes = CountBy(cell, &HazardRun::cause);
  std::string text = causes.empty() ? "no stop" : Shares(causes, after.size());
  if (!causes.empty())
    text += Formatted(" after %.2f s", Median(ValuesOf(cell, &HazardRun::until_stop)));
  const std::map<std::string, int> own = CountBy(cell, &HazardRun::cobot_stop);
  if (!own.empty()) text += "; the cobot itself: " + Shares(own, after.size());
  return text + "; " + BoundText(CensoredQuantile(after, 0.95), "%.1f N") +
         Formatted(" (%.1f N before)", Quantile(ValuesOf(cell, &HazardRun::before), 0.95));
}

// Returns the distinct values of a member, in the order of the cells.
std::vector<std::string> NamesIn(const HazardStudy& study, std::string HazardCell::*member) {
  std::vector<std::string> names;
  for (const HazardCell& cell : study.cells)
    if (std::find(names.begin(), names.end(), cell.*member) == names.end())
      names.push_back(cell.*member);
  return names;
}

std::string Row(const std::vector<std::string>& cells) {
  return "| " + Join(cells, " | ") + " |\n";
}

}  // namespace

std::string HazardStudyTables(const HazardStudy& study) {
  std::string text;
  for (const std::string& scenario : NamesIn(study, &HazardCell::scenario)) {
    std::vector<std::string> head = {scenario};
    for (const HazardCell& cell : study.cells)
      if (cell.scenario == scenario && std::ranges::find(head, cell.controller) == head.end())
        head.push_back(cell.controller);
    text += Row(head) + Row(std::vector<std::string>(head.size(), "---"));
    for (const std::string& hazard : NamesIn(study, &HazardCell::hazard)) {
      std::vector<std::string> row = {hazard};
      for (const HazardCell& cell : study.cells)
        if (cell.scenario == scenario && cell.hazard == hazard) row.push_back(CellWords(cell));
      text += Row(row);
    }
    text += '\n';
  }
  return text;
}

std::string HazardStudyCsv(const HazardStudy& study) {
  std::string csv =
      "scenario,controller,hazard,impossible,runs,begun,stopped,causes,cobot_stops,"
      "until_stop_median_s,force_before_p95_N,force_after_median_N,force_after_p95_N,"
      "force_after_max_N,torque_after_max_Nm,speed_after_max_m_s,detection_max_s,travel_max_m,"
      "force_after_median_is_bound,force_after_p95_is_bound,true_force_excess_max_N,"
      "clear_detection_max_s,commanded_share_max\n";
  for (const HazardCell& cell : study.cells) {
    const std::vector<CensoredValue> after = ForcesOf(cell);
    const CensoredValue median = CensoredQuantile(after, 0.5), tail = CensoredQuantile(after, 0.95);
    const std::vector<double> stops = ValuesOf(cell, &HazardRun::until_stop);
    const auto number = [](double x) { return std::isfinite(x) ? Formatted("%.6g", x) : ""; };
    const auto largest = [&](double HazardRun::*value) {
      return number(Quantile(ValuesOf(cell, value), 1));
    };
    csv += Join({CsvCell(cell.scenario),
                 CsvCell(cell.controller),
                 CsvCell(cell.hazard),
                 CsvCell(cell.impossible),
                 std::to_string(cell.runs.size()),
                 std::to_string(after.size()),
                 std::to_string(stops.size()),
                 CsvCell(Shares(CountBy(cell, &HazardRun::cause), after.size())),
                 CsvCell(Shares(CountBy(cell, &HazardRun::cobot_stop), after.size())),
                 number(Median(stops)),
                 number(Quantile(ValuesOf(cell, &HazardRun::before), 0.95)),
                 number(median.value),
                 number(tail.value),
                 largest(&HazardRun::after),
                 largest(&HazardRun::torque),
                 largest(&HazardRun::speed),
                 largest(&HazardRun::detection),
                 largest(&HazardRun::travel),
                 std::to_string(median.at_least),
                 std::to_string(tail.at_least),
                 largest(&HazardRun::excess),
                 largest(&HazardRun::clear_detection),
                 largest(&HazardRun::commanded)},
                ",") +
           "\n";
  }
  return csv;
}

std::string HazardStudyJson(const HazardStudy& study) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const HazardCell& cell : study.cells) {
    nlohmann::ordered_json runs = nlohmann::ordered_json::array();
    for (const HazardRun& run : cell.runs)
      runs.push_back({{"seed", run.seed},
                      {"begin_s", run.begin},
                      {"force_before_N", run.before},
                      {"force_after_N", run.after},
                      {"torque_Nm", run.torque},
                      {"speed_m_s", run.speed},
                      {"until_stop_s", run.until_stop},
                      {"cause", Name(run.cause)},
                      {"detection_s", run.detection},
                      {"true_force_excess_N", run.excess},
                      {"clear_detection_s", run.clear_detection},
                      {"commanded_share", run.commanded},
                      {"travel_m", run.travel},
                      {"cobot_stop", Name(run.cobot_stop)}});
    json.push_back({{"scenario", cell.scenario},
                    {"controller", cell.controller},
                    {"hazard", cell.hazard},
                    {"impossible", cell.impossible},
                    {"runs", runs}});
  }
  return json.dump(2) + "\n";
}

std::string HazardStudyWords(const HazardStudy& study) {
  std::size_t runs = 0, begun = 0, stopped = 0, by_force = 0, in_time = 0, crossed = 0;
  double clear = 0, detection = 0, force = 0, excess = 0, travel = 0, speed = 0, commanded = 0;
  for (const HazardCell& cell : study.cells) {
    runs += cell.runs.size();
    for (const HazardRun& run : cell.runs) {
      begun += run.begin >= 0;
      stopped += run.begin >= 0 && run.until_stop >= 0;
      by_force += run.cause == StopCause::kForce;
      in_time += run.cause == StopCause::kForce && run.clear_detection <= kInTime;
      crossed += run.detection >= 0;
      clear = std::max(clear, run.clear_detection);
      detection = std::max(detection, run.detection);
      excess = std::max(excess, run.excess);
      force = std::max(force, run.after);
      travel = std::max(travel, run.travel / cell.travel_budget);
      speed = std::max(speed, run.speed / cell.speed_cap);
      commanded = std::max(commanded, run.commanded);
    }
  }
  std::string text;
  AppendLine(&text, "%zu runs (%d from an earlier study); the hazard began in %zu; %zu stopped.",
             runs, study.kept, begun, stopped);
  AppendLine(&text,
             "%zu of %zu force stops were decided within 3 ms after the true force exceeded its "
             "threshold by more than the sensor resolves, all within %.0f ms.",
             in_time, by_force, 1e3 * clear);
  AppendLine(&text,
             "In %zu of these runs, the true force itself had crossed the threshold, at most %.0f "
             "ms earlier and by at most %.2f N. The largest measured force was %.2f N.",
             crossed, 1e3 * detection, excess, force);
  AppendLine(&text, "The stop with the longest travel used %.0f %% of its travel budget.",
             100 * travel);
  // An arm executes a command with a delay and an error, and the measured speed contains noise.
  AppendLine(&text,
             "The fastest command used %.1f %% of its cap. The measured speed of a handle reached "
             "%.1f %% of the cap.",
             100 * commanded, 100 * speed);
  return text;
}

}  // namespace predictor
