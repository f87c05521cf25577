#include "evaluation/metric.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"

namespace predictor {
namespace {

// Returns the index of the element for which `is` returns true. If the element is missing, appends
// it.
template <class List, class Predicate>
std::size_t Place(List* list, const Predicate& is) {
  const auto found = std::find_if(list->begin(), list->end(), is);
  const auto place = static_cast<std::size_t>(found - list->begin());
  if (found == list->end()) list->emplace_back();
  return place;
}

void AddCell(const Result& result, ResultGroup* group) {
  const std::size_t column =
      Place(&group->columns, [&](const Result* one) { return one->column == result.column; });
  group->columns[column] = &result;
  auto& cells =
      group->rows[Place(&group->rows, [&](const auto& row) { return row.label == result.label; })];
  cells.label = result.label;
  cells.cells.resize(std::max(cells.cells.size(), column + 1));
  cells.cells[column] = &result;
}

void AddToLine(const Result& result, std::string* line) {
  if (!line->empty()) *line += ", ";
  if (const auto* number = std::get_if<double>(&result.value))
    Append(line, "%.*f", result.unit.decimals, result.unit.factor * *number);
  else if (const auto* count = std::get_if<std::uint64_t>(&result.value))
    *line += std::to_string(*count);
  else if (const auto* words = std::get_if<std::string>(&result.value))
    *line += *words;
  for (const std::string& word : {std::string(result.unit.shown), result.label})
    if (!word.empty()) *line += " " + word;
}

}  // namespace

Quantiles QuantilesOf(const Histogram& h) {
  return {h.Quantile(0.5), h.Quantile(0.99), h.Quantile(0.999), h.max(), h.count()};
}

bool IsMissing(const ResultValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return !std::isfinite(*number);
  if (const auto* statistics = std::get_if<Statistics>(&value)) return statistics->count() == 0;
  if (const auto* quantiles = std::get_if<Quantiles>(&value)) return quantiles->count == 0;
  return std::holds_alternative<std::monostate>(value);
}

std::vector<ResultGroup> GroupResults(const std::vector<Result>& results) {
  std::vector<ResultGroup> groups;
  for (const Result& result : results) {
    if (!result.shown || IsMissing(result.value)) continue;
    if (groups.empty() || groups.back().title != result.group) {
      groups.emplace_back();
      groups.back().title = result.group;
      groups.back().chapter = result.chapter;
    }
    if (std::holds_alternative<Statistics>(result.value) ||
        std::holds_alternative<Quantiles>(result.value))
      AddCell(result, &groups.back());
    else
      AddToLine(result, &groups.back().line);
  }
  return groups;
}

std::string WithUnit(const std::string& name, const Unit& unit) {
  return *unit.shown == '\0' ? name : name + " [" + unit.shown + "]";
}

}  // namespace predictor
