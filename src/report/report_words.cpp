#include "report/report_words.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/format.h"
#include "core/text.h"
#include "core/units.h"
#include "core/words.h"
#include "report/page.h"
#include "report/run_plots.h"

namespace predictor {
namespace {

constexpr std::size_t kEventsShown = 200;

std::string Mm(double metres) { return Significant(1e3 * metres, 3, 3) + " mm"; }
std::string Degrees(double radians) { return Significant(kDegrees * radians, 3, 4) + "°"; }
std::string Count(std::uint64_t n) {
  std::string digits = std::to_string(n);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), " ");
  return digits;
}
std::string Times(std::uint64_t n) { return n == 1 ? "once" : Count(n) + " times"; }

// Returns a text such as "0.098 ± 0.088". Both numbers have the same number of decimal places,
// which gives the larger number three significant digits.
std::string Spread(double mean, double deviation, int decimals) {
  const double larger = std::max(std::abs(mean), deviation);
  const int exponent = larger > 0 ? static_cast<int>(std::floor(std::log10(larger))) : 0;
  const int shown = std::clamp(2 - exponent, 0, decimals);
  return Formatted("%.*f ± %.*f", shown, mean, shown, deviation);
}

std::string Paragraph(const std::string& text) { return "<p>" + text + "</p>\n"; }

std::string RunWords(const RunData& run) {
  const Summary& s = run.summary;
  std::string text =
      std::string("This run ") +
      (run.info.scenario.mode == Mode::kDirect ? "with the object held directly " : "") + "took " +
      Round(s.duration(), 5) + " s (" + Count(s.ticks()) + " ticks) in " +
      (run.real_time ? "real" : "virtual") + " time, with the seed " + std::to_string(s.seed) + ".";
  if (s.ticks() == 0) text += " The run never reached the state RUN.";
  return text;
}

// Returns ": 31.2 N, limit 30 N", or "" if nothing was measured.
std::string MeasuredPart(const StopSummary& stop) {
  const std::string measured =
      MeasuredWords({stop.cause, -1, stop.value, stop.limit, stop.quantity});
  return measured.empty() ? "" : ": " + measured;
}

std::string StopSentence(const RunData& run) {
  if (run.stops.empty()) return "There was no safety stop.";
  const StopSummary& stop = run.stops.front().summary;
  std::string text = run.stops.size() == 1 ? "A safety stop occurred "
                                           : "A safety stop occurred " + Times(run.stops.size()) +
                                                 ". The first one occurred ";
  text += Round(stop.time, 5) + " s after the start. Its cause was '" +
          EscapeMarkup(Name(stop.cause)) + "'";
  if (stop.hand >= 0) text += std::string(" (") + HandName(stop.hand & 1) + " hand)";
  text += MeasuredPart(stop);
  text += DidNotRest(stop) ? ". The arms did not come to rest."
                           : ". The arms came to rest after " + Round(1e3 * stop.duration) +
                                 " ms and " + Mm(stop.distance) + ".";
  return text + HarderWords(stop.harder);
}

std::string TrackingWords(const RunData& run) {
  const bool gripped = std::ranges::any_of(kHandNames, [&](const char* side) {
    return run.summary.Get<Statistics>(std::string("tracking.") + side + ".translation_m").count() >
           0;
  });
  const auto of = [&](const std::string& key) -> const Statistics& {
    return run.summary.Get<Statistics>((gripped ? "tracking." : "tracking.released.") + key);
  };
  std::string text;
  for (const char* side : kHandNames) {
    const Statistics& s = of(side + std::string(".translation_m"));
    if (s.count() == 0) continue;
    text += (!text.empty() ? "; the distance between the "
             : gripped     ? "While the hands gripped, the distance between the "
                           : "No hand gripped; the distance between the ") +
            std::string(side) + " handle and its target was " +
            Spread(1e3 * s.mean(), 1e3 * s.std(), 3) + " mm, and at most " + Mm(s.max());
  }
  if (text.empty()) return "";
  if (of("relative.distance_m").count() > 0)
    text += ". The error of the distance between the two handles was at most " +
            Mm(of("relative.distance_m").max()) +
            ". The error of the right handle's pose relative to the left handle was at most " +
            Mm(of("relative.right_from_left_m").max()) + " and " +
            Degrees(of("relative.angle_rad").max());
  return text + ".";
}

