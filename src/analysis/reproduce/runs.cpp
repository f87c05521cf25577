#include "analysis/reproduce/runs.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "emulator/emulator.h"
#include "models/arm_model.h"
#include "report/page.h"
#include "scenario/action_time.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

// Duration of the intervals around stops and worst errors [s]. Every tick in these intervals is
// kept. The size of a page with all ticks would be tens of megabytes.
constexpr double kDetail = 8;

// Finds the intervals in which no hand holds a handle, from a release to the end of the next grip.
class Released {
 public:
  explicit Released(const OperatorSpec& person) {
    for (const ActionSpec& action : person.script) {
      if (action.action == "release") from_ = std::min(from_, action.start);
      if (action.action == "grip" && action.start > from_)
        to_ = std::min(to_, action.start + ActionTime(action));
    }
  }
  bool Contains(double time) const { return time >= from_ && time < to_; }

 private:
  double from_ = std::numeric_limits<double>::infinity();
  double to_ = std::numeric_limits<double>::infinity();
};

Vector3 Place(const PoseRecord& pose) { return {pose.p[0], pose.p[1], pose.p[2]}; }

void AddReleased(const TickRecord& record, ReproducedRun* run) {
  const HandRecord& left = record.hands[0];
  const HandRecord& right = record.hands[1];
  if (left.present == 0 || right.present == 0) return;
  run->released_error.Add((Place(left.real.pose) - Place(left.virtual_.pose)).norm());
  const double real = (Place(right.real.pose) - Place(left.real.pose)).norm();
  const double goal = (Place(right.virtual_.pose) - Place(left.virtual_.pose)).norm();
  run->released_distance.Add(std::abs(real - goal));
}

const char* InWords(RunEnd end) {
  switch (end) {
    case RunEnd::kFinished:
      return "to its end";
    case RunEnd::kStopped:
      return "to a stop";
    case RunEnd::kNotStarted:
      break;
  }
  return "nowhere";
}

std::string Quoted(const std::string& word) {
  return word.find_first_of(" []") == std::string::npos ? word : "'" + word + "'";
}

}  // namespace

std::optional<double> ReproducedNumber::ratio() const {
  if (!paper || paper->mean == 0) return {};
  return mean / paper->mean;
}

std::vector<std::string> PaperConditions(int rate) {
  return {"rate=" + std::to_string(rate), "rig.computation_delay=0.01", "rendering.lead=0",
          "safety.oscillation.enabled=false"};
}

std::vector<std::string> PaperConditionsWithoutCoupling() {
  std::vector<std::string> set = PaperConditions();
  for (const char* key :
       {"stiffness", "damping", "rotation_stiffness", "rotation_damping", "speed_damping"})
    set.push_back("coupling." + std::string(key) + "=0");
  return set;
}

std::string SimulateCommandOf(const ReproducedSetting& setting) {
  std::string command = "predictor simulate scenarios/" + setting.scenario + ".yaml";
  for (const std::string& value : setting.set) command += " --set " + Quoted(value);
  return command;
}

ReproduceRuns::ReproduceRuns(const ReproduceOptions& options, const std::string& experiment,
                             int runs)
    : options_(options), experiment_(experiment), runs_(runs) {}

void ReproduceRuns::ReportProgress(double share) const {
  if (options_.progress) options_.progress(share, experiment_);
}

ReproducedSetting ReproduceRuns::Changed(ReproducedSetting setting) const {
  setting.set.insert(setting.set.end(), options_.set.begin(), options_.set.end());
  return setting;
}

Scenario ReproduceRuns::Load(const ReproducedSetting& setting) const {
  const std::filesystem::path file = options_.scenarios / (setting.scenario + ".yaml");
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError("There is no '" + file.string() +
                     "'. The experiments use the project's folder `scenarios`. Run this command "
                     "next to that folder, or give the folder with --scenarios.");
  return LoadScenario(file, Changed(setting).set);
}

ReproducedRun ReproduceRuns::Run(const ReproducedSetting& setting, RunEnd expected) {
  return Run(setting, Load(setting), expected);
}

ReproducedRun ReproduceRuns::Run(const ReproducedSetting& setting, const Scenario& scenario,
                                 RunEnd expected) {
  ReproducedRun run = RunToAnyEnd(setting, scenario);
  if (run.end != expected)
    throw std::runtime_error("The run `" + run.command + "` was expected to run " +
                             InWords(expected) + ", but it ran " + InWords(run.end) + ".");
  return run;
}

ReproducedRun ReproduceRuns::RunToEitherEnd(const ReproducedSetting& setting) {
  ReproducedRun run = RunToAnyEnd(setting, Load(setting));
  if (run.end == RunEnd::kNotStarted)
    throw std::runtime_error("The run `" + run.command + "` did not start.");
  return run;
}

ReproducedRun ReproduceRuns::RunToAnyEnd(const ReproducedSetting& setting,
                                         const Scenario& scenario) {
  RunInfo info;
  info.name = setting.name;
  info.scenario = scenario;
  info.prismatic = PrismaticJoints(scenario);
  info.program_version = options_.program_version;
  ReadOptions how;
  how.detail = kDetail;
  RunCollector collector(std::move(info), how);
  ReproducedRun run;
  run.command = SimulateCommandOf(Changed(setting));
  const Released released(scenario.operator_);
  Emulator emulator(scenario);
  run.end = Simulate(&emulator, scenario.duration, [&](const TickRecord& record) {
    collector.Add(record);
    if (record.tick % 512 == 0)
      ReportProgress((done_ + std::min(1.0, record.run_time / scenario.duration)) / runs_);
    if (record.ran == 0) return;
    for (std::size_t s = 0; s < kStages; ++s) run.timing[s].Add(record.stage_us[s]);
    if (released.Contains(record.run_time)) AddReleased(record, &run);
    const std::size_t next = run.moments.size();
    if (next < setting.moments.size() && record.run_time >= setting.moments[next])
      run.moments.push_back(record);
  });
  ++done_;
  run.data = collector.Finish();
  return run;
}

