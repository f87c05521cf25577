// Reproduces section 4.2: the circle with the bar, the comparison of real and emulated runs, and
// Fig. 12.

#include "analysis/identify/loop.h"
#include "analysis/reproduce/runs.h"
#include "core/error.h"
#include "core/text.h"
#include "report/page.h"
#include "report/run_plots.h"

namespace predictor {
namespace {

constexpr double kLoopShare = 0.9;  // share of the experiment's time
constexpr const char* kCommand = "predictor reproduce --only circle";

std::string Agreed(const Agreement& a, double scale) {
  return PlusMinus(scale * a.rmse, scale * a.rmse_deviation) + " (" +
         Significant(a.correlation, 3) + ")";
}

// Formats the probability p of the test that distinguishes emulated from real runs.
std::string DistinguishingP(const SameKindTest& test) {
  if (!test.can_distinguish()) return "too few runs";
  return test.p < 1e-3 ? "< 0.001" : Significant(test.p, 2);
}

std::string AgreementTable(const IdentifyLoopResult& loop) {
  std::vector<std::vector<std::string>> rows = {{"RMSE (correlation)", "Range", "Two real runs",
                                                 "Nominal friction", "Identified friction",
                                                 "p, before", "p, after"}};
  for (const AxisAgreement& a : loop.axes) {
    const double scale = a.unit == "m" ? 1e3 : 1;
    const std::string unit = a.unit == "m" ? "mm" : a.unit;
    rows.push_back({EscapeMarkup(a.name) + " [" + unit + "]", Significant(scale * a.range, 3),
                    Agreed(a.repeat, scale), Agreed(a.before, scale), Agreed(a.after, scale),
                    DistinguishingP(a.same_before), DistinguishingP(a.same_after)});
  }
  return HtmlTable(rows);
}

std::string FrictionTable(const IdentifyLoopResult& loop) {
  std::vector<std::vector<std::string>> rows = {{"Joint friction", "True, viscous", "Nominal",
                                                 "Identified (95 %)", "True, Coulomb", "Nominal",
                                                 "Identified (95 %)"}};
  const auto estimate = [](const Estimate& e) {
    return Significant(e.value, 3) + " ± " + Significant(e.half_width, 2);
  };
  for (std::size_t j = 0; j < loop.identification.joints.size(); ++j) {
    const JointIdentification& joint = loop.identification.joints[j];
    const int i = static_cast<int>(j);
    const bool known = joint.identified();
    rows.push_back({EscapeMarkup(joint.name), Significant(loop.real.viscous[j], 3),
                    Round(OneOrEach(loop.nominal.viscous, i)),
                    known ? estimate(joint.viscous) : "not identified",
                    Significant(loop.real.coulomb[j], 3), Round(OneOrEach(loop.nominal.coulomb, i)),
                    known ? estimate(joint.coulomb) : "not identified"});
  }
  return HtmlTable(rows);
}

void AddNumbers(const IdentifyLoopResult& loop, std::vector<ReproducedNumber>* numbers) {
  for (const AxisAgreement& a : loop.axes) {
    const bool length = a.unit == "m";
    const auto add = [&](const char* what, const char* condition, double mean, double deviation,
                         const std::string& unit) {
      ReproducedNumber n;
      n.quantity = a.name + ", " + what;
      n.unit = unit;
      n.condition = condition;
      n.mean = mean;
      n.deviation = deviation;
      n.command = kCommand;
      Add(std::move(n), "Fig. 12", numbers);
    };
    const double scale = length ? 1e3 : 1;
    const auto kind = [&](const char* condition, const Agreement& g) {
      add("RMSE", condition, scale * g.rmse, scale * g.rmse_deviation, length ? "mm" : a.unit);
      add("correlation", condition, g.correlation, std::nan(""), "1");
    };
    add("range", "two real runs", scale * a.range, std::nan(""), length ? "mm" : a.unit);
    kind("two real runs", a.repeat);
    kind("nominal friction", a.before);
    kind("identified friction", a.after);
  }
}

// Returns the first run of each kind in the table.
Runs Examples(const IdentifyLoopResult& loop, const Scenario& task, ReproduceRuns* runs,
              std::vector<ReproducedRun>* kept) {
  const std::filesystem::path folder = runs->options().folder / "real_cobot";
  Scenario real = MakeReal(task, loop.real, folder);
  real.seed = loop.first_seed;
  Scenario before = task;
  before.seed = loop.first_seed + static_cast<std::uint64_t>(loop.seeds);
  Scenario after = WithFriction(before, loop.identification);
  const ReproducedSetting setting{"bar_circle", {}, "real"};
  kept->push_back(runs->Run(setting, real, RunEnd::kFinished));
  kept->push_back(runs->Run({"bar_circle", {}, "emulated"}, before, RunEnd::kFinished));
  kept->push_back(runs->Run({"bar_circle", {}, "emulated, identified"}, after, RunEnd::kFinished));
  Runs curves;
  for (const ReproducedRun& run : *kept) curves.emplace_back(run.data);
  return curves;
}

std::string IndistinguishableAxes(const IdentifyLoopResult& loop,
                                  bool (AxisAgreement::*is)() const) {
  std::vector<std::string> names;
  for (const AxisAgreement& a : loop.axes)
    if ((a.*is)()) names.push_back(a.name);
  return names.empty() ? "none" : Join(names);
}

void AddWords(const IdentifyLoopResult& loop, ReproducedExperiment* e) {
  e->AddParagraph(
      "The paper shows the forces of one of 17 people on the real and the emulated cobot. It "
      "states, without numbers, that x and y have very similar oscillatory patterns, that z "
      "differs because a person is free in the vertical direction, and that people felt more "
      "resistance at the real cobot, whose joint damping was probably larger than the assumed 1 "
      "N·m·s. Here, the real cobot is also simulated, in direct mode: the same simulated person "
      "holds the bar on the cobot itself. Its true joint friction, masses (3 %) and centres of "
      "mass (5 mm) differ from its model. Its friction is then identified from one minute of "
      "excitation and used in the emulation. In the real runs, there is no sensor between person "
      "and cobot, so only the forces of the emulated runs contain sensor noise and bias.");
  e->Add("<h3>Friction</h3>\n" + FrictionTable(loop) +
         "<p>Viscous in N·m·s/rad, Coulomb in N·m.</p>\n");
  e->Add("<h3>Agreement</h3>\n" + AgreementTable(loop));
  e->AddParagraph(
      std::to_string(loop.seeds) +
      " runs of each kind, each with its own random noise of the person, aligned by the phase of "
      "the cycle; mean ± standard deviation over the pairs. Two real runs with different noise "
      "also differ. Distinguishable (p below 0.05) means: the mean RMSE between a real and an "
      "emulated run, minus that between two runs of one kind, is among the largest 5 % of the "
      "values obtained when whole runs are randomly assigned to the two kinds (energy distance, "
      "permutation test). Each axis is tested separately. “Not distinguishable” does not prove "
      "similarity; it only means that these runs show no difference. Not distinguishable before "
      "identification: " +
      IndistinguishableAxes(loop, &AxisAgreement::indistinguishable_before) +
      "; after: " + IndistinguishableAxes(loop, &AxisAgreement::indistinguishable_after) + ".");
}

}  // namespace

ReproducedExperiment ReproduceCircle(ReproduceRuns* runs) {
  ReproducedExperiment e;
  const Scenario excitation = runs->Load({"excite_cobot", {}, ""});
  const Scenario task = runs->Load({"bar_circle", {}, ""});
  const std::filesystem::path folder = runs->options().folder / "real_cobot";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw InputError(folder.string(), "The folder could not be created: " + error.message());
  IdentifyLoopOptions how;
  how.seeds = runs->options().seeds;
  how.folder = folder;
  how.progress = [&](double share) { runs->ReportProgress(kLoopShare * share); };
  const IdentifyLoopResult loop = IdentifyLoop(excitation, task, how);
  AddNumbers(loop, &e.numbers);
  AddWords(loop, &e);
  std::vector<ReproducedRun> kept;
  const Runs curves = Examples(loop, task, runs, &kept);
  e.Add(ForceAxesPlot(curves), "fig12-forces",
        "Forces of both hands by axis over four cycles (Fig. 12)",
        "The curves show one run of each kind over time. Like different people, the runs differ in "
        "pace, so the curves drift apart. The table therefore compares the runs by the phase of "
        "the cycle. The axes are the axes of the world frame. The circle lies in the plane of x "
        "and y, and z points up.");
  std::vector<Plot> paths = PathPlots(curves);
  e.Add(std::move(paths.front()), "fig12-path",
        "The path of the bar from above, and the circle to follow",
        "The curves have a point every 50 ms. The two axes of the plot have the same scale.");
  return e;
}

}  // namespace predictor
