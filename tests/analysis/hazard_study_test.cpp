// Tests two parts of the hazard study. One part is the file of finished runs, and the other part is
// the tables that are computed from the runs.
#include "analysis/hazard_study/hazard_study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "analysis/hazard_study/run_store.h"
#include "analysis/scenarios.h"
#include "core/error.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

std::string ContentOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void Overwrite(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << text;
}

// ---- the file of finished runs ------------------------------------------------------------------

HazardRun RunOf(std::uint64_t seed) {
  HazardRun run;
  run.seed = seed;
  run.begin = 2.125;
  run.before = 10.5;
  run.after = 31.25 + static_cast<double>(seed);
  run.torque = 1.5;
  run.speed = 0.25;
  run.until_stop = 0.375;
  run.cause = StopCause::kForce;
  run.detection = 0.002;
  run.excess = 0.125;
  run.clear_detection = 0.001;
  run.commanded = 0.75;
  run.travel = 0.0625;
  run.cobot_stop = CobotStop::kJointTorque;
  return run;
}

HazardCell CellOf(const std::string& scenario) {
  HazardCell cell;
  cell.scenario = scenario;
  cell.controller = "admittance";
  cell.hazard = "brakes_close";
  return cell;
}

void ExpectSame(const HazardRun& a, const HazardRun& b) {
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.begin, b.begin);
  EXPECT_EQ(a.before, b.before);
  EXPECT_EQ(a.after, b.after);
  EXPECT_EQ(a.torque, b.torque);
  EXPECT_EQ(a.speed, b.speed);
  EXPECT_EQ(a.until_stop, b.until_stop);
  EXPECT_EQ(a.cause, b.cause);
  EXPECT_EQ(a.detection, b.detection);
  EXPECT_EQ(a.excess, b.excess);
  EXPECT_EQ(a.clear_detection, b.clear_detection);
  EXPECT_EQ(a.commanded, b.commanded);
  EXPECT_EQ(a.travel, b.travel);
  EXPECT_EQ(a.cobot_stop, b.cobot_stop);
}

bool Has(const fs::path& file, const std::string& key, const HazardRun& run) {
  HazardRun found;
  if (!HazardRunStore(file).Find(key, run.seed, &found)) return false;
  ExpectSame(found, run);
  return true;
}

class RunsFile : public testing::Test {
 protected:
  void Add(const std::string& key, const HazardCell& cell, const HazardRun& run) {
    HazardRunStore(file_).Add(key, cell, run);
  }
  const test::TemporaryFolder folder_;
  const fs::path file_ = folder_ / "runs.csv";
};

TEST_F(RunsFile, ReturnsARunOfTheSameCellAndSeedOnly) {
  Add("a1", CellOf("box"), RunOf(1));
  Add("a1", CellOf("box"), RunOf(2));
  HazardRun calm;  // all values that are missing
  calm.seed = 3;
  Add("b2", CellOf("box"), calm);
  EXPECT_TRUE(Has(file_, "a1", RunOf(1)));
  EXPECT_TRUE(Has(file_, "a1", RunOf(2)));
  EXPECT_TRUE(Has(file_, "b2", calm));
  EXPECT_FALSE(Has(file_, "b2", RunOf(1)));
  EXPECT_FALSE(Has(file_, "a1", RunOf(3)));
  EXPECT_FALSE(Has(file_, "a", RunOf(1)));
}

// A reader of the file may rely on its header, which must appear once.
TEST_F(RunsFile, HasOneHeaderWithANameForEachColumn) {
  Add("a1", CellOf("box"), RunOf(1));
  Add("a1", CellOf("box"), RunOf(2));
  std::istringstream lines(ContentOf(file_));
  std::string header, line;
  std::getline(lines, header);
  EXPECT_EQ(header.find("key,scenario,controller,hazard,seed,"), 0u) << header;
  int count = 0;
  for (; std::getline(lines, line); ++count)
    EXPECT_EQ(std::ranges::count(line, ','), std::ranges::count(header, ',')) << line;
  EXPECT_EQ(count, 2);
}

