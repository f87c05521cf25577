// Stores the finished pieces of a study in a file, so that they survive an interruption.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

namespace predictor {

// The file has one line of JSON per piece, appended and flushed as soon as the piece is finished.
// Unreadable lines (such as the last line of a killed study) are skipped.
class JsonLineStore {
 public:
  using Json = nlohmann::ordered_json;

  // Reads the file. Throws InputError if it cannot be written.
  explicit JsonLineStore(const std::filesystem::path& file);

  // Returns the piece with this key if the file contained it at the start, or null. The piece may
  // come from another version of the program.
  const Json* Find(const std::string& key) const;
  // `piece` is an object without the member "key". Any thread may call this function. Throws
  // InputError if the file cannot be written.
  void Add(const std::string& key, const Json& piece);

 private:
  void Flush();

  std::map<std::string, Json> pieces_;
  std::filesystem::path file_;
  std::ofstream out_;
  std::mutex mutex_;
};

// Returns a 64-bit hash of the text as hexadecimal digits (FNV-1a), which serves as a key. The hash
// distinguishes contents but does not protect secrets.
std::string HexHash(const std::string& text);

}  // namespace predictor
