// Repeats the paper's experiments in virtual time and compares the paper's numbers with ours.
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

// A number as the paper prints it: a mean ± a standard deviation, in the unit of the table's row.
struct PrintedValue {
  double mean = 0, deviation = 0;
  int decimals = 1;  // digits after the decimal point
};

// One quantity: our number and, if the paper prints one, the paper's number.
struct ReproducedNumber {
  std::string place;  // place in the paper: "Fig. 7A"
  std::string quantity, unit;
  std::string condition;  // condition of our result
  std::optional<PrintedValue> paper;
  double mean = 0;
  double deviation = std::numeric_limits<double>::quiet_NaN();  // NaN for a single value
  double largest = std::numeric_limits<double>::quiet_NaN();    // NaN: not available
  std::string command;                                          // command that repeats our result
  bool variant = false;                 // the row tests an assumption and is not included in the
                                        // overview
  std::optional<double> ratio() const;  // our number divided by the paper's
};

// A picture that is not a plot.
struct ReproducedImage {
  std::string id;     // name of its file, without .png
  std::string bytes;  // content of the file
};

// The content of the page about an experiment, in the order of the page. Each block is HTML or a
// plot.
struct ReproducedBlock {
  std::string html;
  std::optional<Plot> plot;
};

struct ReproducedExperiment {
  std::string name, title;  // name: as used by `--only`
  std::vector<ReproducedBlock> blocks;
  std::vector<ReproducedNumber> numbers;
  std::vector<ReproducedImage> images;
  double wall = 0;  // duration of the experiment [s]

  void Add(std::string html) { blocks.push_back({std::move(html), {}}); }
  void AddParagraph(const std::string& text);
  // Adds the plot with another ID, title and caption. If an argument is empty, the plot keeps the
  // current value.
  void Add(Plot plot, const std::string& id, const std::string& heading,
           const std::string& caption = "");
  void Add(const std::vector<ReproducedNumber>& more) {
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
};

struct ReproduceOptions {
  std::filesystem::path scenarios = "scenarios";  // folder of the project's scenarios
  std::filesystem::path folder = "reproduction";  // destination folder
  std::vector<std::string> set;  // changes of all scenarios, as --set of `simulate`
  std::string only;              // name of the only experiment to run; empty: all
  int seeds = 17;  // runs of each kind on the circle, at least 2; the default is the number of the
                   // paper's participants
  std::string program_version;
  std::function<void(double share, const std::string& what)> progress = {};
};

// Returns the names of the experiments, in the order of the page.
std::vector<std::string> ReproducibleExperiments();

struct Reproduction {
  std::vector<ReproducedExperiment> experiments;
  std::string machine;  // processor's model
  std::string engine;   // physics engine of the runs, and its limits of the joints' velocities;
                        // empty if no scenario was found, and thus nothing was simulated
  std::string program_version;
};

// Runs the experiments. Afterwards, `folder` contains the files that the runs need. Throws
// InputError for an unknown name, a missing scenario or a folder that cannot be written, and
// std::runtime_error if a run did not end as its experiment requires.
Reproduction Reproduce(const ReproduceOptions& options);

// Writes the files index.html, numbers.json and numbers.csv, and the figures as SVG and PNG. Throws
// InputError.
void WriteReproduction(const Reproduction& reproduction, const std::filesystem::path& folder);

// Returns the numbers as text for the terminal.
std::string ReproductionText(const Reproduction& reproduction);
std::string ReproductionJson(const Reproduction& reproduction);
std::string ReproductionCsv(const Reproduction& reproduction);
std::string ReproductionPage(const Reproduction& reproduction);

}  // namespace predictor
