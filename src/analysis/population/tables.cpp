// Writes the results of a population study as CSV, JSON and text.
#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/population/population.h"
#include "assessment/design_differences.h"
#include "core/format.h"
#include "core/json_schema.h"
#include "core/person_state.h"
#include "core/text.h"
#include "report/plot.h"

namespace predictor::population {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSignificant = 0.05;

// Adding 0 turns −0 into 0.
std::string Cell(double x) { return std::isfinite(x) ? Formatted("%.6g", x + 0.0) : ""; }
const char* SexName(Sex sex) { return sex == Sex::kMale ? "male" : "female"; }

std::string Shown(const StudyQuantity& kind, double x) {
  return std::isfinite(x) ? Fixed(kind.unit.factor * x, kind.unit.decimals) : "–";
}

// Returns the names of the quantiles that are only bounds, separated by spaces.
std::string BoundsIn(const DesignSummary& s) {
  std::vector<std::string> names;
  if (s.median.at_least) names.emplace_back("median");
  if (s.p5.at_least) names.emplace_back("p5");
  if (s.p95.at_least) names.emplace_back("p95");
  return Join(names, " ");
}

std::string Percent(const Share& share) {
  return Formatted("%.0f %% (%.0f to %.0f)", 100 * share.value(), 100 * share.low,
                   100 * share.high);
}

int StopsOf(const PopulationDesign& design) {
  int stops = 0;
  for (const PopulationRun& run : design.runs) stops += run.cause != StopCause::kNone;
  return stops;
}

Json ToJson(const Share& share) {
  return {{"count", share.count},
          {"of", share.of},
          {"undecided", share.undecided},
          {"interval_95", {share.low, share.high}}};
}

Json SummaryJson(const StudyQuantity& kind, const DesignSummary& s) {
  return {{"unit", kind.unit.si},
          {"origin", assessment::Name(kind.origin, true)},
          {"people", s.people},
          {"known_as_bounds", s.stopped},
          {"median", NumberOrNull(s.median.value)},
          {"p5", NumberOrNull(s.p5.value)},
          {"p95", NumberOrNull(s.p95.value)},
          {"bounds", BoundsIn(s)},
          {"limit", kind.has_limit() ? Json(kind.limit) : Json(nullptr)},
          {"beyond_limit", kind.has_limit() ? ToJson(s.beyond) : Json(nullptr)}};
}

Json DifferenceJson(const PopulationStudy& study, const PairedDifference& d) {
  return {{"design", study.designs[d.a].name},
          {"against", study.designs[d.b].name},
          {"quantity", StudyQuantities()[d.quantity].path},
          {"people", d.better.of},
          {"shift", NumberOrNull(d.shift.estimate)},
          {"interval_95", {NumberOrNull(d.shift.lower), NumberOrNull(d.shift.upper)}},
          {"p", NumberOrNull(d.p)},
          {"p_holm", NumberOrNull(d.p_holm)},
          {"better", ToJson(d.better)}};
}

Json PersonJson(const SampledPerson& person) {
  return {{"number", person.number},          {"sex", SexName(person.body.sex)},
          {"height_m", person.body.height},   {"mass_kg", person.body.mass},
          {"strength", person.body.strength}, {"stiffness", person.body.stiffness}};
}

std::string DesignText(const PopulationStudy& study, std::size_t design) {
  const PopulationDesign& d = study.designs[design];
  std::string text;
  AppendLine(&text, "\n%s: %zu people, %d of them stopped by the emulator", d.name.c_str(),
             d.runs.size(), StopsOf(d));
  AppendLine(&text, "%-50s %9s  %-17s %-8s %s", "", "median", "90 % of people", "limit",
             "people beyond it");
  for (std::size_t q = 0; q < StudyQuantities().size(); ++q) {
    const StudyQuantity& kind = StudyQuantities()[q];
    const DesignSummary& s = study.summaries[design][q];
    const std::string range = Shown(kind, s.p5) + " … " + Shown(kind, s.p95);
    const std::string limit =
        kind.has_limit()
            ? (kind.bad == assessment::Bad::kHigh ? "> " : "< ") + Shown(kind, kind.limit)
            : "";
    AppendLine(&text, "%-50s %9s  %-17s %-8s %s", WithUnit(kind.label, kind.unit).c_str(),
               Shown(kind, s.median).c_str(), range.c_str(), limit.c_str(),
               kind.has_limit() ? Percent(s.beyond).c_str() : "");
  }
  if (const std::string beyond = BeyondLifftSentence(d); !beyond.empty())
    AppendLine(&text, "%s", beyond.c_str());
  return text;
}

std::string DifferenceText(const PopulationStudy& study, std::size_t against) {
  std::string text;
  std::size_t last = against;
  for (const PairedDifference& d : study.differences) {
    if (d.b != against) continue;
    const StudyQuantity& kind = StudyQuantities()[d.quantity];
    if (d.a != last)
      AppendLine(&text, "\n%s minus %s, the same %d people\n%-50s %9s  %-17s %-9s %s",
                 study.designs[d.a].name.c_str(), study.designs[d.b].name.c_str(), d.better.of, "",
                 "shift", "95 %", "p (Holm)", "better for");
    last = d.a;
    const std::string range = Shown(kind, d.shift.lower) + " … " + Shown(kind, d.shift.upper);
    AppendLine(&text, "%-50s %9s  %-17s %-9s %s", WithUnit(kind.label, kind.unit).c_str(),
               Shown(kind, d.shift.estimate).c_str(), range.c_str(),
               d.p_holm < 0.001 ? "< 0.001" : Formatted("%.3f", d.p_holm).c_str(),
               d.p_holm < kSignificant ? Percent(d.better).c_str() : "not decided");
  }
  return text;
}

}  // namespace

