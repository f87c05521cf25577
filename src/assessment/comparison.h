// The difference between two designs for the same person.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "assessment/assessment.h"
#include "assessment/design_differences.h"

namespace predictor::assessment {

struct Difference {
  const QuantityKind* kind = nullptr;
  double a = 0, b = 0;  // QuantityResult::tail()
  // 90 % interval of a - b over the possible people. The comparison uses the same person in both
  // runs, so most of the uncertainty about the posture cancels.
  std::optional<person::Interval> interval;
  std::optional<double> share_better;  // share of the possible people for whom a is better than b
};

struct Comparison {
  std::string a, b;            // recordings
  std::string name_a, name_b;  // the same without their endings, and different
  std::vector<Difference> differences;
  std::vector<DamageResult> damage_a, damage_b;
  std::vector<std::string> warnings;  // why the runs can hardly be compared
  std::vector<std::string> designs;   // DesignDifferences; filled by AddDesigns
};

// Throws InputError if the bodies differ, because the difference would then not be due to the
// designs alone.
Comparison Compare(const Assessment& a, const Assessment& b);

// Adds what the designs of the two runs differ in. The comparison sets the designs' names.
void AddDesigns(ComparedDesign a, ComparedDesign b, Comparison* comparison);

std::string ComparisonText(const Comparison& comparison);
// Returns a chapter's title such as "light compared with heavy".
std::string ComparisonTitle(const Comparison& comparison);
// Returns the HTML of the chapter: warnings, and a table in which each difference is drawn.
std::string ComparisonHtml(const Comparison& comparison);

}  // namespace predictor::assessment
