// Reads structs from a tree according to their field tables (fields.h).
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/text.h"
#include "scenario/field_values.h"
#include "scenario/field_walk.h"

namespace predictor {

// Applies the field table of a struct to a group of keys.
class FieldReader {
 public:
  FieldReader(const PathNode& at, Problems* problems) : at_(at), problems_(problems) {}

  template <class T>
  void operator()(const char* key, T& member, const Rule& rule) {
    if (naming_) return known_.push_back(key);
    const std::string path = at_.path.empty() ? key : at_.path + "." + key;
    if (const YamlNode* node = at_.node.Find(key)) return ReadMember({*node, path}, rule, &member);
    if (IsMisspelt(key)) return;
    if (rule.required) {
      problems_->Add(at_.node.place, path + " is missing. Give a value (" + rule.doc + ").");
    } else if constexpr (IsStruct<T, FieldReader>) {
      ReadMember({Nothing(), path}, rule, &member);  // reports missing required members
    }
  }

  template <class Walk>
  void Group(const char* key, const char*, Walk walk) {
    if (naming_) return known_.push_back(key);
    const std::string path = at_.path.empty() ? key : at_.path + "." + key;
    const YamlNode nothing = Nothing();
    const YamlNode* node = at_.node.Find(key);
    if (node == nullptr && IsMisspelt(key)) return;
    InGroup({node ? *node : nothing, path}, [&](FieldReader& reader) { walk(reader); });
  }

  template <class Walk>
  void Own(const char* key, std::string& type, YamlNode& parameters, const Rule& rule,
           ParameterKinds kinds, Walk common) {
    const YamlNode* word = at_.node.Find(key);
    const ParameterKind* kind = FindKind(kinds, word ? word->text : type);
    (*this)(key, type, rule);
    common(*this);
    if (word == nullptr && rule.required) return NameAll(kinds);  // the missing key is reported
    if (kind != nullptr) {
      const std::unique_ptr<OwnParameters> own = kind->parameters();
      AnyVisitor visitor(this);
      own->Walk(visitor);
      kind_ = kind;
      kind_key_ = key;
      kinds_ = kinds;
      if (!naming_) parameters = WriteParameters(own.get());
      return;
    }
    if (!naming_) parameters = Nothing();
    for (const YamlNode& item : at_.node.items) {  // the parameters of an unknown kind
      if (item.key == key) continue;
      known_.push_back(item.key);
      if (!naming_) parameters.items.push_back(item);
    }
  }

  // Reads everything that `walk` names, and then reports keys without a table entry.
  template <class Walk>
  void ReadAll(Walk walk) {
    naming_ = true;
    walk(*this);
    naming_ = false;
    FindMisspelt();
    walk(*this);
    RefuseUnknown();
  }

 private:
  using Kind = YamlNode::Kind;

  bool IsKnown(const std::string& key) const {
    return std::find(known_.begin(), known_.end(), key) != known_.end();
  }
  // Finds misspelt keys that are similar to a missing key. These misspelt keys are reported only
  // once, as unknown keys and not also as missing keys.
  void FindMisspelt() {
    for (const YamlNode& item : at_.node.items)
      if (misspelt_.size() < Problems::kMaxReported && !IsKnown(item.key))
        misspelt_.push_back(Nearest(item.key, known_));
  }
  bool IsMisspelt(const std::string& key) const {
    return std::find(misspelt_.begin(), misspelt_.end(), key) != misspelt_.end();
  }

  // Accepts the names of the parameters of every kind.
  void NameAll(ParameterKinds kinds) {
    for (const ParameterKind* kind : kinds)
      for (const YamlNode& item : WriteParameters(kind->parameters().get()).items)
        if (naming_) known_.push_back(item.key);
  }

