// Points of a stability map that are finished, in a file that survives an interruption.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <string>

#include "analysis/stability_map/stability_map.h"

namespace predictor {

// One line of JSON a point, appended and flushed when the point is finished. Lines that cannot be
// read (the last one of a run that was killed) are passed over. Add may be called by any thread.
class MapStore {
 public:
  // Reads what the file holds. Throws InputError if it cannot be written.
  explicit MapStore(const std::filesystem::path& file);

  // Copies what is known of the point with this key; false if nothing is.
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

// 64 bits of text as hexadecimal digits (FNV-1a). For telling contents apart, not for secrets.
std::string HashOf(const std::string& text);

}  // namespace predictor
