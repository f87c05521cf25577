// Stores the finished runs of a hazard study in a CSV file, so that they survive an interruption.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <string>

#include "analysis/hazard_study/hazard_study.h"

namespace predictor {

// A run is identified by its seed and by the key of its cell. Unreadable lines (such as the last
// line of a killed study) are skipped. Any thread may call Add.
class HazardRunStore {
 public:
  // Reads the file. Throws InputError if the file cannot be written.
  explicit HazardRunStore(const std::filesystem::path& file);

  // Loads the run. Returns false if the run is not stored.
  bool Find(const std::string& key, std::uint64_t seed, HazardRun* run) const;
  // `key` is a hash of the cell's scenario and of the program's behaviour. Throws InputError if the
  // file cannot be written.
  void Add(const std::string& key, const HazardCell& cell, const HazardRun& run);

 private:
  void Read();
  void Write(const std::string& line);

  std::map<std::string, HazardRun> runs_;
  std::filesystem::path file_;
  std::ofstream out_;
  std::mutex mutex_;
};

// Returns the numbers of a run as cells of a row, without the run's key and names.
std::string TextOf(const HazardRun& run);

}  // namespace predictor
