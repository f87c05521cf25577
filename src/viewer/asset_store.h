// Holds all files that are served by HTTP in memory, so that no request reaches the file system.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "models/urdf.h"

namespace predictor::viewer {

struct Asset {
  std::string bytes;
  std::string type;          // media type, as in Content-Type
  bool needs_token = false;  // part of the run's data
};

class AssetStore {
 public:
  static constexpr std::size_t kMaxBytes = 256u << 20;  // total of all assets

  explicit AssetStore(std::size_t max_bytes = kMaxBytes) : max_bytes_(max_bytes) {}

  // The address of the page that shows future events to the experimenter.
  static constexpr const char* kExperimenterPath = "/experimenter";

  // Adds the page's three files as "/" and kExperimenterPath, "/app.js" and "/app.css", which need
  // no token.
  void AddPage();

  // Reads the URDF of a robot or object with its meshes. Replaces the file names in the URDF with
  // served names ("0.dae") and removes comments. Returns the URDF's path, "/models/N/model.urdf",
  // where the same model always gets the same N. Throws InputError if a mesh cannot be read, or if
  // the assets would exceed the limit.
  std::string AddModel(const UrdfModel& urdf);

  // Throws InputError if the assets would exceed the limit.
  void Add(const std::string& path, Asset asset);

  // Finds only paths that match exactly, and does not decode the path. Returns nullptr for any
  // other path.
  const Asset* Find(std::string_view path) const;
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::map<std::string, Asset, std::less<>> assets_;
  std::map<std::string, std::string> models_;  // URDF text -> path
};

}  // namespace predictor::viewer
