// An assessment as text, JSON, CSV and as a page.
#pragma once

#include <string>

#include "assessment/assessment.h"
#include "assessment/comparison.h"

namespace predictor::assessment {

std::string AssessmentText(const Assessment& a);
// `comparison`: with another design; null: none.
std::string AssessmentJson(const Assessment& a, const Comparison* comparison = nullptr);
// JSON Schema (draft-07) of AssessmentJson.
std::string AssessmentSchema();
// One row for each time of the nominal person, with every quantity and score; the 90 % intervals
// where they were computed.
std::string AssessmentCsv(const Assessment& a);
std::string AssessmentPage(const Assessment& a, const std::string& program_version);

// A value in the unit that people read.
std::string ValueText(const QuantityKind& kind, double x);
// "measured by ...": what the words of Origin mean.
std::string OriginWords();
// One sentence for each lift, damage and fatigue result.
std::string Sentence(const Lift& lift);
std::string Sentence(const DamageResult& damage);
std::string Sentence(const FatigueResult& fatigue);
// "The body reaches the handles 98 % of the time ..."
std::string ReachSentence(const Assessment& a);
// Who moved the handles.
std::string OperatorSentence(const Assessment& a);

}  // namespace predictor::assessment
