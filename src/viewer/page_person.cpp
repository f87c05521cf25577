// Writes the table of a person's state as TypeScript.
#include <concepts>
#include <string>
#include <vector>

#include "core/person_state.h"
#include "core/text.h"
#include "viewer/frame.h"

namespace predictor::viewer {
namespace {

// Collects the members of an object with their types.
class TypeVisitor {
 public:
  void Number(const char* name, const char* unit, const char* meaning,
              const std::floating_point auto&) {
    Add(name, "number | null", unit, meaning);
  }
  void Number(const char* name, const char* unit, const char* meaning, const std::integral auto&) {
    Add(name, "number", unit, meaning);
  }
  void Flag(const char* name, const char* meaning, const auto&) {
    Add(name, "boolean", "", meaning);
  }
  void Word(const char* name, const char* meaning, const auto& names, std::size_t) {
    Add(name, Union(names), "", meaning);
  }
  void Words(const char* name, const char* meaning, const auto& names, const auto&) {
    Add(name, "(" + Union(names) + ")[]", "", meaning);
  }
  void Vector(const char* name, const char* meaning, const auto&, bool) {
    Add(name, "[number, number, number] | null", "", meaning);
  }
  void List(const char* name, const char* meaning, const auto&, std::size_t) {
    Add(name, "number[] | null", "", meaning);
  }
  void Group(const char* name, const char* meaning, const auto& visit) {
    TypeVisitor inner;
    visit(inner);
    Add(name, inner.Type(), "", meaning);
  }

  // Returns a record type if all members have the same type, otherwise an object type.
  std::string Type() const {
    std::string names, all;
    bool same = true;
    for (const Member& member : members_) {
      names += (names.empty() ? "'" : " | '") + member.name + "'";
      all += (all.empty() ? "" : "; ") + member.name + ": " + member.type;
      same = same && member.type == members_.front().type;
    }
    return same ? "Record<" + names + ", " + members_.front().type + ">" : "{" + all + "}";
  }
  std::string Interface(const char* name) const {
    std::string text = std::string("export interface ") + name + " {\n  type: 'person';\n";
    for (const Member& member : members_)
      text += "  " + member.name + ": " + member.type + ";" +
              (member.comment.empty() ? "" : "  // " + member.comment) + "\n";
    return text + "}\n";
  }

 private:
  struct Member {
    std::string name, type, comment;
  };
  static std::string Union(const auto& names) {
    std::string text;
    for (const char* name : names) text += std::string(text.empty() ? "'" : " | '") + name + "'";
    return text;
  }
  void Add(const char* name, const std::string& type, const std::string& unit,
           const std::string& meaning) {
    const std::string comment = unit.empty() ? "" : "[" + unit + "]";
    members_.push_back(
        {name, type, comment + (comment.empty() || meaning.empty() ? "" : " ") + meaning});
  }

  std::vector<Member> members_;
};

// export const `list` = {name: {…}, …}.
template <class Rows, class Content>
std::string Table(const char* list, const Rows& rows, const Content& content) {
  std::string text = std::string("\nexport const ") + list + " = {\n";
  for (const auto& row : rows) text += std::string("  ") + row.name + ": {" + content(row) + "},\n";
  return text + "} as const;\n";
}

}  // namespace

std::string PagePerson() {
  TypeVisitor visitor;
  const PersonState state;
  VisitPerson(visitor, state);
  const auto flag = [](bool x) { return x ? "true" : "false"; };
  return "// Generated from src/core/person_state.h: build/release/bin/page_quantities person "
         "writes this file.\n\n" +
         visitor.Interface("PersonState") +
         Table("kPersonGauges", kPersonGaugeRows,
               [&](const PersonGaugeRow& row) {
                 return std::string("unit: '") + row.unit + "', limit: " + FormatNumber(row.limit) +
                        ", lowIsBad: " + flag(row.low_is_bad) + ", source: '" +
                        kGaugeSourceNames[static_cast<std::size_t>(row.source)] + "', meaning: '" +
                        row.meaning + "'";
               }) +
         Table("kPersonScores", kPersonScoreRows,
               [](const PersonScoreRow& row) {
                 return "most: " + std::to_string(row.most) +
                        ", levels: " + std::to_string(row.classes);
               }) +
         Table("kPersonWarnings", kPersonWarningRows, [](const PersonWarningRow& row) {
           return std::string("words: '") + row.words + "'";
         });
}

}  // namespace predictor::viewer