TEST_F(RunsFile, FindsARunWhoseScenarioHasACommaInItsName) {
  for (const char* name : {"box, heavy", "box \"heavy\"", "=box", "a,b,c"}) {
    fs::remove(file_);
    Add("a1", CellOf(name), RunOf(1));
    EXPECT_TRUE(Has(file_, "a1", RunOf(1))) << name;
  }
}

// A killed study leaves a file that may end anywhere in its last line.
TEST_F(RunsFile, ContinuesAfterAnInterruptionAtAnyPlaceInALine) {
  Add("a1", CellOf("box"), RunOf(1));
  const std::string before = ContentOf(file_);
  Add("a1", CellOf("box"), RunOf(2));
  const std::string whole = ContentOf(file_);
  ASSERT_GT(whole.size(), before.size() + 50);
  for (std::size_t size = before.size(); size < whole.size(); ++size) {
    Overwrite(file_, whole.substr(0, size));
    for (int start = 0; start < 2; ++start) {  // the second study may be interrupted as well
      EXPECT_TRUE(Has(file_, "a1", RunOf(1))) << size;
      HazardRun found;
      EXPECT_FALSE(HazardRunStore(file_).Find("a1", 2, &found)) << size;
    }
    Add("a1", CellOf("box"), RunOf(3));
    Add("a1", CellOf("box"), RunOf(2));
    for (const std::uint64_t seed : {1, 2, 3}) EXPECT_TRUE(Has(file_, "a1", RunOf(seed))) << size;
    EXPECT_EQ(std::ranges::count(ContentOf(file_), '\n'), 4) << size;
  }
}

TEST_F(RunsFile, GetsItsHeaderAgainIfThatWasInterrupted) {
  Add("a1", CellOf("box"), RunOf(1));
  const std::string whole = ContentOf(file_);
  for (const std::size_t size : {0, 1, 20}) {
    Overwrite(file_, whole.substr(0, size));
    Add("a1", CellOf("box"), RunOf(1));
    EXPECT_EQ(ContentOf(file_), whole) << size;
  }
}

TEST_F(RunsFile, SkipsLinesThatItCannotRead) {
  Add("a1", CellOf("box"), RunOf(1));
  const std::string text = ContentOf(file_);
  const std::string line = text.substr(text.find('\n') + 1);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = line;
    changed.replace(changed.find(from), from.size(), to);
    return changed;
  };
  for (const std::string& bad : {with("10.5", "ten"), with("force", "no_such_cause"),
                                 with("10.5", ""), std::string(",\n"), std::string("\n")}) {
    Overwrite(file_, text.substr(0, text.find('\n') + 1) + bad);
    EXPECT_FALSE(Has(file_, "a1", RunOf(1))) << bad;
    Overwrite(file_, text + bad);
    EXPECT_TRUE(Has(file_, "a1", RunOf(1))) << bad;
  }
}

TEST_F(RunsFile, ThatCannotBeWrittenIsRefused) {
  try {
    const HazardRunStore store(folder_.path());
    FAIL() << "a folder was accepted as a file";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("could not be written"), std::string::npos);
  }
}

// ---- tables -------------------------------------------------------------------------------------

// Splits a line of a CSV table (RFC 4180).
std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

// Returns the row of the study's only cell, by the name of the column.
std::map<std::string, std::string> RowOf(const HazardCell& cell) {
  std::istringstream lines(HazardStudyCsv({{cell}, 0}));
  std::string header, line;
  std::getline(lines, header);
  std::getline(lines, line);
  const std::vector<std::string> names = Cells(header), cells = Cells(line);
  EXPECT_EQ(names.size(), cells.size()) << line;
  std::map<std::string, std::string> row;
  for (std::size_t k = 0; k < std::min(names.size(), cells.size()); ++k) row[names[k]] = cells[k];
  return row;
}

HazardRun Felt(double force, StopCause cause = StopCause::kNone) {
  HazardRun run;
  run.begin = 2;
  run.before = 8;
  run.after = force;
  run.cause = cause;
  if (cause == StopCause::kNone) return run;
  run.until_stop = 0.4;
  run.travel = 0.01;
  return run;
}

