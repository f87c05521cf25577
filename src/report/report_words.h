// Writes the text and the tables of a report.
#pragma once

#include <string>
#include <vector>

#include "report/run_data.h"
#include "report/run_plots.h"

namespace predictor {

// Summarises the run in a few sentences, as HTML.
std::string SummaryWords(const RunData& run);
// Describes one stop as HTML: the decision and its cause, the preceding events, and the time and
// distance of the stop.
std::string StopWords(const RunData& run, const ReportedStop& stop);
// Describes the parts of the runs that are shown tick by tick, as HTML.
std::string DetailWords(const Runs& runs);

// Returns the results of the run's metrics that belong to a chapter, as HTML.
std::string ResultTables(const RunData& run, Chapter chapter);
std::string EnergyTable(const RunData& run);
std::string LatencyTable(const RunData& run);
std::string EventTable(const RunData& run);
// Describes, as HTML, the scenario's events and what the hands felt after them.
std::string HazardTable(const RunData& run);
// Returns a table of all compared results with one column per run. The columns of later runs
// include the difference from the first run.
std::string ComparisonTable(const std::vector<RunData>& runs);

}  // namespace predictor
