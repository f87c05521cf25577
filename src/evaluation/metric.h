// The interface of a metric, which accumulates the records of a run and lists its results. The
// printed summary, its JSON form and JSON Schema, the report and the comparison of runs are made
// from this list of results. To add a metric, see docs/developer/add-a-metric.md.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/histogram.h"
#include "core/record.h"
#include "core/units.h"
#include "evaluation/statistics.h"
#include "scenario/scenario.h"

namespace predictor {

// The SI unit that is used in files, and the unit in which a value is displayed.
struct Unit {
  const char* si = "";
  const char* shown = "";
  double factor = 1;  // factor from SI to the displayed unit
  int decimals = 0;   // number of decimals in tables, in the displayed unit
};
namespace units {
inline constexpr Unit kNone = {};
inline constexpr Unit kMetre = {"m", "m", 1, 3};
inline constexpr Unit kMillimetre = {"m", "mm", kMillimetres, 3};
inline constexpr Unit kDegree = {"rad", "°", kDegrees, 4};
inline constexpr Unit kNewton = {"N", "N", 1, 2};
inline constexpr Unit kNewtonMetre = {"N·m", "N·m", 1, 3};
inline constexpr Unit kMetrePerSecond = {"m/s", "m/s", 1, 3};
inline constexpr Unit kSecond = {"s", "s", 1, 3};
inline constexpr Unit kMicrosecond = {"µs", "µs", 1, 1};
}  // namespace units

struct Quantiles {
  double p50 = 0, p99 = 0, p999 = 0, max = 0;
  std::uint64_t count = 0;
};
Quantiles QuantilesOf(const Histogram& histogram);

// The following are missing values: a number that is not finite, statistics without samples, and
// monostate. Missing values are null in files and are omitted from text.
using ResultValue =
    std::variant<std::monostate, double, std::uint64_t, bool, std::string, Statistics, Quantiles>;

// The chapter of the report that shows a result. The results in the chapter kTiming depend on the
// computer's speed.
enum class Chapter { kSummary, kTracking, kForces, kRendering, kTiming };

struct Result {
  // The path of keys in the summary JSON, which ends with the SI unit, for example
  // "wrench.left.force_n".
  std::string path;
  // The following texts are for people. Adjacent results of one group form a table of statistics, a
  // table of quantiles, or a line of single values.
  std::string group;   // title
  std::string label;   // row, or the words after a single value
  std::string column;  // column in a table of statistics
  Unit unit = units::kNone;
  std::string meaning;  // description for the reference
  ResultValue value;
  // States whether the printed summary and the report of one run show the result in a table or
  // line.
  bool shown = true;
  bool compared = true;                 // whether it is shown in the comparison of runs
  Chapter chapter = Chapter::kSummary;  // set from the metric's kind
};

class Metric {
 public:
  virtual ~Metric() = default;
  // Adds the next record. This function is called for every tick, in order, even while simulated
  // time is paused (`ran` is 0). The function must not use the heap.
  virtual void Add(const TickRecord& record) noexcept = 0;
  // Appends the results of the records so far. The number of results and their paths must not
  // depend on the records.
  virtual void AppendTo(std::vector<Result>* results) const = 0;
};

// The registry's description of a metric.
struct MetricKind {
  Chapter chapter = Chapter::kSummary;
  std::unique_ptr<Metric> (*make)(const Scenario&);
};

template <class M>
std::unique_ptr<Metric> MakeMetric(const Scenario& scenario) {
  return std::make_unique<M>(scenario);
}

// Returns all metrics in the order of the summary.
std::span<const MetricKind* const> Metrics();

bool IsMissing(const ResultValue& value);

// The results of one group, in the form in which the printed summary and the report show them.
// Missing values and empty rows are omitted.
struct ResultGroup {
  struct Row {
    std::string label;
    std::vector<const Result*> cells;  // one per column; null: no value
  };
  std::string title;
  Chapter chapter = Chapter::kSummary;
  std::vector<const Result*> columns;  // one result per column, for its name and unit
  std::vector<Row> rows;
  std::string line;  // the single values: "3 solved, 0 failed"
};
// Returns the groups of the results that are shown.
std::vector<ResultGroup> GroupResults(const std::vector<Result>& results);

// Returns a name with its unit, for example "force [N]".
std::string WithUnit(const std::string& name, const Unit& unit);

}  // namespace predictor
