#include "numbers_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace predictor {
namespace {

using Row = std::map<std::string, std::string>;

// Splits a line of CSV into its cells. A quoted cell may contain commas and doubled quotes.
std::vector<std::string> CellsOf(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      cells.back() += line[++i];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += line[i];
  }
  return cells;
}

// Maps the name of each number in the experiment to its row.
std::map<std::string, Row> RowsOf(const std::string& experiment) {
  std::ifstream file(PREDICTOR_SOURCE_DIR "/docs/numbers.csv");
  std::string line;
  EXPECT_TRUE(std::getline(file, line)) << "docs/numbers.csv";
  const std::vector<std::string> names = CellsOf(line);
  std::map<std::string, Row> rows;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = CellsOf(line);
    Row row;
    for (std::size_t i = 0; i < names.size() && i < cells.size(); ++i) row[names[i]] = cells[i];
    if (row["experiment"] == experiment)
      rows[row["condition"] + " | " + row["quantity"] + " [" + row["unit"] + "]"] = row;
  }
  return rows;
}

// Returns whether the number comes from an unstable loop. The unstable loops are the paper's loop,
// and the paper's loop at 100 Hz with some of our changes.
bool IsUnstable(const std::string& experiment, const ReproducedNumber& n) {
  const auto starts = [](const std::string& text, const char* with) {
    return text.rfind(with, 0) == 0;
  };
  if (experiment == "ablation")
    return !starts(n.quantity, "without") && !starts(n.quantity, "and 1 kHz");
  return starts(n.condition, "the paper's conditions") || starts(n.condition, "at ");
}

void Expect(const std::string& written, double now, double tolerance, const std::string& what) {
  if (written.empty() || !std::isfinite(now)) {
    EXPECT_EQ(written.empty(), !std::isfinite(now)) << what;
    return;
  }
  EXPECT_NEAR(std::stod(written), now, tolerance * std::abs(now)) << what;
}

}  // namespace

double MeanInNumbersFile(const std::string& experiment, const ReproducedNumber& n) {
  const std::map<std::string, Row> rows = RowsOf(experiment);
  const auto found = rows.find(n.condition + " | " + n.quantity + " [" + n.unit + "]");
  return found == rows.end() ? std::nan("") : std::stod(found->second.at("mean"));
}

void ExpectAsInNumbersFile(const ReproducedExperiment& experiment) {
  SCOPED_TRACE(
      "docs/numbers.csv is not what the program computes now. If that is intended: predictor "
      "reproduce, copy its numbers.csv there, tests/documents/figures.py . --update");
  const std::map<std::string, Row> rows = RowsOf(experiment.name);
  EXPECT_EQ(rows.size(), experiment.numbers.size());
  for (const ReproducedNumber& n : experiment.numbers) {
    const std::string key = n.condition + " | " + n.quantity + " [" + n.unit + "]";
    const auto found = rows.find(key);
    if (found == rows.end()) {
      ADD_FAILURE() << "The file lacks " << key;
      continue;
    }
    Row row = found->second;
    const bool unstable = IsUnstable(experiment.name, n);
    const double stable = n.unit == "ms" ? 0.1 : 0.02;
    Expect(row["mean"], n.mean, unstable ? 0.15 : stable, key + ", mean");
    Expect(row["deviation"], n.deviation, unstable ? 0.15 : 0.02, key + ", deviation");
    Expect(row["largest"], n.largest, unstable ? 0.4 : 0.2, key + ", largest");
    EXPECT_EQ(row["command"], n.command);
  }
}

}  // namespace predictor
