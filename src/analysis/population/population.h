// In the population study, the same simulated people, each with their own body, perform every
// design. The effects of the designs are compared person by person.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/population/people.h"
#include "assessment/assessment.h"
#include "core/status.h"
#include "evaluation/censored.h"
#include "evaluation/metric.h"
#include "evaluation/statistics_signed_rank.h"

namespace predictor::population {

// A quantity of an assessed run that the study compares.
struct StudyQuantity {
  const char* path;   // key in JSON and CSV, ending in the SI unit
  const char* label;  // text for people
  Unit unit;
  assessment::Origin origin;
  // Returns the value that is exceeded, in the bad direction, for the share `tail` of the judged
  // time, or NaN. Damage, which only grows, does not depend on `tail`.
  double (*of)(const assessment::Assessment&, double tail);
  double limit = 0;             // in SI units; a value beyond it counts as exceeding it; without a
                                // limit_name, there is no limit
  const char* limit_name = "";  // source of the limit
  assessment::Bad bad = assessment::Bad::kHigh;

  bool has_limit() const { return limit_name[0] != '\0'; }
  bool Exceeds(double x) const { return bad == assessment::Bad::kHigh ? x > limit : x < limit; }
};
std::span<const StudyQuantity> StudyQuantities();
// A person's value in a whole run is exceeded for this share of the time.
inline constexpr double kTailShare = 0.05;

inline constexpr std::size_t kRulaScores = 8;  // index = score; 0 is not a score

// One person in one design.
struct PopulationRun {
  int person = 0;
  StopCause cause = StopCause::kNone;  // cause of the emulator's first stop
  double held = 0;                     // time that was judged [s]
  // In the order of StudyQuantities(). If the run was stopped, the values are bounds: the values of
  // the whole run would have been at least as bad. NaN: no value, or no bound.
  std::vector<double> values;
  std::array<double, kRulaScores> rula_share = {};  // share of time at each score
  bool beyond_lifft = false;  // a load is beyond LiFFT's range, so its damage is extrapolated
};

// A scenario with the handles at a given height.
struct PopulationDesign {
  std::string name;
  std::string scenario;             // file name without folder and extension
  std::optional<double> height;     // of the point midway between the handles, above the ground at
                                    // the start [m]
  std::vector<PopulationRun> runs;  // by person
};

// A share with its 95 % Wilson score interval (Wilson 1927). People are undecided if a stopped run
// does not show whether they count. The interval covers both answers.
struct Share {
  int count = 0, of = 0, undecided = 0;
  double low = 0, high = 1;
  double value() const { return of > 0 ? static_cast<double>(count) / of : 0; }
};
Share ShareOf(int count, int of, int undecided = 0);

// Returns the number of people whose damage by LiFFT is extrapolated.
int BeyondLifft(const PopulationDesign& design);
// Returns a sentence about these people, or "" if there are none.
std::string BeyondLifftSentence(const PopulationDesign& design);

// One quantity in one design. Values of stopped runs are censored observations. The quantiles are
// those of Kaplan and Meier (CensoredQuantile). If a quantile is itself only a bound, `at_least`
// means that the true quantile is at least as bad.
struct DesignSummary {
  int people = 0, stopped = 0;  // all people; those whose value is a bound
  CensoredValue median, p5, p95;
  Share beyond;  // the limit
};

// One quantity in two designs. The difference is positive if design a has larger values. If a run
// was stopped, only a range of the person's difference is known. The interval and p are the widest
// and the largest that differences within these ranges give. They do not require that the stops
// are independent of the values.
struct PairedDifference {
  std::size_t a = 0, b = 0;  // designs
  std::size_t quantity = 0;
  // Shift of a - b by Hodges and Lehmann, with its 95 % interval. The estimate is the middle of its
  // possible values. An end that the stopped runs leave open is infinite.
  ShiftEstimate shift;
  double p = 1, p_holm = 1;  // of the signed-rank test; p_holm is adjusted for all differences of
                             // the study
  Share better;              // people for whom a is better than b
};

struct PopulationStudy {
  std::vector<SampledPerson> people;
  std::vector<PopulationDesign> designs;
  std::vector<std::vector<DesignSummary>> summaries;  // [design][quantity]
  std::vector<PairedDifference> differences;          // for each pair a > b and each quantity
  // What the designs differ in from the first design, and warnings about this.
  std::vector<std::string> differences_of_designs, warnings;
  int kept = 0;  // runs that an earlier, interrupted study had finished
};

struct PopulationOptions {
  std::vector<std::filesystem::path> scenarios;
  std::vector<std::string> set;  // overrides for all scenarios
  std::vector<double> heights;   // heights of the handles [m]; empty: as in the scenario
  std::filesystem::path folder;  // folder for the results; created if necessary
  int persons = 200;
  std::uint64_t seed = 1;       // seed of the population
  int workers = 0;              // 0: the number of cores
  std::string program_version;  // shown on the page
  // Only the caller's thread calls this.
  std::function<void(double share)> progress = [](double) {};
};

// Executes the runs that the folder's runs.jsonl does not contain yet: first all designs for one
// person, and then all designs for the next person. An interrupted study therefore contains fewer
// people but all designs. Each finished run is appended to runs.jsonl. Writes the files
// persons.csv, designs.csv, differences.csv and population.html. Throws InputError.
PopulationStudy MakePopulationStudy(const PopulationOptions& options);

// Computes summaries and differences from the runs.
void Compare(PopulationStudy* study);

// Returns the value in the unit for people. The text marks a value of which only a bound is known,
// and is "–" if the value is unknown.
std::string Shown(const StudyQuantity& kind, const CensoredValue& x);

std::string PersonsCsv(const PopulationStudy& study);
std::string DesignsCsv(const PopulationStudy& study);
std::string DifferencesCsv(const PopulationStudy& study);
std::string PopulationJson(const PopulationStudy& study);
// Returns the JSON Schema (draft-07) of PopulationJson.
std::string PopulationSchema();
std::string PopulationText(const PopulationStudy& study);
std::string PopulationPage(const PopulationStudy& study, const std::string& program_version);

}  // namespace predictor::population
