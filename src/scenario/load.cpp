#include <algorithm>
#include <fstream>
#include <memory>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "scenario/checks.h"
#include "scenario/field_values.h"
#include "scenario/field_walk.h"
#include "scenario/scenario_io.h"
#include "scenario/scenario_tree.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;
using Kind = YamlNode::Kind;

// Walks the field table of a struct over a group of keys.
class Reader {
 public:
  Reader(const PathNode& at, Problems* problems) : at_(at), problems_(problems) {}

  template <class T>
  void operator()(const char* key, T& member, const Rule& rule) {
    known_.push_back(key);
    const std::string path = at_.path.empty() ? key : at_.path + "." + key;
    if (const YamlNode* node = at_.node.Find(key)) return ReadMember({*node, path}, rule, &member);
    if (rule.required) {
      problems_->Add(at_.node.place, path + " is missing; give it (" + rule.doc + ").");
    } else if constexpr (IsStruct<T, Reader>) {
      ReadMember({Nothing(), path}, rule, &member);  // tells what it requires
    }
  }

  template <class Walk>
  void Group(const char* key, const char*, Walk walk) {
    known_.push_back(key);
    const std::string path = at_.path.empty() ? key : at_.path + "." + key;
    const YamlNode nothing = Nothing();
    const YamlNode* node = at_.node.Find(key);
    InGroup({node ? *node : nothing, path}, [&](Reader& reader) { walk(reader); });
  }

 private:
  YamlNode Nothing() const {
    YamlNode nothing;
    nothing.kind = Kind::kMap;
    nothing.place = at_.node.place;
    return nothing;
  }

  // Reads the group at a node by `walk`; then complains about keys that no table entry asked for.
  template <class Walk>
  void InGroup(const PathNode& at, Walk walk) {
    Reader reader(at, problems_);
    if (at.node.kind != Kind::kMap) {
      return Complain(at, Rule{}, "a group of keys", problems_);
    }
    walk(reader);
    reader.RefuseUnknown();
  }

  template <class T>
  void ReadMember(const PathNode& at, const Rule& rule, T* member) {
    if constexpr (IsStruct<T, Reader>) {
      InGroup(at, [&](Reader& reader) { Fields(reader, *member); });
    } else if constexpr (IsOptional<T>) {
      ReadOptional(at, rule, member);
    } else if constexpr (IsStructList<T, Reader>) {
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
      InGroup(entry, [&](Reader& reader) { Fields(reader, (*members)[i]); });
    }
  }

  void RefuseUnknown() {
    const std::string where = at_.path.empty() ? "" : " of " + at_.path;
    for (const YamlNode& item : at_.node.items) {
      if (std::find(known_.begin(), known_.end(), item.key) != known_.end()) continue;
      // What will not be told needs no search for its neighbours.
      const std::string hint = problems_->IsFull() ? "" : Suggestion(item.key, known_);
      std::string sentence = Quote(item.key);
      sentence.append(" is not a key").append(where).append(". ").append(hint);
      problems_->Add(item.key_place, sentence);
    }
  }

  PathNode at_;
  Problems* problems_;
  std::vector<std::string> known_;

  friend Scenario predictor::ReadFields(const YamlNode& root, Problems* problems);
};

std::string ReadText(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) {
    throw InputError(file.string(), "there is no such file. Give the path of a scenario.");
  }
  if (!fs::is_regular_file(status)) {
    throw InputError(file.string(), "it is not a file. Give the path of a scenario.");
  }
  std::ifstream stream(file, std::ios::binary);
  std::string text(kMostYamlBytes + 1, '\0');  // one more than is allowed shows that it is too much
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.eof() && !stream) throw InputError(file.string(), "it cannot be read.");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

}  // namespace

Scenario ReadFields(const YamlNode& root, Problems* problems) {
  Scenario scenario;
  Reader reader({root, ""}, problems);
  Fields(reader, scenario);
  reader.RefuseUnknown();
  return scenario;
}

Scenario ParseScenario(const std::string& text, const std::string& name, const fs::path& folder,
                       const std::vector<std::string>& overrides) {
  YamlNode root = ParseYaml(text, name);
  if (root.kind != Kind::kMap) {
    throw InputError(root.place.Text(), "a scenario is a group of keys, and this is " +
                                            Describe(root) + ". Begin with \"predictor: 1\".");
  }
  for (const std::string& assignment : overrides) ApplyOverride(assignment, &root);
  Problems problems;
  Scenario scenario = ReadFields(root, &problems);
  problems.ThrowIfAny();  // contradictions are looked for between good values only
  CheckScenario(scenario, root, &problems);
  problems.ThrowIfAny();
  scenario.file = folder / fs::path(name).filename();
  scenario.tree = std::make_shared<const YamlNode>(std::move(root));
  return scenario;
}

Scenario LoadScenario(const fs::path& file, const std::vector<std::string>& overrides) {
  Scenario scenario = ParseScenario(ReadText(file), file.string(), file.parent_path(), overrides);
  scenario.file = file;
  return scenario;
}

}  // namespace predictor
