#include "assessment/user_limits.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "assessment/assessment.h"
#include "assessment/output.h"
#include "assessment/person_chain.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "ergonomics/limit_file.h"

namespace predictor::assessment {
namespace {

constexpr const char* kColumns = "quantity,limit,unit,allowed_s,clause";
constexpr double kLowest = -1e9;  // no lower bound for a limit: a trunk bends backward, too

const QuantityKind& KindOf(const std::string& path, const std::string& place) {
  std::vector<const QuantityKind*> kinds;
  for (const QuantityKind& kind : Quantities()) kinds.push_back(&kind);
  for (int hand = 0; hand < kHands; ++hand) kinds.push_back(&ActivityRatioKind(hand));
  std::vector<std::string> paths;
  for (const QuantityKind* kind : kinds) {
    if (path == kind->path) return *kind;
    paths.emplace_back(kind->path);
  }
  const std::string nearest = Nearest(path, paths);
  throw InputError(place, "there is no quantity " + Quote(path) + ". " +
                              (nearest.empty() ? "The JSON of predictor evaluate names them all."
                                               : "Did you mean " + nearest + "?"));
}

// Returns the factor from the unit of a row to the SI unit.
double FactorOf(const std::string& unit, const QuantityKind& kind, const std::string& place) {
  const std::string shown = kind.unit.shown;
  if (unit == kind.unit.si) return 1;
  if (unit == shown || (unit == "deg" && shown == "°")) return 1 / kind.unit.factor;
  throw InputError(place, "unit is " + Quote(unit) + ", but " + kind.path + " is in " +
                              (*kind.unit.si == '\0' ? "1 (leave the cell empty)" : kind.unit.si) +
                              " or " + shown + ".");
}

UserLimit LimitOf(const ergonomics::LimitRow& row) {
  UserLimit limit;
  limit.kind = &KindOf(row.cells[0], row.place);
  limit.value = ergonomics::NumberInCell(row.cells[1], "limit", kLowest, true, row.place) *
                FactorOf(row.cells[2], *limit.kind, row.place);
  limit.allowed = ergonomics::NumberInCell(row.cells[3], "allowed_s", 0, true, row.place);
  if (!limit.kind->of && limit.allowed > 0)
    throw InputError(row.place, std::string("allowed_s must be 0, because ") + limit.kind->path +
                                    " has one value for the whole run.");
  limit.clause = row.cells[4];
  return limit;
}

bool IsBeyond(double x, const UserLimit& limit) {
  return limit.kind->bad == Bad::kHigh ? x > limit.value : x < limit.value;
}

// Returns the longest time in which `beyond` holds for successive values [s]. Each value stands for
// a period. A larger distance between two times interrupts the time.
double Longest(std::span<const double> times, double period,
               const std::function<bool(std::size_t)>& beyond) {
  std::size_t longest = 0, now = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i > 0 && times[i] - times[i - 1] > 1.5 * period) now = 0;
    now = beyond(i) ? now + 1 : 0;
    longest = std::max(longest, now);
  }
  return static_cast<double>(longest) * period;
}

Verdict VerdictOf(const LimitResult& r) {
  constexpr double kRounding = 1e-9;
  const double most = r.limit.allowed + kRounding;
  const bool exceeded = r.longest > most;
  const bool sure = !r.surely || (*r.surely > most) == exceeded;
  const bool possible = !r.possibly || (*r.possibly > most) == exceeded;
  if (!sure || !possible) return Verdict::kUncertain;
  return exceeded ? Verdict::kExceeded : Verdict::kKept;
}

LimitResult Compared(const UserLimit& limit, const QuantityResult& q, const Assessment& a) {
  constexpr double kPeriod = 1 / kSampleRate;
  LimitResult r{.limit = limit, .worst = q.worst()};
  const auto nominal = [&](std::size_t i) { return IsBeyond(q.values[i], limit); };
  r.longest = Longest(a.times, kPeriod, nominal);
  std::size_t count = 0;
  for (std::size_t i = 0; i < q.values.size(); ++i) count += nominal(i) ? 1 : 0;
  r.share = static_cast<double>(count) / static_cast<double>(q.values.size());
  if (!q.low.empty()) {
    const double period = kPeriod * static_cast<double>(kSampledStride);
    const auto low = [&](std::size_t i) { return IsBeyond(q.low[i], limit); };
    const auto high = [&](std::size_t i) { return IsBeyond(q.high[i], limit); };
    r.surely = Longest(a.sampled_times, period, [&](std::size_t i) { return low(i) && high(i); });
    r.possibly = Longest(a.sampled_times, period, [&](std::size_t i) { return low(i) || high(i); });
  }
  r.verdict = VerdictOf(r);
  return r;
}

