// Lets a scenario extend another one by the key `extends` at the top of its file.
#pragma once

#include <filesystem>

#include "scenario/yaml_tree.h"

namespace predictor {

inline constexpr const char* kExtendsKey = "extends";
inline constexpr int kMaxExtends = 8;  // maximum number of files that extend one another

// Adds to `root` the tree of the file that it extends, and recursively the trees that this file
// extends. `file` is the file from which `root` was read. Groups are joined key by key, whereas a
// list or a single value replaces the extended one. A group with a different `type` replaces the
// whole group, because the parameters of another type do not apply to it. Every node keeps its
// original place. The extended file must be in the folder of `file` or below. Throws InputError.
void ExtendTree(const std::filesystem::path& file, YamlNode* root);

}  // namespace predictor
