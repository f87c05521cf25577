#include "scenario/kind_groups.h"

#include <string>
#include <utility>

#include "scenario/field_walk.h"

namespace predictor {
namespace {

// Visits the field tables that belong to the keys of a tree.
class KindFinder {
 public:
  KindFinder(YamlNode* group, std::string path, std::vector<KindGroup>* found)
      : group_(group), path_(std::move(path)), found_(found) {}

  template <class T>
  void operator()(const char* key, T& member, const Rule&) {
    if (YamlNode* node = group_->Find(key)) Look(node, PathOf(key), member);
  }

  template <class Walk>
  void Group(const char* key, const char*, Walk walk) {
    YamlNode* node = group_->Find(key);
    if (node == nullptr) return;
    KindFinder inner(node, PathOf(key), found_);
    walk(inner);
  }

  template <class Walk>
  void Own(const char* key, std::string&, YamlNode&, const Rule&, ParameterKinds kinds, Walk) {
    found_->push_back({path_, key, kinds, group_});
  }

 private:
  std::string PathOf(const std::string& key) const {
    return path_.empty() ? key : path_ + "." + key;
  }

  template <class T>
  void Look(YamlNode* node, const std::string& path, T& member) {
    if constexpr (IsStruct<T, KindFinder>) {
      KindFinder inner(node, path, found_);
      Fields(inner, member);
    } else if constexpr (IsOptional<T>) {
      typename T::value_type value{};
      Look(node, path, value);
    } else if constexpr (IsStructList<T, KindFinder>) {
      typename T::value_type value{};
      for (std::size_t i = 0; i < node->items.size(); ++i)
        Look(&node->items[i], path + "." + std::to_string(i), value);
    }
  }

  YamlNode* group_;
  std::string path_;
  std::vector<KindGroup>* found_;
};

}  // namespace

std::vector<KindGroup> KindGroups(YamlNode* root) {
  std::vector<KindGroup> found;
  Scenario scenario;
  KindFinder finder(root, "", &found);
  Fields(finder, scenario);
  return found;
}

}  // namespace predictor