// Returns nothing if the hand has no ratio.
std::optional<LimitResult> ComparedRatio(const UserLimit& limit, const Assessment& a) {
  const auto activity = std::ranges::find(a.hand_activity, limit.kind->hand, &HandActivity::hand);
  if (activity == a.hand_activity.end() || std::isnan(activity->ratio)) return {};
  LimitResult r{.limit = limit, .worst = activity->ratio};
  if (IsBeyond(activity->ratio, limit)) {
    r.verdict = Verdict::kExceeded;
    r.share = 1;
    r.longest = a.duration;
  } else {
    r.verdict = activity->stated ? Verdict::kKept : Verdict::kUncertain;
  }
  return r;
}

std::optional<LimitResult> ComparedOverTime(const UserLimit& limit, const Assessment& a) {
  const auto q = std::ranges::find(a.quantities, limit.kind, &QuantityResult::kind);
  const auto known = [](double x) { return std::isfinite(x); };
  if (q == a.quantities.end() || std::ranges::none_of(q->values, known)) return {};
  return Compared(limit, *q, a);
}

// Returns "trunk flexion (EDITION, clause)", for example.
std::string LabelOf(const UserLimit& limit, const std::string& edition) {
  const std::string clause = limit.clause.empty() ? "" : ", " + Printable(limit.clause);
  return std::string(limit.kind->label) + " (" + Printable(edition) + clause + ")";
}

std::string ValueWithUnit(const QuantityKind& kind, double x) {
  const std::string unit = kind.unit.shown;
  return ValueText(kind, x) + (unit.empty() || unit == "°" ? "" : " ") + unit;
}

}  // namespace

UserLimits ParseUserLimits(const std::string& text, const std::string& name) {
  const ergonomics::LimitTable table = ergonomics::ParseLimitTable(text, name, kColumns);
  UserLimits limits;
  limits.edition = table.edition;
  for (const ergonomics::LimitRow& row : table.rows) limits.rows.push_back(LimitOf(row));
  return limits;
}

UserLimits ReadUserLimits(const std::filesystem::path& file) {
  return ParseUserLimits(ergonomics::ReadLimitFile(file), file.string());
}

const char* Name(Verdict verdict) {
  constexpr const char* kNames[] = {"kept", "exceeded", "uncertain"};
  return kNames[static_cast<std::size_t>(verdict)];
}

void JudgeUserLimits(const UserLimits& limits, Assessment* a) {
  for (const UserLimit& limit : limits.rows) {
    const auto result = limit.kind->of ? ComparedOverTime(limit, *a) : ComparedRatio(limit, *a);
    if (!result) {
      a->not_evaluable.push_back({"the limit of " + LabelOf(limit, limits.edition),
                                  "this run has no values of " + std::string(limit.kind->path)});
      continue;
    }
    a->limits.push_back(*result);
    a->limits.back().edition = limits.edition;
  }
}

std::string Sentence(const LimitResult& r) {
  const QuantityKind& kind = *r.limit.kind;
  if (!kind.of)
    return Formatted(
        "%s, limit %s: %s. The whole run has %s%s.", LabelOf(r.limit, r.edition).c_str(),
        ValueWithUnit(kind, r.limit.value).c_str(), Name(r.verdict),
        ValueWithUnit(kind, r.worst).c_str(), r.verdict == Verdict::kUncertain ? " or more" : "");
  std::string text = Formatted(
      "%s, limit %s: %s. Worst %s. Beyond the limit for %.1f %% of the time, at most %.1f s at a "
      "time",
      LabelOf(r.limit, r.edition).c_str(), ValueWithUnit(kind, r.limit.value).c_str(),
      Name(r.verdict), ValueWithUnit(kind, r.worst).c_str(), 100 * r.share, r.longest);
  if (r.surely) Append(&text, " (surely %.1f s, possibly %.1f s)", *r.surely, *r.possibly);
  return text + Formatted("; allowed %.1f s.", r.limit.allowed);
}

}  // namespace predictor::assessment