// Three forces are 10, 20 and 30 N. Two others are only known to be at least 25 and 40 N. The
// product-limit estimate was calculated by hand. A force exceeds 10 N with the probability 4/5, it
// exceeds 20 N with the probability 4/5 · 3/4 = 3/5, and it exceeds 30 N with the probability 3/5 ·
// 1/2 = 3/10. The median is therefore 30 N (the median of the five numbers alone would be 25 N).
// The estimated distribution does not reach 95 %. The bound is then the quantile of the five
// numbers, 30 + 0.8 · 10 N.
HazardCell CensoredCell() {
  HazardCell cell = CellOf("box");
  cell.speed_cap = 0.5;
  cell.travel_budget = 0.05;
  cell.runs = {Felt(30), Felt(25, StopCause::kOscillation), Felt(10), Felt(40, StopCause::kForce),
               Felt(20)};
  cell.runs[0].cobot_stop = CobotStop::kSpeed;  // the person would have felt it too: no bound
  HazardRun calm = Felt(90);                    // its hazard did not begin
  calm.begin = -1;
  cell.runs.push_back(calm);
  return cell;
}

TEST(HazardTable, TreatsForcesOfStoppedRunsAsBounds) {
  auto row = RowOf(CensoredCell());
  EXPECT_EQ(row["runs"], "6");
  EXPECT_EQ(row["begun"], "5");
  EXPECT_EQ(row["stopped"], "2");
  EXPECT_EQ(row["causes"], "force 20 %, oscillation 20 %");
  EXPECT_EQ(row["cobot_stops"], "speed 20 %");
  EXPECT_EQ(row["force_after_median_N"], "30");
  EXPECT_EQ(row["force_after_median_is_bound"], "0");
  EXPECT_EQ(row["force_after_p95_N"], "38");
  EXPECT_EQ(row["force_after_p95_is_bound"], "1");
  EXPECT_EQ(row["force_after_max_N"], "40");
  EXPECT_EQ(row["force_before_p95_N"], "8");
  EXPECT_EQ(row["until_stop_median_s"], "0.4");
  EXPECT_EQ(row["travel_max_m"], "0.01");
  EXPECT_EQ(row["detection_max_s"], "");  // no stop has one
}

TEST(HazardTable, WithoutStopsHasNoBounds) {
  HazardCell cell = CensoredCell();
  for (HazardRun& run : cell.runs) run.cause = StopCause::kNone;
  auto row = RowOf(cell);
  EXPECT_EQ(row["force_after_median_N"], "25");
  EXPECT_EQ(row["force_after_median_is_bound"], "0");
  EXPECT_EQ(row["force_after_p95_N"], "38");
  EXPECT_EQ(row["force_after_p95_is_bound"], "0");
}

TEST(HazardTable, StatesTheReasonForAnImpossibleCell) {
  HazardCell cell = CellOf("box, heavy");
  cell.impossible = "events[0], \"takeover\", needs a standby controller.";
  auto row = RowOf(cell);
  EXPECT_EQ(row["scenario"], "box, heavy");
  EXPECT_EQ(row["impossible"], "events[0], takeover, needs a standby controller.");  // no quotes
  EXPECT_EQ(row["runs"], "0");
  EXPECT_EQ(row["force_after_median_N"], "");
}

