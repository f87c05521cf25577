#include "assessment/comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "assessment/output.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "core/text_table.h"
#include "report/page.h"

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
  // A difference below half of the last printed digit is a tie, which counts as one half.
  const double tie = 0.5 * std::pow(10, -a.kind->unit.decimals) / a.kind->unit.factor;
  double better = 0;
  for (std::size_t i = 0; i < a.person_tail.size(); ++i) {
    const double difference = a.person_tail[i] - b.person_tail[i];
    if (!std::isfinite(difference)) continue;
    differences.push_back(difference);
    better += std::fabs(difference) < tie ? 0.5 : sign * difference < 0 ? 1 : 0;
  }
  if (2 * differences.size() < a.person_tail.size()) return result;
  result.share_better = better / static_cast<double>(differences.size());
  result.interval = person::IntervalOf(differences);
  return result;
}

void SetNames(Comparison* comparison) {
  const auto stem = [](const std::string& recording) {
    return std::filesystem::path(recording).stem().string();
  };
  comparison->name_a = stem(comparison->a);
  comparison->name_b = stem(comparison->b);
  if (comparison->name_a != comparison->name_b) return;
  comparison->name_a += " (first)";
  comparison->name_b += " (second)";
}

struct ComparedRow {
  std::string name, a, b, difference, better;
  const Difference* of = nullptr;  // null: the header or a damage
};

ComparedRow HeaderOf(const Comparison& c) {
  return {"", Printable(c.name_a), Printable(c.name_b),
          Printable(c.name_a + " − " + c.name_b) + " (90 %)",
          Printable(c.name_a) + " is better for"};
}

std::vector<ComparedRow> RowsOf(const Comparison& comparison) {
  std::vector<ComparedRow> rows = {HeaderOf(comparison)};
  for (const Difference& d : comparison.differences) {
    const QuantityKind& kind = *d.kind;
    if (!kind.has_row()) continue;
    ComparedRow row = {WithUnit(std::string(kind.group) + ", " + kind.label, kind.unit),
                       ValueText(kind, d.a),
                       ValueText(kind, d.b),
                       "",
                       "",
                       &d};
    if (d.interval) {
      row.difference = RangeText(kind, d.interval);
      row.better = Formatted("%.0f %%", 100 * *d.share_better);
    }
    rows.push_back(row);
  }
  for (const DamageResult& a : comparison.damage_a)
    for (const DamageResult& b : comparison.damage_b)
      if (a.tool == b.tool && a.part == b.part)
        rows.push_back({a.tool + ", " + a.part + ", reference day per run [%]",
                        Formatted("%.3g", 100 * a.day_share), Formatted("%.3g", 100 * b.day_share),
                        "", ""});
  return rows;
}

std::vector<std::string> NotesOf(const Comparison& comparison) {
  std::vector<std::string> notes = {Formatted(
      "The values are 95th percentiles over time (5th percentile for balance) of the nominal "
      "posture. A positive difference means that the value of %s is larger. The last column "
      "contains the share of 64 possible postures and bodies for which %s has the better value.",
      Printable(comparison.name_a).c_str(), Printable(comparison.name_a).c_str())};
  const auto add = [&](const std::string& name, const std::vector<DamageResult>& damage) {
    for (const DamageResult& d : damage)
      if (d.outside())
        notes.push_back(Printable(name) + ": " + d.tool + ", " + d.part + RangeWords(d) + ".");
  };
  add(comparison.name_a, comparison.damage_a);
  add(comparison.name_b, comparison.damage_b);
  return notes;
}

// Draws the 90 % interval as a bar, the difference of the nominal posture as a dot, and a line at
// 0.
std::string DrawnDifference(const Difference& d) {
  if (!d.interval || !std::isfinite(d.a - d.b)) return "";
  const double nominal = d.a - d.b, low = d.interval->low, high = d.interval->high;
  const double most = std::max({std::abs(low), std::abs(high), std::abs(nominal)});
  constexpr double kHalf = 60, kBorder = 5;  // [px]
  const auto at = [&](double x) { return kHalf + kBorder + (most > 0 ? kHalf * x / most : 0); };
  return Formatted(
      "<svg class=\"difference\" width=\"%.0f\" height=\"14\" role=\"img\" "
      "aria-label=\"difference\"><path d=\"M%.1f 0V14\" stroke=\"currentColor\" "
      "stroke-opacity=\"0.4\"/><path d=\"M%.1f 7H%.1f\" stroke=\"currentColor\" "
      "stroke-width=\"3\" stroke-opacity=\"0.6\"/><circle cx=\"%.1f\" cy=\"7\" r=\"4\" "
      "fill=\"currentColor\"/></svg>",
      2 * (kHalf + kBorder), at(0), at(low), at(high), at(nominal));
}

}  // namespace

