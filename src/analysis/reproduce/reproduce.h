// The paper's experiments done again, in virtual time, with the paper's figures beside ours.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "report/plot.h"

namespace predictor {

// A figure as a paper prints it: mean ± standard deviation, in the unit of its row.
struct PrintedValue {
  double mean = 0, deviation = 0;
  int decimals = 1;  // behind the point
};

// One figure: the paper's, where it prints one, and ours.
struct ReproducedNumber {
  std::string experiment;  // as in `--only`
  std::string place;       // in the paper: "Fig. 7A"
  std::string quantity, unit;
  std::string condition;  // under which ours was obtained
  std::optional<PrintedValue> paper;
  double mean = 0;
  double deviation = std::numeric_limits<double>::quiet_NaN();  // NaN: of a single value
  double largest = std::numeric_limits<double>::quiet_NaN();    // NaN: not told
  std::string command;                                          // that gives ours once more
  bool variant = false;                 // of an assumption: apart from the overview
  std::optional<double> ratio() const;  // ours over the paper's
};

// A picture that is not a plot.
struct ReproducedImage {
  std::string id;     // of its file
  std::string bytes;  // of the file
  std::string extension;
};

// What the page says of an experiment, in its order: HTML, or a plot.
struct ReproducedBlock {
  std::string html;
  std::optional<Plot> plot;
};

struct ReproducedExperiment {
  std::string name, title;
  std::vector<ReproducedBlock> blocks;
  std::vector<ReproducedNumber> numbers;
  std::vector<ReproducedImage> images;
  double wall = 0;  // that it took [s]
};

struct ReproduceOptions {
  std::filesystem::path scenarios = "scenarios";  // folder of the project's scenarios
  std::filesystem::path folder = "reproduction";  // where the files go
  std::string only;                               // name of the one experiment; empty: all
  int seeds = 17;  // runs of each kind on the circle, as many as the paper had people; at least 2
  std::string program_version;
  std::function<void(double share, const std::string& what)> progress = {};
};

// Names of the experiments, in their order.
std::vector<std::string> ReproducibleExperiments();

struct Reproduction {
  std::vector<ReproducedExperiment> experiments;
  std::string machine;  // processor's model
  std::string program_version;
};

// Runs them and leaves `folder` with what the runs need. Throws InputError: an unknown name, a
// scenario that is not there, a folder that cannot be written; std::runtime_error if a run ended
// otherwise than its experiment does.
Reproduction Reproduce(const ReproduceOptions& options);

// index.html, figures as SVG and PNG, numbers.json and numbers.csv. Throws InputError.
void WriteReproduction(const Reproduction& reproduction, const std::filesystem::path& folder);

// The numbers for a person at a terminal.
std::string ReproductionText(const Reproduction& reproduction);
std::string ReproductionJson(const Reproduction& reproduction);
std::string ReproductionCsv(const Reproduction& reproduction);
std::string ReproductionPage(const Reproduction& reproduction);

}  // namespace predictor