TEST(HazardTable, StatesEachCellInWords) {
  HazardStudy study;
  study.cells.push_back(CensoredCell());
  HazardCell calm = CellOf("box");
  calm.controller = "load_sharing";
  calm.runs = {Felt(12), Felt(12)};
  study.cells.push_back(calm);
  const char* const kImpossible[][2] = {{"The event would have no effect on it.", "no effect"},
                                        {"The event needs a sensor.", "impossible"},
                                        {"", "did not begin"}};
  for (const auto& [why, words] : kImpossible) {
    HazardCell cell = CellOf("box");
    cell.hazard = words;
    cell.impossible = why;
    study.cells.push_back(cell);
  }
  const std::string text = HazardStudyTables(study);
  for (const char* words :
       {"| box | admittance | load_sharing |\n| --- | --- | --- |\n| brakes_close | force 20 %, "
        "oscillation 20 % after 0.40 s; the cobot itself: speed 20 %; at least 38.0 N (8.0 N "
        "before) | no stop; 12.0 N (8.0 N before) |\n",
        "| no effect | no effect |\n", "| impossible | impossible |\n",
        "| did not begin | did not begin |\n"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
}

TEST(HazardTable, StatesWhetherTheRequirementsHold) {
  HazardCell cell = CensoredCell();
  cell.runs[3].detection = 0.003;
  cell.runs[3].excess = 0.5;
  cell.runs[3].clear_detection = 0.003;
  HazardRun noisy = Felt(31, StopCause::kForce);  // noise hides the crossing for a while
  noisy.detection = 0.004;
  noisy.excess = 0.1;
  noisy.travel = 0.02;
  noisy.speed = 0.503;
  noisy.commanded = 1;
  cell.runs.push_back(noisy);
  const std::string kept = HazardStudyWords({{cell}, 4});
  for (const char* words :
       {"7 runs (4 from an earlier study); the hazard began in 6; 3 stopped.",
        "2 of 2 force stops were decided within 3 ms", "all within 3 ms.",
        "In 2 of these runs, the true force itself had crossed the threshold, at "
        "most 4 ms earlier and by at most 0.50 N",
        "used 40 % of its travel budget",
        "used 100.0 % of its cap. The measured speed of a handle reached "
        "100.6 % of the cap."})
    EXPECT_NE(kept.find(words), std::string::npos) << words << "\n" << kept;

  cell.runs.back().clear_detection = 0.004;
  const std::string late = HazardStudyWords({{cell}, 4});
  EXPECT_NE(late.find("1 of 2 force stops were decided within 3 ms"), std::string::npos) << late;
  EXPECT_NE(late.find("all within 4 ms."), std::string::npos) << late;
}

// ---- a whole study ------------------------------------------------------------------------------

// The second study must reuse the runs in the first study's complete lines, and both studies must
// have the same results.
TEST(HazardStudyFiles, AnInterruptedStudyIsContinued) {
  const test::TemporaryFolder folder;
  HazardStudyOptions options;
  options.scenarios = {kScenarios / "box_9kg.yaml"};
  options.folder = folder / "hazards";
  options.seeds = 1;
  options.duration = 0.02;
  const HazardStudy first = MakeHazardStudy(options);
  EXPECT_EQ(first.kept, 0);
  EXPECT_EQ(first.cells.size(), StudiedControllers().size() * StudiedHazards().size());
  EXPECT_EQ(first.cells.front().controller, "cartesian_impedance");  // the scenario's own
  const fs::path runs = options.folder / "runs.csv";
  const std::string table = ContentOf(options.folder / "hazards.csv"),
                    words = ContentOf(options.folder / "hazards.md"), whole = ContentOf(runs);
  EXPECT_EQ(table, HazardStudyCsv(first));
  EXPECT_EQ(words, HazardStudyTables(first));
  const auto lines = std::ranges::count(whole, '\n') - 1;  // without the header
  EXPECT_GT(lines, 30);
  const std::size_t cut = whole.find('\n', whole.size() / 2) + 20;  // in the middle of a line
  ASSERT_LT(cut, whole.size());
  Overwrite(runs, whole.substr(0, cut));
  const auto kept = std::ranges::count(whole.substr(0, cut), '\n') - 1;
  ASSERT_GT(kept, 0);
  ASSERT_LT(kept, lines);
  const HazardStudy second = MakeHazardStudy(options);
  EXPECT_EQ(second.kept, kept);
  EXPECT_EQ(ContentOf(options.folder / "hazards.csv"), table);
  EXPECT_EQ(ContentOf(options.folder / "hazards.md"), words);
  EXPECT_EQ(std::ranges::count(ContentOf(runs), '\n') - 1, lines);
}

}  // namespace
}  // namespace predictor
