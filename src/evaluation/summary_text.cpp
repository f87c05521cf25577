// Writes the summary as text for the user.
#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/text.h"
#include "core/text_table.h"
#include "core/units.h"
#include "core/words.h"
#include "evaluation/summary.h"

namespace predictor {
namespace {

// Appends `text` (UTF-8) in a column of this width, left- or right-aligned.
void AppendPadded(const std::string& text, int width, bool right, std::string* out) {
  const auto characters = static_cast<std::size_t>(width);
  *out += right ? RightAligned(text, characters) : LeftAligned(text, characters);
}

void EndLine(std::string* text) {
  text->erase(text->find_last_not_of(' ') + 1);
  *text += '\n';
}

// The widths of the columns "mean ± deviation largest" depend on the number of decimals of the
// unit.
int RoomOf(const Unit& unit) { return std::max(unit.decimals, 2); }
int WidthOf(const Unit& unit) { return 3 * RoomOf(unit) + 16; }
std::string CellText(const Result& result) {
  const Unit& u = result.unit;
  const auto& s = std::get<Statistics>(result.value);
  const int room = RoomOf(u);
  return Formatted("%*.*f ±%*.*f %*.*f", room + 5, u.decimals, u.factor * s.mean(), room + 3,
                   u.decimals, u.factor * s.std(), room + 5, u.decimals, u.factor * s.max());
}

void AddStatistics(const ResultGroup& group, std::string* text) {
  constexpr int kLabel = 34, kBetween = 3;
  AppendPadded(group.title, kLabel, false, text);
  for (const Result* column : group.columns)
    AppendPadded(WithUnit(column->column, column->unit), WidthOf(column->unit) + kBetween, false,
                 text);
  EndLine(text);
  text->append(kLabel, ' ');
  for (const Result* column : group.columns) {
    AppendPadded("mean ± std", 2 * RoomOf(column->unit) + 10, true, text);
    AppendPadded("max", RoomOf(column->unit) + 6, true, text);
    text->append(kBetween, ' ');
  }
  EndLine(text);
  for (const ResultGroup::Row& row : group.rows) {
    AppendPadded("  " + row.label, kLabel, false, text);
    for (std::size_t c = 0; c < row.cells.size(); ++c)
      AppendPadded(row.cells[c] ? CellText(*row.cells[c]) : "",
                   WidthOf(group.columns[c]->unit) + kBetween, false, text);
    EndLine(text);
  }
}

void AddQuantiles(const ResultGroup& group, std::string* text) {
  AppendPadded(WithUnit(group.title, group.columns.front()->unit), 18, false, text);
  AppendLine(text, " %8s %8s %8s %8s", "p50", "p99", "p99.9", "max");
  for (const ResultGroup::Row& row : group.rows) {
    const auto& q = std::get<Quantiles>(row.cells.front()->value);
    AppendLine(text, "  %-14s %10.1f %8.1f %8.1f %8.1f", row.label.c_str(), q.p50, q.p99, q.p999,
               q.max);
  }
}

// If `timing` is true, adds only the results that depend on the computer's speed. Otherwise, adds
// only the other results.
void AddResults(const std::vector<ResultGroup>& groups, bool timing, std::string* text) {
  const ResultGroup* above = nullptr;
  for (const ResultGroup& group : groups) {
    if ((group.chapter == Chapter::kTiming) != timing) continue;
    if (above && !above->rows.empty() && above->chapter != group.chapter) *text += '\n';
    above = &group;
    if (!group.line.empty()) AppendLine(text, "%-22s %s", group.title.c_str(), group.line.c_str());
    if (group.rows.empty()) continue;
    if (std::holds_alternative<Quantiles>(group.columns.front()->value))
      AddQuantiles(group, text);
    else
      AddStatistics(group, text);
  }
}

void AddStop(const StopSummary& stop, std::string* text) {
  const Status status{stop.cause, -1, stop.value, stop.limit, stop.quantity};
  std::string seen = ".";
  if (const std::string measured = MeasuredWords(status); !measured.empty())
    seen = ": " + measured + ".";
  const std::string hand =
      stop.hand < 0 ? ""
                    : ", " + std::string(kHandNames[static_cast<std::size_t>(stop.hand)]) + " hand";
  AppendLine(text, "Stopped after %.3f s of emulation by cause '%s'%s%s", stop.time,
             Name(stop.cause), hand.c_str(), seen.c_str());
  if (stop.fastest_joint >= 0)
    AppendLine(text, "  The fastest joint of the cobot was its joint %d.", stop.fastest_joint + 1);
  if (stop.quantity != Quantity::kNone || stop.cause == StopCause::kPhysics)
    AppendLine(text, "  Explanation: %s. %s", StopCauseText(stop.cause, stop.quantity).c_str(),
               CauseAdvice(status).c_str());
  if (DidNotRest(stop))
    AppendLine(text, "  The arms had not come to rest.");
  else
    AppendLine(text, "  The handles came to rest after %.0f ms and %.1f mm.", 1e3 * stop.duration,
               1e3 * stop.distance);
  if (const std::string harder = HarderWords(stop.harder); !harder.empty())
    AppendLine(text, " %s", harder.c_str());
  if (stop.detection)
    AppendLine(text,
               "  The stop was decided %.0f ms after the hand's true value crossed the threshold.",
               1e3 * *stop.detection);
}

void AddEvents(const Summary& s, std::string* text) {
  for (const EventSummary& event : s.events) {
    if (!event.begin) {
      AppendLine(text, "Event '%s' did not begin.", event.event.c_str());
      continue;
    }
    AppendLine(text, "Event '%s' at %.3f s: %s.", event.event.c_str(), *event.begin,
               event.meaning.c_str());
    if (event.missed)
      AppendLine(text, "  The gripper stayed open, because the object was too far away.");
    AppendLine(text,
               "  Largest values afterwards: force %.1f N, torque %.2f N·m, speed %.0f mm/s%s.",
               *std::max_element(event.force.begin(), event.force.end()),
               *std::max_element(event.torque.begin(), event.torque.end()),
               1e3 * *std::max_element(event.speed.begin(), event.speed.end()),
               event.until_stop ? Formatted("; stop after %.3f s", *event.until_stop).c_str() : "");
  }
  if (s.cobot_stop)
    AppendLine(text, "The cobot stopped itself at %.3f s by its limit of %s.", s.cobot_stop->time,
               CobotStopWords(s.cobot_stop->reason).c_str());
}

void AddStops(const Summary& s, std::string* text) {
  constexpr std::size_t kMaxListed = 10;
  if (s.stops.empty()) return AppendLine(text, "No safety stop.");
  if (s.stop_count > 1)
    AppendLine(text, "%llu stops:", static_cast<unsigned long long>(s.stop_count));
  const std::size_t listed = std::min(s.stops.size(), kMaxListed);
  for (std::size_t i = 0; i < listed; ++i) AddStop(s.stops[i], text);
  if (s.stop_count > listed)
    AppendLine(text, "There are %llu more stops; --json FILE.json lists %zu.",
               static_cast<unsigned long long>(s.stop_count - listed), s.stops.size());
}

// If the object does not move, for example because it stands on the floor, the results of a run are
// meaningless.
void AddLift(const Summary& s, std::string* text) {
  constexpr double kLifted = 0.1;  // share of the intended height
  const double intended = s.Get<double>("object.scripted_lift_m");
  const double rise = s.Get<double>("object.scripted_rise_m");
  if (!(rise < kLifted * intended)) return;
  AppendLine(
      text,
      "Warning: the script moves the object up by %.0f mm, but the object rose by only %.0f mm. "
      "`predictor check` reports whether the object rests on the floor at the start.",
      kMillimetres * intended, kMillimetres * rise);
}

}  // namespace

std::string LoopWords(const PredictedLoop& loop) {
  return Formatted("Lead %.1f ms, stability margin %.1f: ", 1e3 * loop.lead, loop.margin) +
         (loop.stable() ? "the haptic loop was predicted stable."
                        : "the haptic loop was PREDICTED UNSTABLE with this hand. Run "
                          "`predictor check`.");
}

std::string SummaryTable(const Summary& s) {
  std::string text;
  AppendLine(&text, "%s", Printable(s.scenario).c_str());
  if (s.ticks() == 0)
    AppendLine(&text,
               "The state RUN was never reached, so there are no errors or forces to report.");
  else
    AppendLine(&text, "%.2f s emulated in %llu ticks, %s, seed %llu", s.duration(),
               static_cast<unsigned long long>(s.ticks()),
               s.by_the_clock ? "in real time"
                              : Formatted("%.1f times real time", s.real_time_factor).c_str(),
               static_cast<unsigned long long>(s.seed));
  if (s.loop) AppendLine(&text, "%s", LoopWords(*s.loop).c_str());
  text += '\n';
  const std::vector<ResultGroup> groups = GroupResults(s.results);
  if (s.ticks() > 0) AddResults(groups, false, &text), text += '\n';
  AddLift(s, &text);
  AddEvents(s, &text);
  AddStops(s, &text);
  text += '\n';
  AddResults(groups, true, &text);
  if (s.overruns + s.records_dropped > 0)
    AppendLine(&text, "Ticks that began late: %llu. Records dropped: %llu.",
               static_cast<unsigned long long>(s.overruns),
               static_cast<unsigned long long>(s.records_dropped));
  return text;
}

}  // namespace predictor