std::string ForceWords(const RunData& run) {
  std::string text;
  for (const char* side : kHandNames) {
    const auto& force = run.summary.Get<Statistics>(std::string("wrench.") + side + ".force_n");
    if (force.count() == 0) continue;
    text += (text.empty() ? "The " : ", and the ") + std::string(side) + " hand's force reached " +
            Significant(force.max()) + " N";
  }
  if (text.empty()) return "";
  text += " (threshold " + Round(ThresholdOf(run, Parameter::kForceThreshold)) + " N).";
  const auto nearest = run.summary.Get<double>("link_distance_m.min");
  if (std::isfinite(nearest))
    text += " The smallest distance between links of the two arms was " + Significant(nearest) +
            " m (limit " + Round(run.info.scenario.rendering.security_distance) + " m).";
  return text;
}

// Describes the worst window and whether it needs attention.
std::string OscillationWords(const RunData& run) {
  const auto largest = [&](const char* key) {
    double value = 0;
    for (const char* hand : kHandNames)
      value =
          std::fmax(value, run.summary.Get<double>(std::string("oscillation.") + hand + "." + key));
    return value;
  };
  const double index = largest("index"), bad = largest("strong_index"), rms = largest("rms_n");
  if (bad > OscillationIndex::kStop)
    return "A hand's force oscillated. The oscillation index reached " + Significant(bad, 2) +
           ", and the rms of the force from 3 to 10 Hz reached " + Significant(rms, 2) + " N.";
  if (index > OscillationIndex::kWarn)
    return "The oscillation index of a hand's force reached " + Significant(index, 2) +
           ", but did not exceed 0.5 while the force varied by more than 3 N. The rms of the force "
           "from 3 to 10 Hz was at most " +
           Significant(rms, 2) + " N.";
  if (index == 0) return "The hands' forces were too small for an oscillation between 3 and 10 Hz.";
  // A small share of a large force may still be a large force.
  return "From 3 to 10 Hz, each hand's force had an rms of at most " + Significant(rms, 2) +
         " N, which is small compared with slower changes of the force (index at most " +
         Significant(index, 2) + " while the force varied by more than " +
         Round(OscillationIndex::kMinForce) + " N).";
}

std::string TimingWords(const RunData& run) {
  const auto& tick = run.summary.Get<Quantiles>("timing_us.tick");
  if (tick.count == 0) return "";
  std::string text = "The median time of a tick was " + Significant(tick.p50) +
                     " µs, the 99.9 % quantile was " + Significant(tick.p999) +
                     " µs and the maximum was " + Significant(tick.max) + " µs, with a period of " +
                     Round(1e6 * run.dt) + " µs";
  const auto late = run.summary.Get<std::uint64_t>("deadlines.late_ticks");
  const auto most = run.summary.Get<std::uint64_t>("deadlines.most_in_a_row");
  if (run.real_time)
    text += late == 0 ? "; no deadline was missed"
                      : "; deadlines were missed before " + Count(late) + " ticks, at most " +
                            Count(most) + " in a row";
  return text + ".";
}

std::string FileWords(const RunData& run) {
  std::string text;
  if (run.lost > 0)
    text += "<b>" + Count(run.lost) + " ticks are missing</b> in " + Count(run.gaps) +
            " places. The plotted lines are interrupted at the missing ticks, and sums omit these "
            "ticks. ";
  if (run.disordered > 0)
    text += Count(run.disordered) + " records were out of order, so the report omits them. ";
  if (!run.info.problem.empty()) text += EscapeMarkup(run.info.problem) + " ";
  return text;
}

std::vector<std::string> QuantilesRow(const std::string& name, const Quantiles& q, double scale) {
  return {name,
          Significant(scale * q.p50),
          Significant(scale * q.p99),
          Significant(scale * q.p999),
          Significant(scale * q.max),
          Count(q.count)};
}

std::vector<std::vector<std::string>> QuantilesTable(const ResultGroup& group) {
  std::vector<std::vector<std::string>> rows = {{WithUnit(group.title, group.columns.front()->unit),
                                                 "median", "99 %", "99.9 %", "largest", "ticks"}};
  for (const ResultGroup::Row& row : group.rows)
    rows.push_back(QuantilesRow(row.label, std::get<Quantiles>(row.cells.front()->value),
                                row.cells.front()->unit.factor));
  return rows;
}

std::vector<std::vector<std::string>> StatisticsTable(const ResultGroup& group) {
  std::vector<std::vector<std::string>> rows = {{group.title}};
  for (const Result* column : group.columns) {
    rows[0].push_back(WithUnit(column->column, column->unit));
    rows[0].push_back("largest");
  }
  for (const ResultGroup::Row& row : group.rows) {
    std::vector<std::string> cells = {row.label};
    for (const Result* cell : row.cells) {
      if (!cell) {
        cells.insert(cells.end(), 2, "");
        continue;
      }
      const auto& s = std::get<Statistics>(cell->value);
      const Unit& unit = cell->unit;
      cells.push_back(Spread(unit.factor * s.mean(), unit.factor * s.std(), unit.decimals));
      cells.push_back(Significant(unit.factor * s.max(), 3, unit.decimals));
    }
    cells.resize(rows[0].size());
    rows.push_back(std::move(cells));
  }
  return rows;
}

