// Output of an assessment as text, JSON, CSV and as a page.
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
// `comparison`: with another design; may be null.
std::string AssessmentJson(const Assessment& a, const Comparison* comparison = nullptr);
// JSON Schema (draft-07) of AssessmentJson.
std::string AssessmentSchema();
// One row for each time of the nominal person, with every quantity and score, and the 90 %
// intervals where they were computed.
std::string AssessmentCsv(const Assessment& a);
std::string AssessmentPage(const Assessment& a, const std::string& program_version);

// The person of a run in a report: the assessment, or a sentence that explains its absence.
struct PersonOfRun {
  std::string name;  // of the run, if the report compares several
  std::optional<Assessment> assessment;
  std::string why;
};
// Adds the chapter "person": for one run everything that AssessmentPage shows, for several runs a
// table.
void AddPersonChapter(std::span<const PersonOfRun> runs, ReportPage* page);

// A value as a number in the unit that is displayed, without the unit.
std::string NumberText(const Unit& unit, double x);
std::string ValueText(const QuantityKind& kind, double x);
// "low … high" in the same unit; empty if there is no interval.
std::string RangeText(const QuantityKind& kind, const std::optional<person::Interval>& range);
// "measured by ...": explains the words for Origin.
std::string OriginWords();
// One sentence for each lift, damage and fatigue result.
std::string Sentence(const Lift& lift);
std::string Sentence(const DamageResult& damage);
std::string Sentence(const FatigueResult& fatigue);
// "The body reaches the handles 98 % of the time ..."
std::string ReachSentence(const Assessment& a);
// States who moved the handles.
std::string OperatorSentence(const Assessment& a);

}  // namespace predictor::assessment
