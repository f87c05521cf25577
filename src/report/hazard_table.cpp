// Makes the table that shows what the hands felt after the events of a scenario.
#include <algorithm>
#include <array>

#include "core/format.h"
#include "core/text.h"
#include "core/words.h"
#include "report/page.h"
#include "report/report_words.h"

namespace predictor {

std::string HazardTable(const RunData& run) {
  std::vector<std::vector<std::string>> rows = {
      {"event", "what happens", "from [s]", "to [s]", "largest force [N]", "largest torque [N·m]",
       "largest speed [mm/s]", "emulator's stop after [s]"}};
  const auto largest = [](const std::array<double, kHands>& values) {
    return *std::max_element(values.begin(), values.end());
  };
  const auto time = [](const std::optional<double>& t) { return t ? Formatted("%.3f", *t) : "–"; };
  for (const EventSummary& event : run.summary.events) {
    std::vector<std::string> row = {EscapeMarkup(event.event), EscapeMarkup(event.meaning),
                                    time(event.begin), time(event.end)};
    if (event.begin)
      row.insert(row.end(),
                 {Formatted("%.1f", largest(event.force)), Formatted("%.2f", largest(event.torque)),
                  Formatted("%.0f", 1e3 * largest(event.speed))});
    else
      row.insert(row.end(), {"–", "–", "–"});
    row.push_back(time(event.until_stop));
    rows.push_back(std::move(row));
  }
  std::string html = HtmlTable(rows);
  if (run.summary.cobot_stop)
    html += "<p>The virtual cobot stopped itself at " +
            Formatted("%.3f", run.summary.cobot_stop->time) + " s by its limit of " +
            CobotStopWords(run.summary.cobot_stop->reason) + ".</p>\n";
  return html;
}

}  // namespace predictor
