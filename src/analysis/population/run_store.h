// Stores the finished runs of a population study, so that they survive an interruption.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <string>

#include "analysis/population/population.h"

namespace predictor::population {

// The file has one line of JSON per run. A run is identified by the key of its design and the
// number of its person. Unreadable lines (such as the last line of a killed study) are skipped. Any
// thread may call Add.
class PopulationRunStore {
 public:
  // Reads the file. Throws InputError if the file cannot be written.
  explicit PopulationRunStore(const std::filesystem::path& file);

  // Loads the run. Returns false if the run is not stored.
  bool Find(const std::string& key, PopulationRun* run) const;
  // Throws InputError if the file cannot be written.
  void Add(const std::string& key, const PopulationRun& run);

 private:
  void Read();

  std::map<std::string, PopulationRun> runs_;
  std::filesystem::path file_;
  std::ofstream out_;
  std::mutex mutex_;
};

// Returns the results of a run as JSON.
std::string TextOf(const PopulationRun& run);

}  // namespace predictor::population
