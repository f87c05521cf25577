// Writes an assessment as text, as JSON, as CSV and as a page.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "assessment/assessment.h"
#include "assessment/comparison.h"

namespace predictor {
class ReportPage;
}  // namespace predictor

namespace predictor::assessment {

std::string AssessmentText(const Assessment& a);
// `comparison` is the comparison with another design and may be null.
std::string AssessmentJson(const Assessment& a, const Comparison* comparison = nullptr);
// Returns the JSON Schema (draft-07) of AssessmentJson.
std::string AssessmentSchema();
// Returns one row for each time of the nominal person, with every quantity and score, and the 90 %
// intervals where they were computed.
std::string AssessmentCsv(const Assessment& a);
// With a comparison, its chapter is the first of the page.
std::string AssessmentPage(const Assessment& a, const std::string& program_version,
                           const Comparison* comparison = nullptr);

// The lifts of one of several recordings.
struct RecordedLifts {
  std::string recording;  // file
  std::string pseudonym;  // empty: not known
  double minutes = 0;     // simulated duration of the run
  std::vector<Lift> lifts;
};
// Returns the lifts of several recordings as the job of one person.
LiftingJob JobOf(std::span<const RecordedLifts> recordings);
std::string LiftingJobJson(std::span<const RecordedLifts> recordings);
// Returns the JSON Schema (draft-07) of LiftingJobJson.
std::string LiftingJobSchema();
// Returns one row for each lift and lowering, with the indices of the whole job in each row.
std::string LiftingJobCsv(std::span<const RecordedLifts> recordings);

// The person of a run in a report: the assessment, or a sentence that explains its absence.
struct PersonOfRun {
  std::string name;  // name of the run, if the report compares several
  std::optional<Assessment> assessment;
  std::string why;
};
// Adds the chapter "person". For one run, the chapter contains everything that AssessmentPage
// shows. For several runs, the chapter contains a table.
void AddPersonChapter(std::span<const PersonOfRun> runs, ReportPage* page);

// Returns a value as a number in its display unit, without the name of the unit.
std::string NumberText(const Unit& unit, double x);
std::string ValueText(const QuantityKind& kind, double x);
// Returns an interval as "low … high" in the display unit, or "" if there is no interval.
std::string RangeText(const QuantityKind& kind, const std::optional<person::Interval>& range);
// Returns an explanation of the words for Origin.
std::string OriginWords(bool simulated);
// Returns words that begin with a comma if a load is beyond the range of the tool, and otherwise
// "".
std::string RangeWords(const DamageResult& damage);
// These functions return one sentence for each lift, damage and fatigue result.
std::string Sentence(const Lift& lift);
std::string Sentence(const LiftingJob& job);
std::string Sentence(const DamageResult& damage);
std::string Sentence(const FatigueResult& fatigue);
// Names of the models of fatigue beside 3CC-r.
inline constexpr const char* kMaModel = "Ma's model";
inline constexpr const char* kTrialModel = "Peternel's model with the stated trial";
inline constexpr const char* kEnduranceModel = "Endurance at the mean load, from a measured curve";
// Returns a time such as "12 min", or "more than 8 h".
std::string MinutesText(double seconds);
// Returns the probable score with its 90 % range over the possible postures, what the method
// advises, and the scores of the nominal posture. The nominal posture alone gives no advice,
// because another possible posture often has another score.
std::string Sentence(const WorksheetResult& w);
// Returns a sentence such as "The body reaches the handles 98 % of the time ...".
std::string ReachSentence(const Assessment& a);
// Returns a sentence that states who moved the handles.
std::string OperatorSentence(const Assessment& a);

}  // namespace predictor::assessment