std::string Shown(const StudyQuantity& kind, const CensoredValue& x) {
  const std::string value = Shown(kind, x.value);
  if (!x.at_least || !std::isfinite(x.value)) return value;
  return (kind.bad == assessment::Bad::kHigh ? "≥ " : "≤ ") + value;
}

std::string PersonsCsv(const PopulationStudy& study) {
  std::string csv =
      "design,scenario,handle_height_m,person,sex,height_m,mass_kg,strength_elbow_flexion,"
      "strength_elbow_extension,strength_shoulder_flexion,strength_shoulder_extension,stiffness,"
      "stop,held_s";
  for (const StudyQuantity& kind : StudyQuantities()) csv += std::string(",") + kind.path;
  for (std::size_t score = 1; score < kRulaScores; ++score)
    csv += Formatted(",rula_%zu_share", score);
  csv += ",beyond_lifft\n";
  for (const PopulationDesign& design : study.designs)
    for (std::size_t i = 0; i < design.runs.size(); ++i) {
      const PopulationRun& run = design.runs[i];
      const BodySpec& body = study.people[i].body;
      std::vector<std::string> row = {CsvCell(design.name),
                                      CsvCell(design.scenario),
                                      Cell(design.height.value_or(std::nan(""))),
                                      std::to_string(run.person),
                                      SexName(body.sex),
                                      Cell(body.height),
                                      Cell(body.mass)};
      for (const double share : body.strength) row.push_back(Cell(share));
      row.insert(row.end(), {Cell(body.stiffness), Name(run.cause), Cell(run.held)});
      for (const double value : run.values) row.push_back(Cell(value));
      for (std::size_t score = 1; score < kRulaScores; ++score)
        row.push_back(Cell(run.rula_share[score]));
      row.emplace_back(run.beyond_lifft ? "1" : "0");
      csv += Join(row, ",") + "\n";
    }
  return csv;
}

std::string DesignsCsv(const PopulationStudy& study) {
  std::string csv =
      "design,scenario,handle_height_m,stopped,beyond_lifft,quantity,unit,origin,people,known_as_"
      "bounds,median,"
      "p5,p95,"
      "bounds,limit,beyond,undecided,beyond_low,beyond_high\n";
  for (std::size_t i = 0; i < study.designs.size(); ++i) {
    const PopulationDesign& design = study.designs[i];
    for (std::size_t q = 0; q < StudyQuantities().size(); ++q) {
      const StudyQuantity& kind = StudyQuantities()[q];
      const DesignSummary& s = study.summaries[i][q];
      std::vector<std::string> row = {CsvCell(design.name),
                                      CsvCell(design.scenario),
                                      Cell(design.height.value_or(std::nan(""))),
                                      std::to_string(StopsOf(design)),
                                      std::to_string(BeyondLifft(design)),
                                      kind.path,
                                      kind.unit.si,
                                      assessment::Name(kind.origin, true),
                                      std::to_string(s.people),
                                      std::to_string(s.stopped),
                                      Cell(s.median.value),
                                      Cell(s.p5.value),
                                      Cell(s.p95.value),
                                      BoundsIn(s)};
      if (kind.has_limit())
        row.insert(row.end(),
                   {Cell(kind.limit), Cell(s.beyond.value()), std::to_string(s.beyond.undecided),
                    Cell(s.beyond.low), Cell(s.beyond.high)});
      else
        row.insert(row.end(), 5, "");
      csv += Join(row, ",") + "\n";
    }
  }
  return csv;
}

