#include "assessment/comparison.h"

#include "core/error.h"
#include "core/format.h"

namespace predictor::assessment {
namespace {

bool SameBody(const BodySpec& a, const BodySpec& b) {
  return a.height == b.height && a.mass == b.mass && a.sex == b.sex;
}

Difference DifferenceOf(const QuantityResult& a, const QuantityResult& b) {
  Difference result;
  result.kind = a.kind;
  result.a = a.p95;
  result.b = b.p95;
  if (a.person_p95.empty() || a.person_p95.size() != b.person_p95.size()) return result;
  std::vector<double> differences;
  const auto n = static_cast<double>(a.person_p95.size());
  for (std::size_t i = 0; i < a.person_p95.size(); ++i) {
    differences.push_back(a.person_p95[i] - b.person_p95[i]);
    result.share_lower += differences.back() < 0 ? 1 / n : 0;
  }
  result.interval = person::IntervalOf(differences);
  return result;
}

}  // namespace

Comparison Compare(const Assessment& a, const Assessment& b) {
  if (!SameBody(a.setup.body, b.setup.body))
    throw InputError(b.recording,
                     "The operator's body differs from that of " + a.recording +
                         ". Give both the same one, for example --set operator.body.height=1.75.");
  Comparison comparison = {a.recording, b.recording, {}};
  for (std::size_t i = 0; i < a.quantities.size(); ++i)
    comparison.differences.push_back(DifferenceOf(a.quantities[i], b.quantities[i]));
  return comparison;
}

std::string ComparisonText(const Comparison& comparison) {
  std::string text;
  AppendLine(&text, "\n%s against %s: 95th percentiles of the same person", comparison.a.c_str(),
             comparison.b.c_str());
  AppendLine(&text, "%-52s %8s %8s  %-19s %s", "", "this", "other", "difference (90 %)",
             "lower for");
  for (const Difference& d : comparison.differences) {
    const Unit& unit = d.kind->unit;
    const auto value = [&](double x) { return Formatted("%.*f", unit.decimals, unit.factor * x); };
    const std::string name = WithUnit(std::string(d.kind->group) + ", " + d.kind->label, unit);
    std::string line =
        Formatted("%-52s %8s %8s", name.c_str(), value(d.a).c_str(), value(d.b).c_str());
    if (d.interval)
      Append(&line, "  %-19s %3.0f %%",
             (value(d.interval->low) + " … " + value(d.interval->high)).c_str(),
             100 * d.share_lower);
    AppendLine(&text, "%s", line.c_str());
  }
  text +=
      "\"Lower for\": the share of 64 possible postures and bodies for which this recording has "
      "the lower value.\n";
  return text;
}

}  // namespace predictor::assessment
