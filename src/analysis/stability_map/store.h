// Stores the finished points of a stability map in a file, so that they survive an interruption.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <string>

#include "analysis/stability_map/stability_map.h"

namespace predictor {

// The file has one line of JSON per point, appended and flushed as soon as the point is finished.
// Unreadable lines (such as the last line of a killed run) are skipped. Any thread may call Add.
class MapStore {
 public:
  // Reads the file. Throws InputError if it cannot be written.
  explicit MapStore(const std::filesystem::path& file);

  // Loads the point with this key. Returns false if it is not stored.
  bool Find(const std::string& key, MapPoint* point) const;
  // Throws InputError if it cannot be written.
  void Add(const std::string& key, const MapPoint& point);

 private:
  void ReadLine(const std::string& line);
  void Flush();

  std::map<std::string, MapPoint> points_;
  std::filesystem::path file_;
  std::ofstream out_;
  std::mutex mutex_;
};

// Returns a 64-bit hash of the text as hexadecimal digits (FNV-1a). The hash distinguishes contents
// but does not protect secrets.
std::string HashOf(const std::string& text);

}  // namespace predictor
