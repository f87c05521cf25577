// Reproduces scenarios 1 and 2 (Figs 5 to 8), and the demonstration in Fig. 4.

#include "analysis/reproduce/paper.h"
#include "analysis/reproduce/runs.h"
#include "core/text.h"
#include "core/units.h"
#include "report/page.h"
#include "report/run_plots.h"

namespace predictor {
namespace {

// The paper prints twelve error values, six per scenario. `paper` is null if the paper does not
// print the values.
struct ErrorFigures {
  const PaperTracking* paper;
  const char* translation;  // place of the translational errors in the paper
  const char* rotation;
};

// If a safety stop ended a run early, its value is not divided by the paper's value.
void AddErrorsOf(const std::string& phase, const std::string& when, const ErrorFigures& figures,
                 const ReproducedRun& run, std::vector<ReproducedNumber>* numbers) {
  const PaperTracking* paper = run.end == RunEnd::kFinished ? figures.paper : nullptr;
  const auto add = [&](const char* key, std::optional<PrintedValue> printed) {
    ReproducedNumber n = NumberOfMetric(run, phase + key);
    n.quantity += when;
    if (paper != nullptr) n.paper = printed;
    const bool translation = n.unit == units::kMillimetre.shown;
    Add(std::move(n), translation ? figures.translation : figures.rotation, numbers);
  };
  const PaperTracking none = {}, &printed = paper != nullptr ? *paper : none;
  add("left.translation_m", printed.translation[0]);
  add("right.translation_m", printed.translation[1]);
  add("left.rotation_rad", printed.rotation[0]);
  add("right.rotation_rad", printed.rotation[1]);
  add("relative.distance_m", printed.distance);
  add("relative.right_from_left_m", {});
  add("relative.angle_rad", printed.angle);
}

void AddGripping(const ErrorFigures& figures, const ReproducedRun& run,
                 std::vector<ReproducedNumber>* numbers) {
  AddErrorsOf("tracking.", "", figures, run, numbers);
}

void AddWholeRun(const ErrorFigures& figures, const ReproducedRun& run,
                 std::vector<ReproducedNumber>* numbers) {
  AddErrorsOf("tracking.whole_run.", ", whole run", figures, run, numbers);
}

// Adds the time of the stop and the error that caused it. For a run without a stop, the function
// adds nothing.
void AddStop(const ErrorFigures& figures, const ReproducedRun& run,
             std::vector<ReproducedNumber>* numbers) {
  if (run.data.stops.empty()) return;
  const StopSummary& stop = run.data.stops.front().summary;
  const auto add = [&](const std::string& quantity, double value, const char* unit) {
    Add(NumberOf(run, quantity, value, unit), figures.translation, numbers);
  };
  add("time of the safety stop", stop.time, "s");
  const std::string quantity = std::string("value that caused the stop, ") + Name(stop.cause);
  if (stop.quantity == Quantity::kLength) add(quantity, kMillimetres * stop.value, "mm");
  if (stop.quantity == Quantity::kAngle) add(quantity, kDegrees * stop.value, "°");
  if (stop.quantity == Quantity::kForce) add(quantity, stop.value, "N");
}

// Fig. 8 contains no numbers, so our forces are compared with the thresholds.
void AddForces(const ReproducedRun& run, std::vector<ReproducedNumber>* numbers) {
  const auto add = [&](ReproducedNumber n) { Add(std::move(n), "Fig. 8", numbers); };
  for (const std::string hand : kHandNames) {
    add(NumberOfMetric(run, "wrench." + hand + ".force_n", hand + " hand, force"));
    add(NumberOfMetric(run, "wrench." + hand + ".torque_nm", hand + " hand, torque"));
  }
  add(NumberOf(run, "smallest distance of the elbows",
               run.data.summary.Get<double>("link_distance_m.min"), "m"));
}

std::string PictureHtml(const ReproducedImage& image, const std::string& words) {
  return "<figure id=\"" + EscapeMarkup(image.id) + "\"><img alt=\"" + EscapeMarkup(words) +
         "\" style=\"width:100%;height:auto;border-radius:8px\" src=\"data:image/png;base64," +
         Base64(image.bytes) + "\"><figcaption>" + EscapeMarkup(words) + "</figcaption></figure>\n";
}

void AddSnapshots(const ReproducedRun& run, const std::string& prefix, const char* figure,
                  const std::vector<double>& moments, ReproducedExperiment* experiment) {
  experiment->images = ReproduceSnapshots(run, prefix);
  std::string html =
      "<h3>Snapshots (" + std::string(figure) +
      ")</h3>\n"
      "<p>The virtual cobot with the box, and the two haptic arms (pale) at their places. The arms "
      "do not collide with the virtual box, so the box can hide a hand in the picture. Arrows: "
      "forces of the hands, 1 cm per newton; orange above half the threshold, red above 80 %. "
      "Drawn from the collision shapes of the models.</p>\n"
      "<div style=\"display:grid;grid-template-columns:repeat(auto-fit,minmax(290px,1fr));gap:0 "
      "12px\">\n";
  constexpr const char* kPanels[] = {"A, D", "B, E", "C, F"};
  for (std::size_t i = 0; i < experiment->images.size(); ++i)
    html += PictureHtml(experiment->images[i],
                        Round(moments[i]) + " s (" + figure + " " + kPanels[i % 3] + ")");
  experiment->Add(html + "</div>\n");
}

struct BoxExperiment {
  const char* name;
  ErrorFigures errors;
  const char* snapshots;
  std::vector<double> moments;
};

// Adds the errors from the release until the end of the next grip.
void AddRelease(const ErrorFigures& figures, const ReproducedRun& run,
                std::vector<ReproducedNumber>* numbers) {
  const auto add = [&](const char* quantity, const Statistics& values) {
    Add(NumberOf(run, quantity, values, kMillimetres, "mm"), figures.translation, numbers);
  };
  if (run.released_error.count() == 0) return;
  add("left handle, released", run.released_error);
  add("distance between the handles, released", run.released_distance);
}

void AddReleaseTable(const ErrorFigures& figures, const ReproducedRun& papers,
                     const ReproducedRun& ours, ReproducedExperiment* e) {
  std::vector<ReproducedNumber> table;
  AddRelease(figures, papers, &table);
  AddRelease(figures, ours, &table);
  if (table.empty()) return;
  e->Add("<h4>The release</h4>\n" + NumbersTable(table));
  e->AddParagraph(
      "This table covers the time from the 18th second until both hands have gripped again. In "
      "this period, the paper's curves show a spike of the absolute errors, while the relative "
      "pose remains accurate (Figs 7A and B).");
  e->Add(table);
}

// Performs runs at half and at twice the assumed rate, to show the effect of this assumption.
void AddRates(const BoxExperiment& box, const ReproducedRun& assumed, ReproduceRuns* runs,
              ReproducedExperiment* e) {
  const auto name = [](int rate) { return "at " + std::to_string(rate) + " Hz"; };
  std::vector<ReproducedNumber> table, others;
  const auto other = [&](int rate) {
    const ReproducedRun run = runs->RunToEitherEnd({box.name, PaperConditions(rate), name(rate)});
    for (std::vector<ReproducedNumber>* numbers : {&table, &others}) {
      AddGripping(box.errors, run, numbers);
      AddStop(box.errors, run, numbers);
    }
  };
  other(kAssumedPaperRate / 2);
  AddGripping(box.errors, assumed, &table);
  other(2 * kAssumedPaperRate);
  for (ReproducedNumber& n : others) n.variant = true;
  for (ReproducedNumber& n : table)
    if (n.condition == kPapers) n.condition = name(kAssumedPaperRate) + ", as above";
  e->Add("<h4>The paper's task at other assumed rates</h4>\n" + NumbersTable(table));
  e->Add(others);
}

// The runs of a task under the three conditions.
struct ConditionRuns {
  ReproducedRun papers, uncoupled, ours;
};

ConditionRuns RunConditions(const char* scenario, const std::vector<double>& moments,
                            ReproduceRuns* runs) {
  ConditionRuns result;
  result.papers = runs->RunToEitherEnd({scenario, PaperConditions(), kPapers});
  result.uncoupled =
      runs->RunToEitherEnd({scenario, PaperConditionsWithoutCoupling(), kPapersUncoupled});
  result.ours = runs->Run({scenario, {}, kOurs, moments});
  return result;
}

void AddTracking(const ErrorFigures& figures, const ConditionRuns& task, ReproducedExperiment* e) {
  std::vector<ReproducedNumber> gripping, whole;
  for (const ReproducedRun* run : {&task.papers, &task.uncoupled, &task.ours}) {
    AddGripping(figures, *run, &gripping);
    AddStop(figures, *run, &gripping);
    AddWholeRun(figures, *run, &whole);
  }
  e->Add("<h3>Tracking errors while all hands grip</h3>\n" + NumbersTable(gripping) +
         "<h3>Tracking errors over the whole run</h3>\n" + NumbersTable(whole));
  e->AddParagraph(
      "Mean ± standard deviation (largest). The paper's values (section 4.1.1) apply to the whole "
      "run, including a release. The paper's conditions: 10 ms of computing time, no lag "
      "compensation and no oscillation monitor. The rate is assumed to be 100 Hz (1/10 ms of "
      "computing time), because the paper does not state it. Our coupling pulls the virtual "
      "handles back when the real ones lag by 4 mm or 2.9°. The paper has no such coupling, so the "
      "task is run with and without it. A run that ends with a safety stop is evaluated up to the "
      "stop and has no ratio. Arms and person are always simulated, and the person's motion is "
      "estimated from the paper's figures: a ratio compares the software, not a robot.");
  for (const auto* numbers : {&gripping, &whole}) e->Add(*numbers);
}

void AddTrackingPlots(const ConditionRuns& task, const std::string& id, ReproducedExperiment* e) {
  const auto add = [&](const ReproducedRun& run, const char* suffix, const char* when) {
    e->Add(TrackingPlot({RunCurves(run.data)}), id + suffix,
           std::string("Tracking errors ") + when + " (Fig. 7)");
  };
  add(task.papers, "-paper", "under the paper's conditions, with our coupling");
  add(task.uncoupled, "-uncoupled", "under the paper's conditions, without our coupling");
  add(task.ours, "-ours", "with our defaults");
}

ReproducedExperiment ReproduceBox(const BoxExperiment& box, ReproduceRuns* runs) {
  ReproducedExperiment e;
  const ConditionRuns task = RunConditions(box.name, box.moments, runs);
  AddTracking(box.errors, task, &e);
  AddRates(box, task.papers, runs, &e);
  AddReleaseTable(box.errors, task.papers, task.ours, &e);
  AddTrackingPlots(task, std::string("fig7-") + box.name, &e);
  std::vector<ReproducedNumber> forces;
  AddForces(task.ours, &forces);
  e.Add("<h3>Safety (Fig. 8)</h3>\n" + NumbersTable(forces));
  e.Add(ForcePlot({RunCurves(task.ours.data)}), std::string("fig8-") + box.name,
        "Forces and torques of the hands, and the distance of the elbows (Fig. 8)",
        "Our defaults. The thresholds are the thresholds of the paper: 30 N, 5 N·m, 0.7 m and 0.3 "
        "m. For scenario 1, the paper prints curves but no numbers.");
  e.Add(forces);
  AddSnapshots(task.ours, std::string("snapshot-") + box.name, box.snapshots, box.moments, &e);
  return e;
}

}  // namespace

ReproducedExperiment ReproduceBox9(ReproduceRuns* runs) {
  return ReproduceBox({"box_9kg",
                       {&kPaperBox9, "Fig. 7A", "Fig. 7B"},
                       "Fig. 5",
                       {kPaperMoments9.begin(), kPaperMoments9.end()}},
                      runs);
}

ReproducedExperiment ReproduceBox18(ReproduceRuns* runs) {
  return ReproduceBox({"box_18kg",
                       {&kPaperBox18, "Fig. 7C", "Fig. 7D"},
                       "Fig. 6",
                       {kPaperMoments18.begin(), kPaperMoments18.end()}},
                      runs);
}

ReproducedExperiment ReproduceBar(ReproduceRuns* runs) {
  ReproducedExperiment e;
  const ConditionRuns task = RunConditions("bar_circle", {}, runs);
  AddTracking({nullptr, "Fig. 10", "Fig. 10"}, task, &e);
  e.AddParagraph(
      "The paper gives no errors for this task. With our defaults, the lead is also 0, because two "
      "hands of 1.5 kg on a bar of 2.1 kg leave no stability margin for a larger lead.");
  return e;
}

ReproducedExperiment ReproduceRelativePose(ReproduceRuns* runs) {
  ReproducedExperiment e;
  const ReproducedRun plain = runs->Run({"box_9kg", {"duration=12"}, "as it is"});
  // The arms are almost stretched, because their bases are too far away.
  const ReproducedRun stretched =
      runs->Run({"box_9kg",
                 {"duration=12", "device.arms.left.base.xyz=[-0.13, -0.22, -0.35]",
                  "device.arms.right.base.xyz=[-0.13, 0.22, -0.35]"},
                 "near a singularity"});
  const ReproducedRun weighted =
      runs->Run({"box_9kg", {"duration=12", "rendering.manipulability=0.003"}, "manipulability"});
  for (const ReproducedRun* run : {&plain, &stretched, &weighted})
    for (const char* path : {"tracking.left.translation_m", "tracking.right.translation_m",
                             "tracking.relative.distance_m", "tracking.relative.right_from_left_m"})
      Add(NumberOfMetric(*run, path), "Fig. 4", &e.numbers);
  e.Add(NumbersTable(e.numbers));
  e.AddParagraph(
      "The paper states, without numbers, that near a singularity or with a higher weight on "
      "manipulability the handles may deviate from their virtual counterparts but not from each "
      "other. The same task is run three times: unchanged; with the arms' bases so far back that "
      "the arms are almost stretched; and with a weight of 0.003 on manipulability. All three runs "
      "use the scenario's stops; none is triggered.");
  Plot plot =
      TrackingPlot({RunCurves(plain.data), RunCurves(stretched.data), RunCurves(weighted.data)});
  e.Add(std::move(plot), "fig4-relative-pose",
        "Absolute and relative errors where tracking suffers (Fig. 4)",
        "The panels show the translation of each handle, the distance between the handles, the "
        "rotation of each handle, and the angle between the handles.");
  return e;
}

}  // namespace predictor
