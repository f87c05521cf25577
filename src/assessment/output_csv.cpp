#include <cmath>
#include <cstddef>

#include "assessment/output.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor::assessment {
namespace {

// Appends a column's name, for example ",trunk.flexion_rad.low [rad]".
void AppendHead(const QuantityKind& kind, const char* part, std::string* text) {
  Append(text, ",%s%s", kind.path, part);
  if (*kind.unit.si != 0) Append(text, " [%s]", kind.unit.si);
}

std::string HeadOf(const Assessment& a) {
  std::string text = "time [s]";
  for (const QuantityResult& q : a.quantities) {
    AppendHead(*q.kind, "", &text);
    if (q.low.empty()) continue;
    AppendHead(*q.kind, ".low", &text);
    AppendHead(*q.kind, ".high", &text);
  }
  for (const WorksheetResult& w : a.worksheets) Append(&text, ",%s", w.kind->name);
  for (const HandActivity& activity : a.hand_activity)
    for (const char* part : {"exerts", "activity_level", "activity_ratio"})
      Append(&text, ",hands.%s.%s", HandName(activity.hand), part);
  for (const MeasuredSignal& signal : a.measured.signals)
    text += "," + CsvCell("measured." + signal.name +
                          (signal.unit.empty() ? "" : " [" + signal.unit + "]"));
  for (const MeasuredEmg& emg : a.measured.emg.channels)
    text += ",measured.muscles." + PathOf(emg) + ",modelled.muscles." + PathOf(emg);
  if (a.participant) text += ",pseudonym";
  return text + '\n';
}

}  // namespace

std::string AssessmentCsv(const Assessment& a) {
  std::string text = HeadOf(a);
  std::size_t k = 0;  // index of the next of sampled_times
  for (std::size_t i = 0; i < a.times.size(); ++i) {
    const bool sampled = k < a.sampled_times.size() && a.sampled_times[k] == a.times[i];
    Append(&text, "%.3f", a.times[i]);
    for (const QuantityResult& q : a.quantities) {
      text += ',';
      if (std::isfinite(q.values[i])) Append(&text, "%.6g", q.values[i]);
      if (q.low.empty()) continue;
      for (const std::vector<double>* end : {&q.low, &q.high}) {
        text += ',';
        if (sampled && std::isfinite((*end)[k])) Append(&text, "%.6g", (*end)[k]);
      }
    }
    for (const WorksheetResult& w : a.worksheets)
      text += w.values[i] > 0 ? Formatted(",%d", w.values[i]) : ",";
    for (const HandActivity& activity : a.hand_activity) {
      Append(&text, ",%d,%.6g,", activity.exerts[i] ? 1 : 0, activity.level);
      if (std::isfinite(activity.ratio)) Append(&text, "%.6g", activity.ratio);
    }
    for (const MeasuredSignal& signal : a.measured.signals)
      text += std::isfinite(signal.values[i]) ? Formatted(",%.9g", signal.values[i]) : ",";
    for (const MeasuredEmg& emg : a.measured.emg.channels)
      for (const double value : {emg.measured[i], emg.modelled[i]})
        text += std::isfinite(value) ? Formatted(",%.6g", value) : ",";
    if (a.participant) text += "," + CsvCell(a.participant->pseudonym);
    text += '\n';
    k += sampled ? 1 : 0;
  }
  return text;
}

std::string LiftingJobCsv(std::span<const RecordedLifts> recordings) {
  const LiftingJob job = JobOf(recordings);
  const auto number = [](double x) { return std::isfinite(x) ? Formatted("%.6g", x) : ""; };
  std::string text =
      "recording,pseudonym,begin_s,end_s,lowered,one_hand,from_m,to_m,vertical_force_n,"
      "lifft_share_of_reference_day,job_lifts,job_duration_min,"
      "job_adapted_composite_lifting_index,job_unassisted_composite_lifting_index\n";
  for (const RecordedLifts& r : recordings)
    for (const Lift& lift : r.lifts)
      text +=
          Join({CsvCell(r.recording), CsvCell(r.pseudonym), number(lift.begin), number(lift.end),
                lift.lowered ? "1" : "0", lift.one_hand ? "1" : "0", number(lift.origin.height),
                number(lift.destination.height), number(lift.vertical_force),
                number(lift.day_share.value_or(NAN)), std::to_string(job.lifts),
                number(job.minutes), number(job.lifts > 1 ? job.carried : NAN),
                number(job.lifts > 1 ? job.unassisted : NAN)},
               ",") +
          "\n";
  return text;
}

}  // namespace predictor::assessment