Comparison Compare(const Assessment& a, const Assessment& b) {
  if (!SameBody(a.setup.body, b.setup.body))
    throw InputError(
        b.recording,
        "The operator's body differs from that of " + a.recording +
            ". Give both runs the same body, for example with --set operator.body.height=1.75.");
  Comparison comparison;
  comparison.a = a.recording;
  comparison.b = b.recording;
  comparison.damage_a = a.damage;
  comparison.damage_b = b.damage;
  SetNames(&comparison);
  for (const QuantityResult& of_a : a.quantities)
    for (const QuantityResult& of_b : b.quantities)
      if (of_a.kind == of_b.kind) comparison.differences.push_back(DifferenceOf(of_a, of_b));
  constexpr double kSameLength = 0.1;
  if (std::abs(a.held - b.held) > kSameLength * std::max(a.held, b.held))
    comparison.warnings.push_back(Formatted(
        "The hands held the handles for %.1f s in %s and for %.1f s in %s. A run that ended early "
        "looks better than a complete run.",
        a.held, Printable(comparison.name_a).c_str(), b.held,
        Printable(comparison.name_b).c_str()));
  return comparison;
}

void AddDesigns(ComparedDesign a, ComparedDesign b, Comparison* comparison) {
  a.name = comparison->name_a;
  b.name = comparison->name_b;
  comparison->designs = DesignDifferences(a, b);
  if (const std::string warning = HandleHeightWarning(a, b); !warning.empty())
    comparison->warnings.push_back(warning);
}

std::string ComparisonTitle(const Comparison& comparison) {
  return Printable(comparison.name_a) + " compared with " + Printable(comparison.name_b);
}

std::string ComparisonText(const Comparison& comparison) {
  std::string text = "\n" + ComparisonTitle(comparison) + ", for the same person\n";
  for (const std::string& line : comparison.warnings)
    AppendLine(&text, "Warning: %s", line.c_str());
  if (!comparison.designs.empty()) text += kDesignsDiffer + std::string("\n");
  for (const std::string& line : comparison.designs) AppendLine(&text, "  %s", line.c_str());
  const std::vector<ComparedRow> rows = RowsOf(comparison);
  std::array<std::size_t, 4> widths = {};
  for (const ComparedRow& row : rows) {
    const std::array cells = {&row.name, &row.a, &row.b, &row.difference};
    for (std::size_t i = 0; i < cells.size(); ++i)
      widths[i] = std::max(widths[i], CharactersIn(*cells[i]));
  }
  for (const ComparedRow& row : rows) {
    std::string line = LeftAligned(row.name, widths[0]) + "  " + RightAligned(row.a, widths[1]) +
                       "  " + RightAligned(row.b, widths[2]) + "  " +
                       LeftAligned(row.difference, widths[3]) + "  " + row.better;
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  for (const std::string& note : NotesOf(comparison)) text += note + "\n";
  return text + "With --json, the comparison also contains the joints of the arms.\n";
}

std::string ComparisonHtml(const Comparison& comparison) {
  std::string html;
  for (const std::string& line : comparison.warnings)
    html += "<p class=\"warning\">Warning: " + EscapeMarkup(line) + "</p>\n";
  if (!comparison.designs.empty()) {
    html += std::string("<p>") + kDesignsDiffer + "</p>\n<ul>\n";
    for (const std::string& line : comparison.designs)
      html += "<li>" + EscapeMarkup(line) + "</li>\n";
    html += "</ul>\n";
  }
  std::vector<std::vector<std::string>> table;
  for (const ComparedRow& row : RowsOf(comparison))
    table.push_back({EscapeMarkup(row.name), EscapeMarkup(row.a), EscapeMarkup(row.b),
                     EscapeMarkup(row.difference), row.of ? DrawnDifference(*row.of) : "",
                     EscapeMarkup(row.better)});
  table.front()[0] = "Quantity";
  html += HtmlTable(table);
  for (const std::string& note : NotesOf(comparison)) html += "<p>" + EscapeMarkup(note) + "</p>\n";
  return html +
         "<p class=\"caption\">Bars: the 90 % interval of the difference. Dots: the difference for "
         "the nominal posture. Vertical lines: 0. Each row has its own scale.</p>\n";
}

}  // namespace predictor::assessment
