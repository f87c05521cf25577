#include "analysis/population/run_json.h"

#include <cmath>
#include <utility>

namespace predictor::population {
namespace {

using Json = nlohmann::ordered_json;

// Reads a number. null stands for a value that is not finite.
double NumberOf(const Json& json) { return json.is_null() ? std::nan("") : json.get<double>(); }

}  // namespace

Json JsonOf(const PopulationRun& run) {
  return {{"person", run.person},         {"cause", static_cast<int>(run.cause)},
          {"held_s", run.held},           {"values", run.values},  // not finite: null
          {"rula_share", run.rula_share}, {"beyond_lifft", run.beyond_lifft}};
}

bool ReadRun(const Json& json, PopulationRun* run) try {
  PopulationRun read;
  read.person = json.at("person");
  const int cause = json.at("cause");
  read.cause = static_cast<StopCause>(cause);
  read.held = json.at("held_s");
  for (const Json& value : json.at("values")) read.values.push_back(NumberOf(value));
  const Json& shares = json.at("rula_share");
  if (shares.size() != kRulaScores || read.values.size() != StudyQuantities().size()) return false;
  for (std::size_t i = 0; i < kRulaScores; ++i) read.rula_share[i] = shares[i];
  read.beyond_lifft = json.at("beyond_lifft");
  if (cause < 0 || cause >= kStopCauses) return false;
  *run = std::move(read);
  return true;
} catch (const Json::exception&) {
  return false;
}

}  // namespace predictor::population
