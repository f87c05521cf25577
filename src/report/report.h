// Makes the report on one run, or on several runs side by side.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "report/plot.h"
#include "report/run_data.h"

namespace predictor {

struct ReportDocument {
  std::string html;         // one self-contained page
  std::vector<Plot> plots;  // the plots in the page
};

class ReportPage;

// A function with which another module adds chapters to the page.
using AddChapters = std::function<void(ReportPage*)>;

// `runs` contains at least one run. `program_version` is the version of the program that makes the
// report. `chapters` are placed after the forces.
ReportDocument MakeReport(
    const std::vector<RunData>& runs, const std::string& program_version,
    const AddChapters& chapters = [](ReportPage*) {});

}  // namespace predictor