// ---- numbers -----------------------------------------------------------------------------------

ReproducedNumber NumberOf(const ReproducedRun& run, const std::string& quantity, double value,
                          const char* unit) {
  ReproducedNumber n;
  n.quantity = quantity;
  n.unit = unit;
  n.condition = run.data.info.name;
  n.mean = value;
  n.command = run.command;
  return n;
}

ReproducedNumber NumberOf(const ReproducedRun& run, const std::string& quantity,
                          const Statistics& values, double scale, const char* unit) {
  ReproducedNumber n = NumberOf(run, quantity, scale * values.mean(), unit);
  n.deviation = scale * values.std();
  n.largest = scale * values.max();
  return n;
}

ReproducedNumber NumberOfMetric(const ReproducedRun& run, const std::string& path,
                                const std::string& quantity) {
  const Result& result = run.data.summary.At(path);
  return NumberOf(run, quantity.empty() ? result.label : quantity,
                  std::get<Statistics>(result.value), result.unit.factor, result.unit.shown);
}

void Add(ReproducedNumber number, const char* place, std::vector<ReproducedNumber>* numbers) {
  number.place = place;
  numbers->push_back(std::move(number));
}

// ---- words -------------------------------------------------------------------------------------

// Returns the number of decimal places at which the smaller of the deviation and the mean shows two
// digits.
static int DecimalsOf(double mean, double deviation) {
  double least = std::abs(mean);
  if (std::isfinite(deviation) && deviation > 0) least = std::min(least, deviation);
  if (!(least > 0)) return 1;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(least))), 0, 4);
}

std::string PlusMinus(double mean, double deviation) {
  const int decimals = DecimalsOf(mean, deviation);
  std::string text = Formatted("%.*f", decimals, mean);
  if (std::isfinite(deviation)) text += " ± " + Formatted("%.*f", decimals, deviation);
  return text;
}

std::string Printed(const PrintedValue& value) {
  return Formatted("%.*f ± %.*f", value.decimals, value.mean, value.decimals, value.deviation);
}

namespace {

// A row of a table, with its name in the first column and a number for each condition.
struct PivotRow {
  std::string name, place;
  std::optional<PrintedValue> paper;
  std::vector<const ReproducedNumber*> cells;  // in the order of the conditions; null: no number
};

std::size_t PlaceIn(const std::string& word, std::vector<std::string>* words) {
  const auto found = std::find(words->begin(), words->end(), word);
  if (found != words->end()) return static_cast<std::size_t>(found - words->begin());
  words->push_back(word);
  return words->size() - 1;
}

std::vector<PivotRow> RowsOf(const std::vector<ReproducedNumber>& numbers,
                             std::vector<std::string>* conditions) {
  std::vector<PivotRow> rows;
  std::vector<std::string> names;
  for (const ReproducedNumber& n : numbers) {
    const std::size_t row = PlaceIn(n.quantity + " [" + n.unit + "]", &names);
    const std::size_t column = PlaceIn(n.condition, conditions);
    if (row == rows.size()) rows.push_back({names.back(), n.place, n.paper, {}});
    if (!rows[row].paper) rows[row].paper = n.paper;
    rows[row].cells.resize(std::max(rows[row].cells.size(), column + 1));
    rows[row].cells[column] = &n;
  }
  for (PivotRow& row : rows) row.cells.resize(conditions->size());
  return rows;
}

std::string OursInWords(const ReproducedNumber& n) {
  if (!std::isfinite(n.deviation) && !n.paper) return Round(n.mean);
  std::string text = PlusMinus(n.mean, n.deviation);
  if (std::isfinite(n.largest)) text += " (" + Significant(n.largest, 2) + ")";
  return text;
}

}  // namespace

std::string NumbersTable(const std::vector<ReproducedNumber>& numbers) {
  std::vector<std::string> conditions;
  const std::vector<PivotRow> rows = RowsOf(numbers, &conditions);
  const bool paper = std::any_of(rows.begin(), rows.end(),
                                 [](const PivotRow& row) { return row.paper.has_value(); });
  std::vector<std::vector<std::string>> table = {{""}};
  if (paper) table[0].emplace_back("Paper");
  for (const std::string& condition : conditions) {
    table[0].push_back(EscapeMarkup(condition));
    if (paper) table[0].emplace_back("Ratio");
  }
  table[0].emplace_back("In the paper");
  for (const PivotRow& row : rows) {
    std::vector<std::string> line = {EscapeMarkup(row.name)};
    if (paper) line.push_back(row.paper ? Printed(*row.paper) : "");
    for (const ReproducedNumber* n : row.cells) {
      line.push_back(n != nullptr ? OursInWords(*n) : "");
      if (paper) line.push_back(n != nullptr && n->ratio() ? Significant(*n->ratio(), 2, 4) : "");
    }
    line.push_back(EscapeMarkup(row.place));
    table.push_back(std::move(line));
  }
  return HtmlTable(table);
}

void ReproducedExperiment::AddParagraph(const std::string& text) {
  Add("<p>" + EscapeMarkup(text) + "</p>\n");
}

void ReproducedExperiment::Add(Plot plot, const std::string& id, const std::string& heading,
                               const std::string& caption) {
  plot.id = id;
  if (!heading.empty()) plot.title = heading;
  if (!caption.empty()) plot.caption = caption;
  plot.group = id;  // each run has its own time axis
  blocks.push_back({"", std::move(plot)});
}

}  // namespace predictor
