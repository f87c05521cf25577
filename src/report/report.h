// The report of one run, or of several side by side.
#pragma once

#include <string>
#include <vector>

#include "report/plot.h"
#include "report/run_data.h"

namespace predictor {

struct ReportDocument {
  std::string html;         // one page, self-contained
  std::vector<Plot> plots;  // that are in it
};

// `runs`: at least one. program_version: of what makes the report.
ReportDocument MakeReport(const std::vector<RunData>& runs, const std::string& program_version);

}  // namespace predictor
