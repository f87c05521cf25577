#include "assessment/comparison.h"

#include <algorithm>
#include <cmath>

#include "assessment/output.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor::assessment {
namespace {

bool SameBody(const BodySpec& a, const BodySpec& b) {
  return a.height == b.height && a.mass == b.mass && a.sex == b.sex;
}

Difference DifferenceOf(const QuantityResult& a, const QuantityResult& b) {
  Difference result = {a.kind, a.tail(), b.tail(), {}, {}};
  if (a.person_tail.empty() || a.person_tail.size() != b.person_tail.size()) return result;
  std::vector<double> differences;
  const double sign = a.kind->bad == Bad::kHigh ? 1 : -1;
  double better = 0;
  for (std::size_t i = 0; i < a.person_tail.size(); ++i) {
    const double difference = a.person_tail[i] - b.person_tail[i];
    if (!std::isfinite(difference)) continue;
    differences.push_back(difference);
    better += sign * difference < 0 ? 1 : 0;
  }
  if (2 * differences.size() < a.person_tail.size()) return result;
  result.share_better = better / static_cast<double>(differences.size());
  result.interval = person::IntervalOf(differences);
  return result;
}

// Returns words about the damage that is beyond the range of its tool, or "".
std::string RangeOf(const DamageResult& a, const DamageResult& b) {
  return (a.outside() ? "; this" + RangeWords(a) : "") +
         (b.outside() ? "; other" + RangeWords(b) : "");
}

}  // namespace

Comparison Compare(const Assessment& a, const Assessment& b) {
  if (!SameBody(a.setup.body, b.setup.body))
    throw InputError(
        b.recording,
        "The operator's body differs from that of " + a.recording +
            ". Give both runs the same body, for example with --set operator.body.height=1.75.");
  Comparison comparison = {a.recording, b.recording, {}, a.damage, b.damage, ""};
  for (const QuantityResult& of_a : a.quantities)
    for (const QuantityResult& of_b : b.quantities)
      if (of_a.kind == of_b.kind) comparison.differences.push_back(DifferenceOf(of_a, of_b));
  constexpr double kSameLength = 0.1;
  if (std::abs(a.held - b.held) > kSameLength * std::max(a.held, b.held))
    comparison.warning = Formatted(
        "The hands held the handles for %.1f s in one run and for %.1f s in the other. A run that "
        "ended early looks better than a complete run.",
        a.held, b.held);
  return comparison;
}

std::string ComparisonText(const Comparison& comparison) {
  std::string text;
  AppendLine(&text, "\n%s compared with %s, for the same person", Printable(comparison.a).c_str(),
             Printable(comparison.b).c_str());
  if (!comparison.warning.empty()) AppendLine(&text, "%s", comparison.warning.c_str());
  AppendLine(&text, "%-52s %8s %8s  %-19s %s", "", "this", "other", "difference (90 %)",
             "better for");
  for (const Difference& d : comparison.differences) {
    if (d.kind->of_joint) continue;
    const Unit& unit = d.kind->unit;
    const auto value = [&](double x) { return ValueText(*d.kind, x); };
    const std::string name = WithUnit(std::string(d.kind->group) + ", " + d.kind->label, unit);
    std::string line =
        Formatted("%-52s %8s %8s", name.c_str(), value(d.a).c_str(), value(d.b).c_str());
    if (d.interval)
      Append(&line, "  %-19s %3.0f %%",
             (value(d.interval->low) + " … " + value(d.interval->high)).c_str(),
             100 * *d.share_better);
    AppendLine(&text, "%s", line.c_str());
  }
  for (const DamageResult& a : comparison.damage_a)
    for (const DamageResult& b : comparison.damage_b)
      if (a.tool == b.tool && a.part == b.part)
        AppendLine(&text, "%-52s %8.3g %8.3g%s",
                   (a.tool + ", " + a.part + ", reference day per run [%]").c_str(),
                   100 * a.day_share, 100 * b.day_share, RangeOf(a, b).c_str());
  text +=
      "The values are 95th percentiles over time (5th percentile for balance). The column \"Better "
      "for\" contains the share of 64 possible postures and bodies for which this recording has "
      "the better value. With --json, the comparison also contains the joints of the arms.\n";
  return text;
}

}  // namespace predictor::assessment