std::vector<std::string> PortRow(const std::string& name, const PortEnergy& port) {
  return {name,
          Significant(port.sum, 3, 3),
          Significant(port.lowest, 3, 3),
          std::to_string(port.episodes),
          Significant(port.returned, 3, 3),
          Significant(port.peak_return, 3, 3)};
}

// Lists the times before the stop at which the hand's force or torque last exceeded shares of its
// limit.
std::string Approach(const RunData& run, const ReportedStop& stop) {
  const StopSummary& s = stop.summary;
  const bool force = s.cause == StopCause::kForce, torque = s.cause == StopCause::kTorque;
  if ((!force && !torque) || s.hand < 0 || s.hand >= kHands) return "";
  const auto before = static_cast<std::uint64_t>(Trace::kBefore / run.dt);
  std::vector<double> t, y;
  run.trace.Part(stop.tick - std::min(stop.tick, before), stop.tick, stop.tick,
                 ChannelOf(s.hand, force ? HandChannel::kForce : HandChannel::kTorque), &t, &y);
  std::string text;
  for (const double share : {0.5, 0.85}) {
    double crossed = NAN;
    for (std::size_t i = 1; i < y.size(); ++i)
      if (y[i] >= share * s.limit && y[i - 1] < share * s.limit) crossed = t[i];
    if (std::isnan(crossed)) continue;
    text += (text.empty()
                 ? "The hand's " + std::string(force ? "force" : "torque") + " last rose above "
                 : " and above ") +
            Round(100 * share) + " % of its threshold " + Round(-1e3 * crossed) + " ms";
  }
  return text.empty() ? "" : text + " before the decision.";
}

std::string LastEvents(const RunData& run, const ReportedStop& stop) {
  std::string list;
  for (const ReportedEvent& event : run.events) {
    const double ago = run.TimeOf(stop.tick) - run.TimeOf(event.tick);
    if (event.tick >= stop.tick || ago > Trace::kBefore) continue;
    list += "<li>" + Round(std::round(1e3 * ago) / 1e3) + " s before: " + EscapeMarkup(event.text) +
            "</li>\n";
  }
  return list.empty()
             ? ""
             : "<p>Events in the ten seconds before the stop:</p>\n<ul>" + list + "</ul>\n";
}

// A quantity by which runs are compared.
struct Figure {
  std::string name;
  std::function<double(const RunData&)> value;  // NaN: none
};

struct NamedNumber {
  const char* name;  // "": the only number
  double value;      // NaN: none
};

// Returns the numbers of a result that are compared, in the unit in which the result is shown.
std::vector<NamedNumber> NumbersOf(const Result& result) {
  const double factor = IsMissing(result.value) ? NAN : result.unit.factor;
  if (const auto* s = std::get_if<Statistics>(&result.value))
    return {{"mean", factor * s->mean()}, {"largest", factor * s->max()}};
  if (const auto* q = std::get_if<Quantiles>(&result.value)) return {{"median", factor * q->p50}};
  if (const auto* number = std::get_if<double>(&result.value)) return {{"", factor * *number}};
  if (const auto* count = std::get_if<std::uint64_t>(&result.value))
    return {{"", factor * static_cast<double>(*count)}};
  return {};
}

// Returns the numbers of all metrics, followed by the number of stops.
std::vector<Figure> FiguresOf(const Summary& summary) {
  std::vector<Figure> figures;
  for (const Result& result : summary.results) {
    const std::vector<NamedNumber> numbers = NumbersOf(result);
    for (std::size_t k = 0; result.compared && k < numbers.size(); ++k) {
      std::vector<std::string> words;
      for (const std::string& word : {result.column.empty() ? result.group : "", result.label,
                                      result.column, std::string(numbers[k].name)})
        if (!word.empty()) words.push_back(word);
      figures.push_back(
          {WithUnit(Join(words), result.unit), [path = result.path, k](const auto& run) {
             return NumbersOf(run.summary.At(path))[k].value;
           }});
    }
  }
  figures.push_back(
      {"stops", [](const RunData& run) { return static_cast<double>(run.stops.size()); }});
  return figures;
}

