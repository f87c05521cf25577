#include "analysis/population/run_store.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace predictor::population {
namespace {

using Json = nlohmann::ordered_json;

std::string PlaceOf(const std::string& key, int person) {
  return key + "/" + std::to_string(person);
}

// Reads a number. null stands for a value that is not finite.
double NumberOf(const Json& json) { return json.is_null() ? std::nan("") : json.get<double>(); }

bool ReadRun(const Json& json, PopulationRun* run) {
  run->person = json.at("person");
  run->cause = static_cast<StopCause>(json.at("cause").get<int>());
  run->held = json.at("held_s");
  for (const Json& value : json.at("values")) run->values.push_back(NumberOf(value));
  const Json& shares = json.at("rula_share");
  if (shares.size() != kRulaScores || run->values.size() != StudyQuantities().size()) return false;
  for (std::size_t i = 0; i < kRulaScores; ++i) run->rula_share[i] = shares[i];
  const int cause = static_cast<int>(run->cause);
  return cause >= 0 && cause < kStopCauses;
}

Json ToJson(const PopulationRun& run) {
  return {{"person", run.person},
          {"cause", static_cast<int>(run.cause)},
          {"held_s", run.held},
          {"values", run.values},  // not finite: null
          {"rula_share", run.rula_share}};
}

}  // namespace

std::string TextOf(const PopulationRun& run) { return ToJson(run).dump(); }

PopulationRunStore::PopulationRunStore(const std::filesystem::path& file) : file_(file) {
  Read();
  out_.open(file, std::ios::app);
  if (!out_)
    throw InputError("'" + file.string() + "' could not be written. Give a writable folder.");
}

void PopulationRunStore::Read() {
  std::ifstream in(file_);
  bool whole = true;  // the last line is complete
  for (std::string line; std::getline(in, line);) {
    whole = !in.eof();
    const Json json = Json::parse(line, nullptr, false);
    PopulationRun run;
    try {
      if (!json.is_discarded() && ReadRun(json.at("run"), &run))
        runs_[PlaceOf(json.at("key"), run.person)] = run;
    } catch (const Json::exception&) {
      continue;
    }
  }
  if (!whole) std::ofstream(file_, std::ios::app) << '\n';
}

bool PopulationRunStore::Find(const std::string& key, PopulationRun* run) const {
  const auto found = runs_.find(PlaceOf(key, run->person));
  if (found == runs_.end()) return false;
  *run = found->second;
  return true;
}

void PopulationRunStore::Add(const std::string& key, const PopulationRun& run) {
  const std::string line = Json{{"key", key}, {"run", ToJson(run)}}.dump() + "\n";
  const std::lock_guard lock(mutex_);
  out_ << line;
  if (!out_.flush())
    throw InputError("'" + file_.string() +
                     "' could not be written. Give a writable folder on a disk with free space.");
}

}  // namespace predictor::population
