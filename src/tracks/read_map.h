// Reads the mapping (YAML) of a file of another system.
#pragma once

#include <string>

#include "core/error.h"
#include "scenario/field_reader.h"
#include "tracks/track_map_fields.h"

namespace predictor::tracks {

// Reads a mapping from `text` and calls check(map, root, &problems). `begin` is the first line of a
// valid mapping, for the message, and `name` names the text. Throws InputError with all problems.
template <class Map, class Check>
Map ReadMap(const std::string& text, const std::string& name, const std::string& begin,
            const Check& check) {
  const YamlNode root = ParseYaml(text, name);
  if (root.kind != YamlNode::Kind::kMap)
    throw InputError(root.place.Text(), "a mapping must be a group of keys, but this is " +
                                            Describe(root) + ". Begin with \"" + begin + "\".");
  Problems problems;
  auto map = ReadStruct<Map>(root, &problems);
  problems.ThrowIfAny();
  check(map, root, &problems);
  problems.ThrowIfAny();
  return map;
}

}  // namespace predictor::tracks
