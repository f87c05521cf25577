#include "scenario/extend.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "scenario/paths.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;
using Kind = YamlNode::Kind;

bool ChangesType(const YamlNode& below, const YamlNode& above) {
  const YamlNode *old_type = below.Find("type"), *new_type = above.Find("type");
  return new_type != nullptr && (old_type == nullptr || old_type->text != new_type->text);
}

// Joins two trees. The values in `above` override those in `below`.
void Join(YamlNode above, YamlNode* below) {
  if (above.kind != Kind::kMap || below->kind != Kind::kMap || ChangesType(*below, above)) {
    *below = std::move(above);
    return;
  }
  for (YamlNode& item : above.items) {
    if (YamlNode* same = below->Find(item.key))
      Join(std::move(item), same);
    else
      below->items.push_back(std::move(item));
  }
  below->place = above.place;
  below->key_place = above.key_place;
}

// Removes `extends` from the tree. Returns the file that `extends` names, or an empty path if the
// key did not exist.
fs::path TakeExtended(const fs::path& file, YamlNode* root, Place* place) {
  const YamlNode* node = root->Find(kExtendsKey);
  if (node == nullptr) return {};
  *place = node->place;
  if (node->kind != Kind::kScalar || node->text.empty())
    throw InputError(place->Text(), "extends must be the path of a scenario.");
  const fs::path folder = Canonical(file.parent_path().empty() ? "." : file.parent_path());
  const fs::path target = Canonical(folder / node->text);
  if (!IsInside(target, folder))
    throw InputError(place->Text(),
                     "extends is " + Quote(node->text) + ", which is outside " + folder.string() +
                         ". Move the extended scenario into this folder or a subfolder.");
  root->items.erase(root->items.begin() + (node - root->items.data()));
  // The name of the file is relative to the same folder as the name of the extending file, because
  // messages show both names.
  return file.parent_path() / fs::path(target).lexically_relative(folder);
}

}  // namespace

void ExtendTree(const fs::path& file, YamlNode* root) {
  std::vector<fs::path> files = {Canonical(file)};
  std::vector<YamlNode> layers = {std::move(*root)};
  Place place;
  for (fs::path next = TakeExtended(file, &layers.back(), &place); !next.empty();
       next = TakeExtended(next, &layers.back(), &place)) {
    const fs::path canonical = Canonical(next);
    if (std::find(files.begin(), files.end(), canonical) != files.end())
      throw InputError(place.Text(), "extends leads back to " + next.string() +
                                         ". A scenario must not extend itself.");
    if (files.size() == kMaxExtends)
      throw InputError(place.Text(), "more than " + std::to_string(kMaxExtends) +
                                         " scenarios extend one another.");
    if (!fs::is_regular_file(canonical))
      throw InputError(place.Text(),
                       "extends is " + Quote(next.string()) + ", but this file does not exist.");
    files.push_back(canonical);
    layers.push_back(ParseYaml(ReadYamlText(next, "a scenario"), next.string()));
    if (layers.back().kind != Kind::kMap)
      throw InputError(layers.back().place.Text(), "a scenario must be a group of keys.");
  }
  *root = std::move(layers.back());
  for (layers.pop_back(); !layers.empty(); layers.pop_back()) Join(std::move(layers.back()), root);
}

}  // namespace predictor
