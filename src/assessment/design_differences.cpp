#include "assessment/design_differences.h"

#include <cmath>

#include "core/format.h"
#include "core/text.h"
#include "scenario/differences.h"

namespace predictor::assessment {
namespace {

// Returns a value of a scenario that fits into a line.
std::string Shortened(const std::string& value) {
  constexpr std::size_t kLongest = 60;
  if (value.empty() || value == "[]") return "not set";
  if (value.size() <= kLongest) return Printable(value);
  std::size_t end = kLongest;
  while (end > 0 && (static_cast<unsigned char>(value[end]) & 0xC0U) == 0x80U) --end;
  return Printable(value.substr(0, end)) + " …";
}

std::string DifferenceLine(const std::string& what, const std::string& of_a,
                           const std::string& of_b, const ComparedDesign& a,
                           const ComparedDesign& b) {
  return what + ": " + of_a + " in " + Printable(a.name) + ", " + of_b + " in " + Printable(b.name);
}

}  // namespace

std::vector<std::string> DesignDifferences(const ComparedDesign& a, const ComparedDesign& b) {
  constexpr double kSameHeight = 0.0005, kSameMass = 1e-6;
  std::vector<std::string> lines;
  if (a.object_mass && b.object_mass && std::abs(*a.object_mass - *b.object_mass) > kSameMass)
    lines.push_back(DifferenceLine("mass of the object", Formatted("%.3g kg", *a.object_mass),
                                   Formatted("%.3g kg", *b.object_mass), a, b));
  if (std::abs(a.handle_height - b.handle_height) > kSameHeight)
    lines.push_back(DifferenceLine("height of the handles at the start",
                                   Formatted("%.3f m", a.handle_height),
                                   Formatted("%.3f m", b.handle_height), a, b));
  if (a.scenario && b.scenario)
    for (const KeyDifference& d : DifferentKeys(*a.scenario, *b.scenario)) {
      const std::string of_a = Shortened(d.a), of_b = Shortened(d.b);
      lines.push_back(of_a == of_b ? Printable(d.key) + " differs"
                                   : DifferenceLine(Printable(d.key), of_a, of_b, a, b));
    }
  return lines;
}

std::string HandleHeightWarning(const ComparedDesign& a, const ComparedDesign& b) {
  const double higher = b.handle_height - a.handle_height;
  if (!(std::abs(higher) > kSameHandleHeight)) return "";
  return Formatted(
      "The handles of %s start %.0f cm %s above the ground than those of %s. This height alone "
      "changes the posture and the loads, so the results do not show the effect of another change.",
      Printable(b.name).c_str(), 100 * std::abs(higher), higher > 0 ? "higher" : "lower",
      Printable(a.name).c_str());
}

}  // namespace predictor::assessment
