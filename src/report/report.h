// The report on one run, or on several runs side by side.
#pragma once

#include <string>
#include <vector>

#include "report/plot.h"
#include "report/run_data.h"

namespace predictor {

struct ReportDocument {
  std::string html;         // one self-contained page
  std::vector<Plot> plots;  // the plots in the page
};

// `runs`: at least one. program_version: version of the program that makes the report.
ReportDocument MakeReport(const std::vector<RunData>& runs, const std::string& program_version);

}  // namespace predictor
