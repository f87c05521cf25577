// YAML as a tree that remembers where everything stood. The only door to the YAML library.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace predictor {

// Where something was written.
struct Place {
  std::shared_ptr<const std::string> source;  // a file's name, or an override as it was typed
  int line = 0, column = 0;                   // from 1; 0: the whole source

  std::string Text() const;  // "file:line:column", or the source alone
};

struct YamlNode {
  enum class Kind { kNull, kScalar, kList, kMap };
  Kind kind = Kind::kNull;
  Place place;
  std::string text;             // of a scalar
  bool quoted = false;          // a scalar in quotation marks: a string whatever it looks like
  std::vector<YamlNode> items;  // of a list or a map, in the file's order
  std::string key;              // of an item of a map
  Place key_place;
  std::string comment;  // written behind the key

  const YamlNode* Find(const std::string& name) const;  // in a map; null if absent
  YamlNode* Find(const std::string& name);
};

inline constexpr std::size_t kMostYamlBytes = 1u << 20;
inline constexpr int kMostYamlDepth = 32;
inline constexpr int kMostYamlNodes = 50000;

// The text of a file, at most one byte more than is allowed. `what` it should be: "a scenario".
// Throws InputError.
std::string ReadYamlText(const std::filesystem::path& file, const std::string& what);

// Reads one document of at most kMostYamlBytes. Refuses, by InputError, what is not UTF-8, anchors
// and aliases, tags, several documents, duplicate keys, keys that are not plain words, and more
// depth or nodes than above; all before a tree larger than those bounds exists.
YamlNode ParseYaml(const std::string& text, const std::string& source);

// Where the value at "path.to.key" stands, or the innermost group around it that is there.
Place PlaceOf(const std::string& path, const YamlNode& root);

// Sets `path.to.key=value` (list entries by number from 0). The value is YAML. Throws InputError.
void ApplyOverride(const std::string& assignment, YamlNode* root);

// The tree as text that ParseYaml reads back: maps as blocks, lists of scalars in one line.
std::string WriteYaml(const YamlNode& root);

}  // namespace predictor
