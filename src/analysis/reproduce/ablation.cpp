// Shows the effect of each repair of the paper's formulation. In three tasks, the repairs are added
// one after the other to the paper's equations, and removed one by one from our equations.
#include <cmath>

#include "analysis/reproduce/runs.h"
#include "core/text.h"
#include "core/units.h"
#include "report/page.h"
#include "scenario/formulation.h"

namespace predictor {
namespace {

// The study adds these repairs one by one in this order, and then adds the remaining repairs
// together.
constexpr Repair kInTurn[] = {Repair::kPredictedJacobian, Repair::kRelativeTarget, Repair::kLead,
                              Repair::kSoftRows, Repair::kCoupling};
// With these overrides, the loop has the rate and the computing time of the paper's loop.
const std::vector<std::string> kPaperLoop = {"rate=" + std::to_string(kAssumedPaperRate),
                                             "rig.computation_delay=0.01"};
constexpr const char* kWithoutMonitor = "safety.oscillation.enabled=false";

struct Task {
  const char* scenario;
  const char* name;
  std::vector<std::string> set = {};
};

// Returns the paper's tasks and two additional tasks in which rarely used repairs act: one with
// arms that are almost stretched, and one with motions that exceed the cap on the handles' speed.
std::vector<Task> Tasks() {
  return {
      {"box_9kg", "9 kg"},
      {"box_18kg", "18 kg"},
      {"bar_circle", "bar"},
      {"box_9kg",
       "9 kg, stretched arms",
       {"device.arms.left.base.xyz=[-0.13, -0.22, -0.35]",
        "device.arms.right.base.xyz=[-0.13, 0.22, -0.35]"}},
      {"box_9kg",
       "9 kg, fast",
       {"duration=10",
        "operator.script=[{action: grip, start: 0, duration: 0.5}, "
        "{action: move, start: 1, duration: 1, by: [0, 0.3, 0]}, "
        "{action: move, start: 3, duration: 1, by: [0, -0.3, 0]}, "
        "{action: rotate, start: 5, duration: 1.2, rotate_by: [0, 0, 0.9]}, "
        "{action: rotate, start: 7, duration: 1.2, rotate_by: [0, 0, -0.9]}]"}},
  };
}

struct Step {
  std::string name;
  std::vector<std::string> set;
};

std::string NameOf(Repair repair) { return RepairTable()[static_cast<std::size_t>(repair)].name; }

Step PaperStep(const std::string& name, const std::vector<std::string>& added) {
  Step step{name, kPaperLoop};
  step.set.emplace_back("rendering.formulation=paper");
  if (!added.empty())
    step.set.push_back("rendering.formulation_except=[" + Join(added, ", ") + "]");
  return step;
}

std::vector<Step> AddedInTurn() {
  std::vector<Step> steps = {PaperStep("the paper's formulation", {})};
  std::vector<std::string> added;
  for (const Repair repair : kInTurn) {
    added.push_back(NameOf(repair));
    steps.push_back(PaperStep("and " + added.back(), added));
  }
  steps.push_back({"and all other repairs", kPaperLoop});
  steps.push_back({"and 1 kHz: our defaults", {}});
  return steps;
}

std::vector<Step> RemovedFromOurs() {
  std::vector<Step> steps;
  for (const RepairEntry& entry : RepairTable())
    steps.push_back({std::string("without ") + entry.name,
                     {std::string("rendering.formulation_except=[") + entry.name + "]"}});
  return steps;
}

// The runs of one step in one task. These runs have no oscillation monitor unless stated otherwise.
struct StepRuns {
  ReproducedRun run;
  std::optional<ReproducedRun> monitored;  // if the monitor stopped it
  std::optional<ReproducedRun> compared;   // run up to the earliest stop of all steps
};

std::optional<StopSummary> StopOf(const ReproducedRun& run) {
  if (run.data.stops.empty()) return {};
  return run.data.stops.front().summary;
}

ReproducedSetting SettingOf(const Task& task, const Step& step) {
  ReproducedSetting setting{task.scenario, task.set, step.name};
  setting.set.insert(setting.set.end(), step.set.begin(), step.set.end());
  return setting;
}

StepRuns RunStep(const Task& task, const Step& step, ReproduceRuns* runs) {
  ReproducedSetting setting = SettingOf(task, step);
  StepRuns result;
  ReproducedRun monitored = runs->RunToEitherEnd(setting);
  const std::optional<StopSummary> stop = StopOf(monitored);
  if (!stop || stop->cause != StopCause::kOscillation) {
    // The monitor can only stop a run. Because the monitor did not stop this run, the run without
    // the monitor would be the same.
    result.run = std::move(monitored);
    return result;
  }
  result.monitored = std::move(monitored);
  setting.set.emplace_back(kWithoutMonitor);
  result.run = runs->RunToEitherEnd(setting);
  return result;
}

// Returns the time of the earliest stop, rounded down to 0.1 s, or the duration of the whole run if
// no run stops [s].
std::optional<double> EarliestStop(const std::vector<StepRuns>& all) {
  std::optional<double> earliest;
  for (const StepRuns& step : all)
    if (const std::optional<StopSummary> stop = StopOf(step.run))
      earliest = std::min(earliest.value_or(stop->time), stop->time);
  if (earliest) earliest = std::max(0.1, std::floor(10 * *earliest - 1e-9) / 10);
  return earliest;
}

void RunToEarliestStop(const Task& task, const std::vector<Step>& steps, double until,
                       ReproduceRuns* runs, std::vector<StepRuns>* all) {
  for (std::size_t k = 0; k < steps.size(); ++k) {
    ReproducedSetting setting = SettingOf(task, steps[k]);
    setting.set.emplace_back(kWithoutMonitor);
    setting.set.push_back("duration=" + FormatNumber(until));
    (*all)[k].compared = runs->RunToEitherEnd(setting);
  }
}

constexpr const char* kErrors[] = {"tracking.left.translation_m", "tracking.relative.distance_m",
                                   "tracking.relative.right_from_left_m"};

std::string StopText(const ReproducedRun& run) {
  const std::optional<StopSummary> stop = StopOf(run);
  if (!stop) return "none";
  return std::string(Name(stop->cause)) + " at " + Significant(stop->time, 3) + " s";
}

// Adds numbers for tables that have a row per step and a column per quantity of a task.
void AddNumbers(const Task& task, const Step& step, const StepRuns& ran,
                std::optional<double> until, std::vector<ReproducedNumber>* numbers) {
  const auto add = [&](ReproducedNumber n, const std::string& column) {
    n.place = "(3) to (15)";
    n.quantity = step.name;
    n.condition = std::string(task.name) + ", " + column;
    n.variant = true;
    numbers->push_back(std::move(n));
  };
  const auto errors = [&](const ReproducedRun& run, const std::string& when) {
    for (const char* path : kErrors) {
      const ReproducedNumber n = NumberOfMetric(run, path);
      add(n, n.quantity + when);
    }
  };
  const auto stopped = [&](const ReproducedRun& run, const std::string& how) {
    if (const std::optional<StopSummary> stop = StopOf(run))
      add(NumberOf(run, "", stop->time, "s"), std::string("stop by ") + Name(stop->cause) + how);
  };
  errors(ran.run, "");
  const auto failed = static_cast<double>(ran.run.data.summary.Get<std::uint64_t>("qp.failed"));
  add(NumberOf(ran.run, "", failed, ""), "QPs without a solution");
  stopped(ran.run, "");
  if (ran.monitored) stopped(*ran.monitored, ", with our monitor");
  if (ran.compared) errors(*ran.compared, ", first " + FormatNumber(*until) + " s");
}

std::string ErrorCell(const ReproducedRun& run, const char* path) {
  const ReproducedNumber n = NumberOfMetric(run, path);
  return PlusMinus(n.mean, n.deviation) + " (" + Significant(n.largest, 2) + ")";
}

std::string TaskTable(const std::vector<Step>& steps, const std::vector<StepRuns>& all,
                      std::size_t from, std::size_t to, std::optional<double> until) {
  std::vector<std::vector<std::string>> table = {
      {"Formulation", "left handle [mm]", "distance between the handles [mm]",
       "right handle seen from the left [mm]", "QPs without a solution", "Stop",
       "Stop with our monitor"}};
  if (until) {
    const std::string when = ", first " + FormatNumber(*until) + " s [mm]";
    table[0].push_back("left handle" + when);
    table[0].push_back("right handle seen from the left" + when);
  }
  for (std::size_t k = from; k < to; ++k) {
    const StepRuns& step = all[k];
    std::vector<std::string> line = {EscapeMarkup(steps[k].name)};
    for (const char* path : kErrors) line.push_back(ErrorCell(step.run, path));
    line.push_back(std::to_string(step.run.data.summary.Get<std::uint64_t>("qp.failed")));
    line.push_back(StopText(step.run));
    line.push_back(step.monitored ? StopText(*step.monitored) : "the same");
    if (step.compared) {
      line.push_back(ErrorCell(*step.compared, kErrors[0]));
      line.push_back(ErrorCell(*step.compared, kErrors[2]));
    }
    table.push_back(std::move(line));
  }
  return HtmlTable(table);
}

void AddTask(const Task& task, ReproduceRuns* runs, ReproducedExperiment* e) {
  std::vector<Step> steps = AddedInTurn();
  const std::size_t added = steps.size();
  for (Step& step : RemovedFromOurs()) steps.push_back(std::move(step));
  std::vector<StepRuns> all;
  for (const Step& step : steps) all.push_back(RunStep(task, step, runs));
  const std::optional<double> until = EarliestStop(all);
  if (until) RunToEarliestStop(task, steps, *until, runs, &all);
  for (std::size_t k = 0; k < steps.size(); ++k)
    AddNumbers(task, steps[k], all[k], until, &e->numbers);
  e->Add("<h3>" + std::string(task.name) + ": repairs added in turn</h3>\n" +
         TaskTable(steps, all, 0, added, until));
  e->Add("<h4>" + std::string(task.name) + ": repairs removed one by one from ours</h4>\n" +
         TaskTable(steps, all, added, steps.size(), until));
}

std::string RepairsTable() {
  std::vector<std::vector<std::string>> table = {{"Repair", "Equations", "Ours", "The paper's"}};
  for (const RepairEntry& entry : RepairTable())
    table.push_back({std::string("<code>") + entry.name + "</code>", entry.equations,
                     EscapeMarkup(entry.ours), EscapeMarkup(entry.papers)});
  return HtmlTable(table);
}

}  // namespace

ReproducedExperiment ReproduceAblation(ReproduceRuns* runs) {
  ReproducedExperiment e;
  e.AddParagraph(
      "The paper's equations (3) to (15) as printed, in a loop of 100 Hz with 10 ms of computing "
      "time and without coupling; then each repair added in turn; then our defaults with each "
      "repair removed. Mean ± standard deviation (largest) while all hands grip, up to the end or "
      "the stop of a run without our oscillation monitor. To compare like with like, the last two "
      "columns end at the earliest stop of all rows. Without a solution, the last command is "
      "slowed down; three such ticks in a row stop the run.");
  e.Add(RepairsTable());
  for (const Task& task : Tasks()) AddTask(task, runs, &e);
  return e;
}

}  // namespace predictor
