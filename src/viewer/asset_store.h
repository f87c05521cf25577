// Everything that is served by HTTP, held in memory: no request reaches the file system.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "models/urdf.h"

namespace predictor {

struct Asset {
  std::string bytes;
  std::string type;          // as in Content-Type
  bool needs_token = false;  // part of the run's data
};

class AssetStore {
 public:
  static constexpr std::size_t kMostBytes = 256u << 20;  // of all assets together

  explicit AssetStore(std::size_t most_bytes = kMostBytes) : most_bytes_(most_bytes) {}

  // The three files of the page at "/", "/app.js" and "/app.css", without a token.
  void AddPage();

  // Reads a robot's or object's URDF with its meshes; the file names in it become the served ones
  // ("0.dae"), comments are left out. Returns the URDF's path, "/models/N/model.urdf"; the same
  // model again gets the same N. Throws InputError if a mesh cannot be read, or if the assets
  // would grow beyond the limit.
  std::string AddModel(const UrdfModel& urdf);

  // Throws InputError beyond the limit.
  void Add(const std::string& path, Asset asset);

  // Exact match, no decoding: nullptr for anything else.
  const Asset* Find(std::string_view path) const;
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::map<std::string, Asset, std::less<>> assets_;
  std::map<std::string, std::string> models_;  // URDF as read -> path
};

}  // namespace predictor
