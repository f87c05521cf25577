// YAML as a tree with the place of every node. Only this module uses the YAML library.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace predictor {

// The place of a node in its source.
struct Place {
  std::shared_ptr<const std::string> source;  // a file name, or the text of an override
  int line = 0, column = 0;                   // starts at 1; 0: the whole source

  std::string Text() const;  // "file:line:column", or only the source; may be empty
};

struct YamlNode {
  enum class Kind { kNull, kScalar, kList, kMap };
  Kind kind = Kind::kNull;
  Place place;
  std::string text;             // text of a scalar
  bool quoted = false;          // a scalar in quotation marks is always a string
  std::vector<YamlNode> items;  // items of a list or a map, in the file's order
  std::string key;              // key, for an item of a map
  Place key_place;
  std::string comment;  // comment after the key

  const YamlNode* Find(const std::string& name) const;  // Finds an item of a map; null if absent.
  YamlNode* Find(const std::string& name);
};

inline constexpr std::size_t kMaxYamlBytes = 1u << 20;
inline constexpr int kMaxYamlDepth = 32;
inline constexpr int kMaxYamlNodes = 50000;

// Returns the text of a file, but at most one byte more than the permitted length. `what` names the
// expected content, such as "a scenario". Throws InputError.
std::string ReadYamlText(const std::filesystem::path& file, const std::string& what);

// Reads one document of at most kMaxYamlBytes. Throws InputError for invalid UTF-8, anchors and
// aliases, tags, several documents, duplicate keys, keys that are not plain words, and trees that
// exceed the above limits of depth and nodes. The error is thrown before a tree beyond these limits
// is built.
YamlNode ParseYaml(const std::string& text, const std::string& source);

// Returns the value at "path.to.key", or null if there is no such value. In a path, the index of a
// list entry counts from 0.
const YamlNode* NodeAt(const std::string& path, const YamlNode& root);

// Returns the place of the value at "path.to.key", or of the innermost existing group around it.
Place PlaceOf(const std::string& path, const YamlNode& root);

// Applies the override `path.to.key=value`. In the path, the index of a list entry counts from 0.
// The value is YAML. Throws InputError.
void ApplyOverride(const std::string& assignment, YamlNode* root);

// Returns the tree as text that ParseYaml can read. Maps are written as blocks, and a list of
// scalars is written in one line.
std::string WriteYaml(const YamlNode& root);

}  // namespace predictor
