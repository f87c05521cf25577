#include <algorithm>
#include <cmath>

#include "assessment/joint_quantities.h"
#include "assessment/output.h"
#include "assessment/safety/output.h"
#include "core/format.h"
#include "core/person_state.h"
#include "core/text.h"
#include "core/text_table.h"
#include "core/units.h"

namespace predictor::assessment {
namespace {

void AppendQuantities(const Assessment& a, std::string* text) {
  AppendLine(text, "%-36s %8s %8s %8s %8s  %-17s %s", "", "mean", "p5", "p95", "worst",
             "tail (90 %)", "origin");
  std::string group;
  for (const QuantityResult& q : a.quantities) {
    const QuantityKind& kind = *q.kind;
    if (!kind.has_row()) continue;
    if (group != kind.group) AppendLine(text, "%s", kind.group);
    group = kind.group;
    const std::string name = WithUnit(std::string("  ") + kind.label, kind.unit);
    AppendLine(text, "%-36s %8s %8s %8s %8s  %-17s %s", name.c_str(),
               ValueText(kind, q.mean).c_str(), ValueText(kind, q.p5).c_str(),
               ValueText(kind, q.p95).c_str(), ValueText(kind, q.worst()).c_str(),
               RangeText(kind, q.tail_interval).c_str(), Name(kind.origin, a.simulated()));
  }
}

void AppendJoints(const Assessment& a, std::string* text) {
  const auto rows = JointTable(a);
  if (rows.size() < 2) return;
  AppendLine(text, "\nJoints of the arms (modelled)");
  std::vector<std::size_t> widths(rows[0].size(), 0);
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i)
      widths[i] = std::max(widths[i], CharactersIn(row[i]));
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += "  " + LeftAligned(row[i], widths[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    AppendLine(text, "%s", line.c_str());
  }
  AppendLine(text, "%s", JointTableWords().c_str());
}

struct LikelyScores {
  std::size_t probable = 0, low = 0, high = 0;  // the most probable score, and the 90 % range
};

// Needs probabilities. Score 0 stands for an unknown posture.
LikelyScores LikelyOf(const WorksheetResult& w) {
  double total = 0;
  for (std::size_t score = 1; score < w.probability.size(); ++score) total += w.probability[score];
  LikelyScores likely;
  double below = 0;
  for (std::size_t score = 1; score < w.probability.size(); ++score) {
    const double p = w.probability[score];
    if (p > (likely.probable == 0 ? 0 : w.probability[likely.probable])) likely.probable = score;
    if (below <= 0.05 * total && below + p > 0.05 * total) likely.low = score;
    if (below < 0.95 * total && below + p >= 0.95 * total) likely.high = score;
    below += p;
  }
  return likely;
}

void AppendWorksheets(const Assessment& a, std::string* text) {
  AppendLine(text, "\nScores (standard)");
  for (const WorksheetResult& w : a.worksheets) {
    AppendLine(text, "  %s", Sentence(w).c_str());
    std::string shares = "    score: share of time in the nominal posture";
    if (!w.probability.empty()) shares += " (probability over the possible postures)";
    const char* before = "; ";
    for (std::size_t score = 1; score < w.share.size(); ++score) {
      const double likely = w.probability.empty() ? 0 : w.probability[score];
      if (w.share[score] < 0.005 && likely < 0.005) continue;
      Append(&shares, "%s%zu: %.0f %%", before, score, 100 * w.share[score]);
      if (!w.probability.empty()) Append(&shares, " (%.0f %%)", 100 * likely);
      before = ", ";
    }
    AppendLine(text, "%s", shares.c_str());
  }
}

template <class T>
void AppendSentences(const char* title, const std::vector<T>& list, std::string* text) {
  if (list.empty()) return;
  AppendLine(text, "\n%s", title);
  for (const T& entry : list) AppendLine(text, "  %s", Sentence(entry).c_str());
}

// Returns a sentence that begins with a space, or "" if the moment of the lift is not known.
std::string DamageWords(const Lift& lift) {
  if (!lift.moment) return "";
  const std::string beyond = lift.outside_lifft()
                                 ? Formatted(", beyond the range of the method, which is %.0f N·m",
                                             ergonomics::kLargestLiftMoment)
                                 : "";
  return Formatted(" This %s uses %.3g %% of a reference day (LiFFT, largest moment %.0f N·m%s).",
                   lift.lowered ? "lowering" : "lift", 100 * *lift.day_share, *lift.moment,
                   beyond.c_str());
}

std::string Index(double index) {
  return std::isfinite(index) ? Formatted("%.2f", index) : "outside the equation's range";
}

}  // namespace

std::string RangeText(const QuantityKind& kind, const std::optional<person::Interval>& range) {
  if (!range) return "";
  return ValueText(kind, range->low) + " … " + ValueText(kind, range->high);
}

std::string OriginWords(bool simulated) {
  return std::string(simulated
                         ? "Simulated sensor: by the simulated sensors of simulated hands or arms"
                         : "Measured: by the sensors of the arms") +
         "; modelled: by the model of the body; standard: by a published method, from the other "
         "values";
}

std::string NumberText(const Unit& unit, double x) {
  if (!std::isfinite(x)) return "–";
  return Fixed(unit.factor * x, unit.decimals);
}

std::string ValueText(const QuantityKind& kind, double x) { return NumberText(kind.unit, x); }

std::string OperatorSentence(const Assessment& a) {
  const std::string who =
      a.participant ? " (" + Printable(ParticipantWords(*a.participant)) + ")." : ".";
  if (a.operator_type == "virtual") return "The operator was simulated" + who;
  if (a.operator_type == "browser") return "A mouse or a headset's hands moved the handles" + who;
  return "A person held the handles" + who;
}

std::string ReachSentence(const Assessment& a) {
  std::string text = Formatted(
      "A hand held a handle for %.1f of %.1f s. Only this time is judged. The body reaches the "
      "handles for %.0f %% of this time",
      a.held, a.duration, 100 * a.reached);
  if (a.worst_miss > 5e-4) Append(&text, " and misses them by up to %.0f mm", 1e3 * a.worst_miss);
  if (!a.sampled_times.empty())
    Append(&text, "; over all possible postures, for %.0f %%", 100 * a.sampled_reached);
  return text + ".";
}

std::string RangeWords(const DamageResult& damage) {
  return damage.outside() ? Formatted(
                                ", extrapolated: the largest load is %.0f %% of the largest "
                                "load for which the method is valid",
                                100 * damage.load_over_range)
                          : "";
}

std::string Sentence(const Lift& lift) {
  const char* const move = lift.lowered ? "lowered" : "lifted";
  const std::string where =
      Formatted("%.1f to %.1f s, %s from %.2f to %.2f m above the ground", lift.begin, lift.end,
                move, lift.origin.height, lift.destination.height);
  if (lift.one_hand)
    return where + ", with one hand: the lifting equations apply only to two hands." +
           DamageWords(lift);
  std::string text =
      where + Formatted(": the hands carry %.1f kg. ", lift.vertical_force / kStandardGravity);
  if (!lift.lowered)
    Append(&text, "Lifting index %s (%s), %s without the cobot. ",
           Index(lift.niosh.carried.index).c_str(), ergonomics::AssistedLift::kCarriedLabel,
           Index(lift.niosh.unassisted.index).c_str());
  if (lift.acceptable.outside)
    Append(&text,
           "This %s is outside the range of LM-MMH, which therefore gives no share of people who "
           "accept it.",
           lift.lowered ? "lowering" : "lift");
  else
    Append(&text,
           "%s this load for a day is acceptable to %.0f %% of people of the operator's sex "
           "(LM-MMH).",
           lift.lowered ? "Lowering" : "Lifting", 100 * lift.share_that_accepts);
  return text + DamageWords(lift);
}

std::string Sentence(const LiftingJob& job) {
  return Formatted(
      "%zu lifts in %.2f min as one job with several tasks: composite lifting index %s (%s), %s "
      "without the cobot.",
      job.lifts, job.minutes, Index(job.carried).c_str(), ergonomics::AssistedLift::kCarriedLabel,
      Index(job.unassisted).c_str());
}

std::string Sentence(const DamageResult& damage) {
  return Formatted(
      "%s, %s: one run causes %.3g %% of the damage of a reference day, a shift of such runs %.3g "
      "%%%s.",
      damage.tool.c_str(), damage.part.c_str(), 100 * damage.day_share, 100 * damage.shift_share,
      RangeWords(damage).c_str());
}

std::string MinutesText(double seconds) {
  return seconds < 8 * 3600 ? Formatted("%.0f min", seconds / 60) : "more than 8 h";
}

std::string Sentence(const WorksheetResult& w) {
  const std::string nominal = Formatted(
      "In the nominal posture: %d at worst, at most %d for 95 %% of the time.", w.worst, w.p95);
  if (w.probability.empty() || LikelyOf(w).probable == 0)
    return std::string(w.kind->name) + ": " + nominal +
           " The possible postures were not evaluated, so no advice follows.";
  const LikelyScores likely = LikelyOf(w);
  const auto advice = [&](std::size_t score) { return w.kind->action(static_cast<int>(score)); };
  std::string text =
      Formatted("%s: probably %zu (90 %%: %zu to %zu). %s", w.kind->name, likely.probable,
                likely.low, likely.high, advice(likely.probable).sentence);
  if (advice(likely.high).level != advice(likely.probable).level)
    Append(&text, " With a score of %zu: %s", likely.high, advice(likely.high).sentence);
  return text + " " + nominal;
}

std::string Sentence(const FatigueResult& fatigue) {
  const FatigueCourse& course = fatigue.compartments;
  std::string text =
      Formatted("%s: %.1f %% of strength on average, %.1f %% of strength left (3CC-r).",
                fatigue.joint.c_str(), 100 * fatigue.mean_load, 100 * course.capacity);
  if (std::isfinite(course.time_to_limit))
    Append(&text,
           " If the run is repeated without a break, it becomes too demanding after %.0f min.",
           course.time_to_limit / 60);
  else
    text += " The run can be repeated without a break for 8 h.";
  const auto add = [&](const char* model, const FatigueCourse& other) {
    Append(&text, " %s: %.1f %% of strength left, too demanding after %s.", model,
           100 * other.capacity, MinutesText(other.time_to_limit).c_str());
  };
  add(kMaModel, fatigue.ma);
  if (fatigue.trial) add(kTrialModel, *fatigue.trial);
  return text + Formatted(" %s: %s.", kEnduranceModel, MinutesText(fatigue.endurance).c_str());
}

std::string AssessmentText(const Assessment& a) {
  std::string text;
  AppendLine(&text, "%s", Printable(a.scenario).c_str());
  AppendLine(&text, "%s %s", OperatorSentence(a).c_str(), ReachSentence(a).c_str());
  for (const std::string& line : a.warnings) AppendLine(&text, "Warning: %s", line.c_str());
  AppendLine(&text, "%s.", OriginWords(a.simulated()).c_str());
  AppendSentences("Measured in addition to the hands", a.measured.parts, &text);
  AppendSentences("Measured signals", a.measured.signals, &text);
  AppendSentences("Measured muscles (electromyograms)", a.measured.emg.channels, &text);
  AppendSentences("Clocks", a.measured.tracks, &text);
  if (!a.measured.tracks.empty()) text += '\n';
  text +=
      "The columns p5 and p95 contain percentiles over time for the nominal posture. The column "
      "Tail contains the 90 % interval of p95 (of p5 for balance) over 64 possible postures and "
      "bodies.\n\n";
  AppendQuantities(a, &text);
  AppendLine(&text, "%s", kCompressionCaveat);
  AppendJoints(a, &text);
  AppendWorksheets(a, &text);
  AppendSentences("Limits of your files (standard)", a.limits, &text);
  AppendSentences("Lifts and lowerings (standard)", a.lifts, &text);
  if (a.job) AppendLine(&text, "  %s", Sentence(*a.job).c_str());
  AppendSentences("Cumulative damage (standard)", a.damage, &text);
  AppendSentences("Fatigue (modelled)", a.fatigue, &text);
  AppendSentences("Hand activity, ACGIH (standard)", a.hand_activity, &text);
  if (a.safety) text += SafetyText(*a.safety);
  AppendLine(&text, "\nAssumptions");
  for (const std::string& line : a.assumptions) AppendLine(&text, "  %s", line.c_str());
  AppendLine(&text, "Not evaluable");
  for (const NotEvaluable& n : a.not_evaluable)
    AppendLine(&text, "  %s: %s.", n.what.c_str(), n.why.c_str());
  return text;
}

}  // namespace predictor::assessment