std::string FigureText(double value) {
  if (std::isnan(value)) return "–";
  return value == std::round(value) ? Round(value, 9) : Significant(value, 3, 4);
}

std::string Signed(double value) {
  const std::string size = Significant(std::abs(value), 2, 4);
  return size == "0" ? size : (value > 0 ? "+" : "−") + size;
}

std::string DifferenceCell(double value, double first) {
  std::string cell = FigureText(value);
  if (std::isnan(value) || std::isnan(first)) return cell;
  if (value == first) return cell + " <small>(=)</small>";
  const double difference = value - first;
  cell += " <small>(" + (Signed(difference) == "0" ? "less than 0.0001" : Signed(difference));
  if (first != 0 && std::abs(difference / first) < 9.995)
    cell += ", " + Signed(100 * difference / first) + " %";
  return cell + ")</small>";
}

}  // namespace

std::string SummaryWords(const RunData& run) {
  std::string html = Paragraph(RunWords(run) + " " + StopSentence(run));
  const std::string file = FileWords(run);
  if (!file.empty()) html += "<p class=\"warning\">" + file + "</p>\n";
  if (const auto& loop = run.summary.loop)
    html += (loop->stable() ? "<p>" : "<p class=\"warning\">") + LoopWords(*loop) + "</p>\n";
  html += Paragraph(TrackingWords(run) + " " + ForceWords(run) + " " + OscillationWords(run));
  const auto energy = [&](const char* key) {
    return Significant(run.summary.Get<double>(key), 3, 3);
  };
  html += Paragraph("The hands supplied " + energy("energy.supplied_j") +
                    " J in total and received " + energy("energy.returned_j") +
                    " J back. The lowest balance was " + energy("energy.lowest_j") + " J" +
                    (run.summary.Get<double>("energy.lowest_j") < PortEnergy::kEpisode
                         ? ", because some energy was returned before it was supplied, for example "
                           "from a spring that is loaded at the start."
                         : ", so the energy returned never exceeded the energy supplied.") +
                    " " + TimingWords(run));
  return html;
}

std::string StopWords(const RunData& run, const ReportedStop& stop) {
  const StopSummary& s = stop.summary;
  std::string text =
      "This stop was decided at " + Round(s.time, 5) + " s with the cause '" + Name(s.cause) + "'";
  if (s.hand >= 0) text += std::string(" (") + HandName(s.hand & 1) + " hand)";
  text += MeasuredPart(s);
  text += ". ";
  if (s.detection)
    text += "The true force or torque of the hand crossed the threshold " +
            Round(1e3 * *s.detection) + " ms before the decision. ";
  text += DidNotRest(s) ? "The arms did not come to rest."
                        : "The arms came to rest " + Round(1e3 * s.duration) +
                              " ms after the decision. The handle that moved further moved " +
                              Mm(s.distance) + ".";
  return Paragraph(text + HarderWords(s.harder) + " " + Approach(run, stop)) +
         LastEvents(run, stop);
}

std::string DetailWords(const Runs& runs) {
  std::string html;
  for (const RunCurves& curves : runs) {
    const RunData& run = curves.run();
    const std::string of = runs.size() == 1 ? "" : "<b>" + EscapeMarkup(run.info.name) + "</b>: ";
    if (run.trace.complete()) {
      html += Paragraph(of +
                        "This page contains every tick. In wide views, the plots show the minimum "
                        "and maximum of each interval of 50 ms.");
      continue;
    }
    std::string list;
    for (const TraceInterest& interest : run.trace.Kept())
      list += "<li>" + EscapeMarkup(interest.why) + " at " + Round(run.TimeOf(interest.tick), 6) +
              " s</li>\n";
    html += Paragraph(
        of + "The plots show the minimum and maximum of each 50 ms, and every tick within " +
        Significant(run.trace.detail_seconds()) +
        " s around stops, markers and worst values, except in wide views:");
    html.append("<ul>").append(list).append("</ul>\n");
    html += Paragraph(
        "This page does not contain the other ticks. To see the other ticks, show the recording "
        "with <code>predictor replay</code>.");
  }
  return html +
         Paragraph(
             "To keep the page small, the values in the plots are rounded. Translations are "
             "rounded to 0.1 µm, angles of errors to 0.00001°, joints to 0.002°, forces to 5 mN, "
             "torques to 0.5 mN·m, energies to 0.1 mJ, and positions to 0.1 mm or better. "
             "All statistics use the unrounded values of every tick.");
}

