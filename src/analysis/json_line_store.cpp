#include "analysis/json_line_store.h"

#include <cinttypes>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor {

JsonLineStore::JsonLineStore(const std::filesystem::path& file) : file_(file) {
  bool whole = true;  // the last line is complete
  if (std::ifstream in(file); in) {
    for (std::string line; std::getline(in, line);) {
      whole = !in.eof();
      const Json json = Json::parse(line, nullptr, false);
      if (json.is_object() && json.contains("key") && json.at("key").is_string())
        pieces_[json.at("key").get<std::string>()] = json;
    }
  }
  out_.open(file, std::ios::app);
  if (!whole) out_ << '\n';
  Flush();
}

const JsonLineStore::Json* JsonLineStore::Find(const std::string& key) const {
  const auto found = pieces_.find(key);
  return found == pieces_.end() ? nullptr : &found->second;
}

void JsonLineStore::Add(const std::string& key, const Json& piece) {
  Json line = {{"key", key}};
  line.update(piece);
  const std::lock_guard lock(mutex_);
  out_ << line.dump() << '\n';
  Flush();
}

void JsonLineStore::Flush() {
  if (!out_.flush())
    throw InputError("'" + file_.string() +
                     "' could not be written. Give a writable folder on a disk with free space.");
}

std::string HexHash(const std::string& text) { return Formatted("%016" PRIx64, Fnv1a(text)); }

}  // namespace predictor