std::string DifferencesCsv(const PopulationStudy& study) {
  std::string csv =
      "design,against,quantity,unit,people,shift,low,high,p,p_holm,better,undecided,better_low,"
      "better_high\n";
  for (const PairedDifference& d : study.differences) {
    const StudyQuantity& kind = StudyQuantities()[d.quantity];
    csv += Join({CsvCell(study.designs[d.a].name), CsvCell(study.designs[d.b].name), kind.path,
                 kind.unit.si, std::to_string(d.better.of), Cell(d.shift.estimate),
                 Cell(d.shift.lower), Cell(d.shift.upper), Cell(d.p), Cell(d.p_holm),
                 Cell(d.better.value()), std::to_string(d.better.undecided), Cell(d.better.low),
                 Cell(d.better.high)},
                ",") +
           "\n";
  }
  return csv;
}

std::string PopulationJson(const PopulationStudy& study) {
  Json json = {{"operator", "simulated"}, {"people", Json::array()}, {"designs", Json::array()}};
  for (const SampledPerson& person : study.people) json["people"].push_back(PersonJson(person));
  for (std::size_t i = 0; i < study.designs.size(); ++i) {
    const PopulationDesign& design = study.designs[i];
    Json quantities = Json::object();
    for (std::size_t q = 0; q < StudyQuantities().size(); ++q)
      quantities[StudyQuantities()[q].path] =
          SummaryJson(StudyQuantities()[q], study.summaries[i][q]);
    json["designs"].push_back({{"name", design.name},
                               {"scenario", design.scenario},
                               {"handle_height_m", design.height ? Json(*design.height) : Json()},
                               {"stopped", StopsOf(design)},
                               {"beyond_lifft", BeyondLifft(design)},
                               {"quantities", quantities}});
  }
  json["differences"] = Json::array();
  for (const PairedDifference& d : study.differences)
    json["differences"].push_back(DifferenceJson(study, d));
  return json.dump(2) + "\n";
}

std::string PopulationText(const PopulationStudy& study) {
  std::string text;
  AppendLine(
      &text,
      "%zu simulated people with different bodies in %zu designs (%d runs from an earlier study).",
      study.people.size(), study.designs.size(), study.kept);
  text +=
      "Each person's value is the 95th percentile over time (5th percentile for balance) for the "
      "nominal posture. For RULA and REBA, the value is the score that is exceeded for 5 % of the "
      "time.\n";
  AppendLine(&text, "L5/S1 compression: %s", kCompressionCaveat);
  for (const std::string& line : study.warnings) AppendLine(&text, "Warning: %s", line.c_str());
  if (!study.differences_of_designs.empty()) text += assessment::kDesignsDiffer + std::string("\n");
  for (const std::string& line : study.differences_of_designs)
    AppendLine(&text, "  %s", line.c_str());
  for (std::size_t i = 0; i < study.designs.size(); ++i) text += DesignText(study, i);
  text += DifferenceText(study, 0);
  text +=
      "\nThe shift is the Hodges-Lehmann estimate of the difference for the same person, with its "
      "95 % interval. The value p comes from Wilcoxon's signed-rank test. Holm's method adjusts p "
      "for the number of differences in the study. Shares have 95 % intervals. If the emulator "
      "stopped a run, only a bound of the person's value is known (≥ or ≤). The quantiles are "
      "those of Kaplan and Meier. The intervals of shifts and shares, and p, cover everything that "
      "the stopped runs leave open.\n";
  return text;
}

}  // namespace predictor::population