std::string ResultTables(const RunData& run, Chapter chapter) {
  std::string html;
  for (const ResultGroup& group : GroupResults(run.summary.results)) {
    if (group.chapter != chapter) continue;
    if (!group.line.empty()) html += Paragraph(group.title + ": " + group.line + ".");
    if (group.rows.empty()) continue;
    const bool quantiles = std::holds_alternative<Quantiles>(group.columns.front()->value);
    html += HtmlTable(quantiles ? QuantilesTable(group) : StatisticsTable(group));
  }
  return html;
}

std::string EnergyTable(const RunData& run) {
  std::vector<std::vector<std::string>> rows = {{"port", "supplied [J]", "lowest balance [J]",
                                                 "times below −0.05 J", "returned [J]",
                                                 "largest power received [W]"}};
  for (const int i : run.present) {
    const auto k = static_cast<std::size_t>(i);
    rows.push_back(PortRow(std::string(HandName(i)) + " hand, real handle", run.hand_port[k]));
    rows.push_back(
        PortRow(std::string(HandName(i)) + " hand, virtual handle", run.virtual_port[k]));
    rows.push_back(PortRow(std::string(HandName(i)) + " coupling", run.coupling_port[k]));
  }
  const auto& s = run.summary;
  const auto energy = [&](const char* key) { return Significant(s.Get<double>(key), 3, 3); };
  rows.push_back({"both hands, real handles", energy("energy.supplied_j"),
                  energy("energy.lowest_j"),
                  std::to_string(s.Get<std::uint64_t>("energy.episodes")),
                  energy("energy.returned_j"), energy("energy.peak_return_w")});
  return HtmlTable(rows) +
         Paragraph(
             "A port is passive if its balance never falls below the negative of the energy stored "
             "at the start. At the end, the virtual world stored " +
             Significant(run.stored) +
             " J more than at the start. Its friction and damping dissipated " +
             Significant(run.dissipated) +
             " J of the energy from the hands and the coupling. If a controller moves its "
             "set-point, it can also supply energy.");
}

std::string LatencyTable(const RunData& run) {
  std::vector<std::vector<std::string>> rows = {
      {"step [ms]", "median", "99 %", "99.9 %", "largest", "samples"}};
  const auto add = [&](const std::string& name, const Histogram& h, double scale) {
    if (h.count() > 0) rows.push_back(QuantilesRow(name, QuantilesOf(h), scale));
  };
  add("start of a tick, deviation from the clock", run.jitter, 1e-3);
  add("force sample to tick", run.sensor_age, 1e-3);
  add("joint sample to tick", run.arm_age, 1e-3);
  rows.push_back(QuantilesRow("tick", run.summary.Get<Quantiles>("timing_us.tick"), 1e-3));
  for (const auto& [client, latency] : run.pages) {
    const std::string name = "page " + std::to_string(client);
    add("tick to " + name, latency.received, 1);
    add("tick to the screen of " + name, latency.rendered, 1);
  }
  std::string html = HtmlTable(rows);
  if (run.pages.empty())
    html += Paragraph("No page reported the time that a state takes to reach its screen.");
  else
    html += Paragraph(
        "Each page reports the medians of each second. The page's clock is synchronised to the "
        "program's clock.");
  return html;
}

std::string EventTable(const RunData& run) {
  std::vector<std::vector<std::string>> rows = {{"time [s]", "what"}};
  for (const ReportedEvent& event : run.events) {
    if (rows.size() > kEventsShown) break;
    rows.push_back(
        {Round(std::round(1e3 * run.TimeOf(event.tick)) / 1e3, 7),
         (event.marker ? "<b>" + EscapeMarkup(event.text) + "</b>" : EscapeMarkup(event.text))});
  }
  const std::uint64_t more = run.events.size() + 1 - rows.size() + run.more_events;
  return HtmlTable(rows) +
         (more > 0 ? Paragraph("The table omits " + Count(more) + " more events.") : "");
}

std::string ComparisonTable(const std::vector<RunData>& runs) {
  std::vector<std::vector<std::string>> rows(1);
  rows[0].push_back("");
  for (const RunData& run : runs) rows[0].push_back(EscapeMarkup(run.info.name));
  for (const Figure& figure : FiguresOf(runs.front().summary)) {
    const double first = figure.value(runs.front());
    std::vector<std::string> row = {figure.name};
    bool any = false;
    for (std::size_t r = 0; r < runs.size(); ++r) {
      const double value = figure.value(runs[r]);
      any = any || !std::isnan(value);
      row.push_back(r == 0 ? FigureText(value) : DifferenceCell(value, first));
    }
    if (any) rows.push_back(std::move(row));
  }
  return HtmlTable(rows);
}

}  // namespace predictor
