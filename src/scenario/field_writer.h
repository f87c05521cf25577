// Writes structs into a tree, including all defaults and a comment for each key.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "scenario/field_values.h"
#include "scenario/field_walk.h"

namespace predictor {

// Writes the members of a struct into a group of keys.
class FieldWriter {
 public:
  explicit FieldWriter(YamlNode* group) : group_(group) { group->kind = YamlNode::Kind::kMap; }

  template <class T>
  void operator()(const char* key, T& member, const Rule& rule) {
    YamlNode node = WriteMember(rule, member);
    node.key = key;
    node.comment = rule.unit.empty() ? rule.doc : "[" + rule.unit + "] " + rule.doc;
    group_->items.push_back(std::move(node));
  }

  template <class Walk>
  void Group(const char* key, const char* doc, Walk walk) {
    YamlNode node;
    FieldWriter writer(&node);
    walk(writer);
    node.key = key;
    node.comment = doc;
    group_->items.push_back(std::move(node));
  }

  template <class Walk>
  void Own(const char* key, std::string& type, YamlNode& parameters, const Rule& rule,
           ParameterKinds kinds, Walk common) {
    (*this)(key, type, rule);
    common(*this);
    for (YamlNode& item : CompleteParameters(kinds, type, parameters).items)
      group_->items.push_back(std::move(item));
  }

 private:
  template <class T>
  static YamlNode WriteMember(const Rule& rule, T& member) {
    YamlNode node;
    if constexpr (IsStruct<T, FieldWriter>) {
      FieldWriter writer(&node);
      Fields(writer, member);
    } else if constexpr (IsOptional<T>) {
      if (member) return WriteMember(rule, *member);
      if (rule.absent != "null") return Write(rule, rule.absent);
    } else if constexpr (IsStructList<T, FieldWriter>) {
      node.kind = YamlNode::Kind::kList;
      for (auto& entry : member) node.items.push_back(WriteMember(rule, entry));
    } else if constexpr (std::is_enum_v<T>) {
      return Write(rule, NamesOf(member)[static_cast<std::size_t>(member)]);
    } else {
      return Write(rule, member);
    }
    return node;
  }

  YamlNode* group_;
};

template <class T>
YamlNode WriteStruct(T value) {  // visitors treat the struct as mutable
  YamlNode root;
  FieldWriter writer(&root);
  Fields(writer, value);
  return root;
}

}  // namespace predictor