  // Reports keys without a table entry.
  void RefuseUnknown() {
    const std::string where = at_.path.empty() ? "" : " of " + at_.path;
    for (const YamlNode& item : at_.node.items) {
      if (IsKnown(item.key) || RefuseForeign(item)) continue;
      // The search for a similar key is skipped if the problem will not be reported.
      const std::string hint = problems_->IsFull() ? "" : Suggestion(item.key, known_);
      std::string sentence = Quote(item.key);
      sentence.append(" is not a key").append(where).append(". ").append(hint);
      problems_->Add(item.key_place, sentence);
    }
  }

  // Reports a key that this kind does not have, but other kinds of the group have.
  bool RefuseForeign(const YamlNode& item) {
    if (kind_ == nullptr || problems_->IsFull()) return false;
    const std::vector<std::string> others = OthersWith(item.key, *kind_, kinds_);
    if (others.empty()) return false;
    std::string sentence = at_.path + "." + item.key;
    sentence.append(" has no effect in ").append(kind_->name).append("; it is a parameter of ");
    sentence.append(Join(others)).append(". Remove it, or set another ").append(kind_key_);
    sentence.append(".");
    problems_->Add(item.key_place, sentence);
    return true;
  }

  YamlNode Nothing() const {
    YamlNode nothing;
    nothing.kind = Kind::kMap;
    nothing.place = at_.node.place;
    return nothing;
  }

  template <class Walk>
  void InGroup(const PathNode& at, Walk walk) {
    FieldReader reader(at, problems_);
    if (at.node.kind != Kind::kMap) {
      return Complain(at, Rule{}, "a group of keys", problems_);
    }
    reader.ReadAll(walk);
  }

  template <class T>
  void ReadMember(const PathNode& at, const Rule& rule, T* member) {
    if constexpr (IsStruct<T, FieldReader>) {
      InGroup(at, [&](FieldReader& reader) { Fields(reader, *member); });
    } else if constexpr (IsOptional<T>) {
      ReadOptional(at, rule, member);
    } else if constexpr (IsStructList<T, FieldReader>) {
      ReadStructs(at, rule, member);
    } else if constexpr (std::is_enum_v<T>) {
      const Rule words = WordRule<T>(rule);
      std::string word;
      Read(at, words, problems_, &word);
      const auto found = std::find(words.choices.begin(), words.choices.end(), word);
      if (found != words.choices.end()) *member = static_cast<T>(found - words.choices.begin());
    } else {
      Read(at, rule, problems_, member);
    }
  }

  template <class T>
  void ReadOptional(const PathNode& at, const Rule& rule, std::optional<T>* member) {
    const bool is_word = at.node.kind == Kind::kScalar && at.node.text == rule.absent;
    const bool is_null = at.node.kind == Kind::kNull && rule.absent == "null";
    member->reset();
    if (is_word || is_null) return;
    ReadMember(at, rule, &member->emplace());
  }

  template <class T>
  void ReadStructs(const PathNode& at, const Rule& rule, std::vector<T>* members) {
    const std::vector<YamlNode>* entries = Entries(at, rule, problems_);
    if (entries == nullptr) return;
    members->assign(entries->size(), T{});
    for (std::size_t i = 0; i < entries->size(); ++i) {
      const PathNode entry{(*entries)[i], at.path + "." + std::to_string(i)};
      InGroup(entry, [&](FieldReader& reader) { Fields(reader, (*members)[i]); });
    }
  }

  PathNode at_;
  Problems* problems_;
  std::vector<std::string> known_;  // keys of this group
  std::vector<std::string> misspelt_;
  bool naming_ = false;                  // the keys are only being collected
  const ParameterKind* kind_ = nullptr;  // the kind whose own parameters are in this group
  std::string kind_key_;                 // the key that names the kind
  ParameterKinds kinds_;
};

// Reads every field of a group of keys and reports invalid values. A member with a missing or
// invalid value keeps its default.
template <class T>
T ReadStruct(const YamlNode& root, Problems* problems) {
  T result;
  FieldReader({root, ""}, problems).ReadAll([&](FieldReader& reader) { Fields(reader, result); });
  return result;
}

}  // namespace predictor
