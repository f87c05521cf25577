// What a report says in words and tables.
#pragma once

#include <string>
#include <vector>

#include "report/run_data.h"
#include "report/run_plots.h"

namespace predictor {

// The run in a few sentences, HTML.
std::string SummaryWords(const RunData& run);
// One stop: what was decided and why, what went before, what it took. HTML.
std::string StopWords(const RunData& run, const ReportedStop& stop);
// Which parts are shown tick by tick. HTML.
std::string DetailWords(const Runs& runs);

std::string TrackingTable(const RunData& run);
std::string WrenchTable(const RunData& run);
std::string EnergyTable(const RunData& run);
std::string TimingTable(const RunData& run);
std::string LatencyTable(const RunData& run);
std::string EventTable(const RunData& run);
// Rows of figures, a column a run, with the difference from the first.
std::string ComparisonTable(const std::vector<RunData>& runs);

}  // namespace predictor
