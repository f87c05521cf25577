// Shows the effect of those repairs of the paper's formulation that change nothing in the paper's
// tasks. For each of these repairs, a start is constructed in which it acts. Each task runs with
// our formulation, and with the repair removed.
#include <vector>

#include "analysis/reproduce/runs.h"
#include "core/text.h"
#include "report/page.h"
#include "scenario/formulation.h"

namespace predictor {
namespace {

// A task with box_9kg in which repairs act.
struct ConstructedTask {
  const char* name;
  const char* why;  // why the repairs act
  std::vector<std::string> set;
  std::vector<Repair> repairs;
};

std::vector<ConstructedTask> ConstructedTasks() {
  return {
      {"opposite quaternions",
       "The left handle is turned by a full turn (rpy = [0, 0, 2π]). The pose is the same, but the "
       "quaternion of the virtual handle has the opposite sign.",
       {"duration=30", "rig.start_offset=0", "handles.left.rpy=[0, 0, 6.2831853]"},
       {Repair::kNearerHemisphere}},
      {"elbows at d_s",
       "The elbows begin 11 mm above the security distance, and the influence begins 1 mm above "
       "it. The task moves the elbows towards each other.",
       {"duration=8", "rendering.security_distance=0.48", "rendering.influence_distance=0.481",
        "operator.script=[{action: grip, start: 0, duration: 0.5}, "
        "{action: move, start: 1, duration: 2, by: [0.1, 0, 0.05]}, "
        "{action: move, start: 4, duration: 2, by: [-0.1, 0, -0.05]}]"},
       {Repair::kSoftRows, Repair::kDamperEnd, Repair::kApproachParabola}},
      {"fast joints",
       "The hands turn the box so fast that joints need more than 78 % of the vendor's speed. The "
       "caps on the handles' speeds are raised to 1 m/s and 6 rad/s.",
       {"duration=6", "safety.handle_speed=1", "safety.handle_rotation_speed=6",
        "operator.script=[{action: grip, start: 0, duration: 0.5}, "
        "{action: rotate, start: 1, duration: 0.7, rotate_by: [0, 0, 0.9]}, "
        "{action: rotate, start: 3, duration: 0.7, rotate_by: [0, 0, -0.9]}]"},
       {Repair::kSpeedReserve}},
  };
}

constexpr const char* kComparedErrors[] = {"tracking.left.translation_m",
                                           "tracking.relative.right_from_left_m"};

// Runs a task with additional overrides, and adds the numbers and a row of the page's table.
void RunConstructed(const ConstructedTask& task, const std::string& name,
                    const std::vector<std::string>& set, ReproduceRuns* runs,
                    ReproducedExperiment* e, std::vector<std::vector<std::string>>* table) {
  // As in the ablation, the oscillation monitor does not end a run.
  ReproducedSetting setting{"box_9kg", task.set, name};
  setting.set.emplace_back("safety.oscillation.enabled=false");
  setting.set.insert(setting.set.end(), set.begin(), set.end());
  const ReproducedRun run = runs->RunToEitherEnd(setting);
  std::vector<std::string> line = {EscapeMarkup(name)};
  const auto add = [&](ReproducedNumber n, const std::string& condition) {
    n.place = "(3) to (15)";
    n.quantity = std::string(task.name) + ", " + name;
    n.condition = condition;
    n.variant = true;
    e->numbers.push_back(std::move(n));
  };
  for (const char* path : kComparedErrors) {
    const ReproducedNumber n = NumberOfMetric(run, path);
    line.push_back(PlusMinus(n.mean, n.deviation) + " (" + Significant(n.largest, 2) + ")");
    add(n, n.quantity);
  }
  const auto failed = static_cast<double>(run.data.summary.Get<std::uint64_t>("qp.failed"));
  add(NumberOf(run, "", failed, ""), "QPs without a solution");
  line.push_back(FormatNumber(failed));
  if (run.data.stops.empty()) {
    line.emplace_back("none");
  } else {
    const StopSummary& stop = run.data.stops.front().summary;
    add(NumberOf(run, "", stop.time, "s"), std::string("stop by ") + Name(stop.cause));
    line.push_back(std::string(Name(stop.cause)) + " at " + Significant(stop.time, 3) + " s");
  }
  table->push_back(std::move(line));
}

}  // namespace

ReproducedExperiment ReproduceRepairs(ReproduceRuns* runs) {
  ReproducedExperiment e;
  e.AddParagraph(
      "Five repairs change nothing in the tasks of the ablation. Here, each of them acts in a "
      "start that was constructed for it. Mean ± standard deviation (largest) while all hands "
      "grip, without our oscillation monitor.");
  for (const ConstructedTask& task : ConstructedTasks()) {
    std::vector<std::vector<std::string>> table = {{"Formulation", "left handle [mm]",
                                                    "right handle seen from the left [mm]",
                                                    "QPs without a solution", "Stop"}};
    RunConstructed(task, "ours", {}, runs, &e, &table);
    for (const Repair repair : task.repairs) {
      const std::string name = RepairTable()[static_cast<std::size_t>(repair)].name;
      RunConstructed(task, "without " + name, {"rendering.formulation_except=[" + name + "]"}, runs,
                     &e, &table);
    }
    e.Add("<h3>" + std::string(task.name) + "</h3>\n");
    e.AddParagraph(task.why);
    e.Add(HtmlTable(table));
  }
  return e;
}

}  // namespace predictor
