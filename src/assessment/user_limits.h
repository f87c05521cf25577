// Compares a run with limits that a user copies from a standard, such as ISO 11226 or EN 1005-4.
// The program contains no such limits, because the standards may not be copied.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "assessment/quantities.h"

namespace predictor::assessment {

struct Assessment;

struct UserLimit {
  const QuantityKind* kind = nullptr;
  double value = 0;    // SI unit; beyond: above it, or below it if low values of `kind` are bad
  double allowed = 0;  // longest uninterrupted time beyond the limit [s]
  std::string clause;  // where the limit is in the standard
};

struct UserLimits {
  std::string edition;
  std::vector<UserLimit> rows;
};

// Parses the form of assets/limits_template.csv. A quantity has the key of QuantityKind::path, and
// its unit is the SI unit or the one in tables. Throws InputError with file and line.
UserLimits ParseUserLimits(const std::string& text, const std::string& name);
UserLimits ReadUserLimits(const std::filesystem::path& file);

enum class Verdict {
  kKept,       // also by the possible postures, if they were computed
  kExceeded,   // likewise
  kUncertain,  // some of the possible postures keep the limit, and some exceed it; or the value is
               // a lower bound that is within the limit
};
const char* Name(Verdict verdict);

// Times during which a hand holds no handle are not judged, and interrupt a time beyond the limit.
struct LimitResult {
  UserLimit limit;
  std::string edition;
  Verdict verdict = Verdict::kKept;
  double worst = 0;    // of the nominal posture, SI unit
  double share = 0;    // share of the time in which the nominal posture is beyond the limit
  double longest = 0;  // longest uninterrupted time of the nominal posture beyond it [s]
  // The same time while the whole 90 % interval is beyond the limit, and while at least one end of
  // it is [s]. Empty: the quantity has no interval.
  std::optional<double> surely, possibly;
};

// Adds a result to `limits` of the assessment for each limit, and a gap for each limit whose
// quantity the run does not have.
void JudgeUserLimits(const UserLimits& limits, Assessment* assessment);

std::string Sentence(const LimitResult& result);

}  // namespace predictor::assessment
