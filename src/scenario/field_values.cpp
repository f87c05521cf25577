#include "scenario/field_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "core/text.h"
#include "scenario/yaml_scalar.h"

namespace predictor {
namespace {

using Kind = YamlNode::Kind;

constexpr std::string_view kDegreesSuffix = " deg";
constexpr std::string_view kMetresSuffix = " m";

std::string WithUnit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : text + " " + unit;
}

// Returns an end of a range as text. The largest 64-bit integer is not a double, so the nearest
// double replaces it.
std::string End(double x) { return x == 0x1p64 ? std::to_string(UINT64_MAX) : FormatNumber(x); }

// Returns whether a value of this unit may be an angle.
bool TakesAngles(const Rule& rule) { return rule.unit == "rad" || rule.unit == kAngleOrLength; }

// Reads the number of a scalar in the rule's unit. An angle may be given in degrees ("30 deg").
// For a joint that may turn or slide, a length may have the unit m ("0.3 m").
bool ReadInUnit(const YamlNode& node, const Rule& rule, double* number) {
  if (node.kind != Kind::kScalar) return false;
  const auto before = [&node](std::string_view suffix) {
    return node.text.substr(0, node.text.size() - suffix.size());
  };
  if (TakesAngles(rule) && node.text.ends_with(kDegreesSuffix)) {
    if (!ReadNumber(before(kDegreesSuffix), number)) return false;
    *number *= std::numbers::pi / 180;
    return true;
  }
  if (rule.unit == kAngleOrLength && node.text.ends_with(kMetresSuffix))
    return ReadNumber(before(kMetresSuffix), number);
  return KindOf(node) == ScalarKind::kNumber && ReadNumber(node.text, number);
}

// Returns a sentence about units for a text that is not a number where an angle is possible.
// Otherwise, returns "".
std::string UnitHint(const YamlNode& node, const Rule& rule) {
  if (!TakesAngles(rule) || node.kind != Kind::kScalar || KindOf(node) != ScalarKind::kString)
    return "";
  return rule.unit == kAngleOrLength
             ? " Write an angle as 0.5 (radians) or 30 deg, and a length as 0.3 m."
             : " Write an angle as 0.5 (radians) or 30 deg.";
}

// Reads a number within the rule's range. If the number is invalid, reports a problem and returns
// false.
bool ReadOne(const PathNode& at, const Rule& rule, Problems* problems, double* value) {
  double number = 0;
  const bool is_number = ReadInUnit(at.node, rule, &number);
  const bool is_step = rule.steps.empty() ||
                       std::find(rule.steps.begin(), rule.steps.end(), number) != rule.steps.end();
  if (!is_number || !std::isfinite(number)) {
    Complain(at, rule, "a finite number, " + Allowed(rule), problems, UnitHint(at.node, rule));
  } else if (!rule.range.Contains(number) || !is_step) {
    Complain(at, rule, Allowed(rule), problems,
             TakesAngles(rule) ? DegreesHint(number, rule.range.low, rule.range.high) : "");
  } else {
    *value = number;
    return true;
  }
  return false;
}

template <class T>
void ReadWhole(const PathNode& at, const Rule& rule, Problems* problems, T* value) {
  double number = 0;
  if (!ReadOne(at, rule, problems, &number)) return;
  const std::string& text = at.node.text;
  const std::size_t begin = text[0] == '+' ? 1 : 0;
  T whole = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data() + begin, end, whole);
  if (result.ec != std::errc() || result.ptr != end) {
    return Complain(at, rule, "a whole number, " + Allowed(rule), problems);
  }
  *value = whole;
}

YamlNode Scalar(std::string text, bool quoted = false) {
  YamlNode node;
  node.kind = Kind::kScalar;
  node.text = std::move(text);
  node.quoted = quoted;
  return node;
}

YamlNode ListNode() {
  YamlNode node;
  node.kind = Kind::kList;
  return node;
}

// Returns whether every YAML reader treats this word as a string, also within a list.
bool IsPlain(const std::string& text) {
  static const std::vector<std::string> kNotStrings = {"null", "true", "false", "yes", "no", "on",
                                                       "off",  "y",    "n",     "inf", "nan"};
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; };
  const bool starts_well = !lower.empty() && (is_letter(lower[0]) || lower.rfind("../", 0) == 0);
  return starts_well && lower.back() != ':' &&
         lower.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-./:") ==
             std::string::npos &&
         std::find(kNotStrings.begin(), kNotStrings.end(), lower) == kNotStrings.end();
}

}  // namespace

std::string Allowed(const Rule& rule) {
  if (!rule.choices.empty()) return "one of: " + Join(rule.choices);
  if (!rule.steps.empty()) {
    std::vector<std::string> steps;
    for (const double step : rule.steps) steps.push_back(FormatNumber(step));
    return WithUnit("one of: " + Join(steps), rule.unit);
  }
  const std::string low = End(rule.range.low), high = End(rule.range.high);
  if (low == high) return WithUnit(low, rule.unit);
  const std::string range = rule.range.excludes_low ? "above " + low + " and at most " + high
                                                    : "from " + low + " to " + high;
  const std::string or_absent = rule.absent == "null" ? "" : ", or " + rule.absent;
  return WithUnit(range, rule.unit) + or_absent;
}

std::string Describe(const YamlNode& node) {
  switch (node.kind) {
    case Kind::kNull:
      return "empty";
    case Kind::kMap:
      return "a group of keys";
    case Kind::kList:
      return "a list of " + std::to_string(node.items.size());
    case Kind::kScalar:
      break;
  }
  return KindOf(node) == ScalarKind::kString ? Quote(node.text) : node.text.substr(0, 60);
}

void Complain(const PathNode& at, const Rule& rule, const std::string& must, Problems* problems,
              const std::string& hint) {
  const bool is_number = at.node.kind == Kind::kScalar && KindOf(at.node) == ScalarKind::kNumber;
  const std::string is = WithUnit(Describe(at.node), is_number ? rule.unit : "");
  problems->Add(at.node.place, at.path + " is " + is + "; it must be " + must + "." + hint);
}

void Read(const PathNode& at, const Rule& rule, Problems* problems, double* value) {
  ReadOne(at, rule, problems, value);
}

void Read(const PathNode& at, const Rule& rule, Problems* problems, int* value) {
  ReadWhole(at, rule, problems, value);
}

void Read(const PathNode& at, const Rule& rule, Problems* problems, std::uint64_t* value) {
  ReadWhole(at, rule, problems, value);
}

void Read(const PathNode& at, const Rule& rule, Problems* problems, bool* value) {
  if (at.node.kind != Kind::kScalar || KindOf(at.node) != ScalarKind::kBool) {
    return Complain(at, rule, "true or false", problems);
  }
  *value = at.node.text == "true";
}

void Read(const PathNode& at, const Rule& rule, Problems* problems, std::string* value) {
  const YamlNode& node = at.node;
  if (node.kind == Kind::kScalar && KindOf(node) == ScalarKind::kString) {
    const auto& choices = rule.choices;
    if (rule.required && node.text.empty()) {
      problems->Add(node.place, at.path + " is empty. Give a value (" + rule.doc + ").");
    } else if (!choices.empty() &&
               std::find(choices.begin(), choices.end(), node.text) == choices.end()) {
      const std::string nearest = Nearest(node.text, choices);
      Complain(at, rule, Allowed(rule), problems,
               nearest.empty() ? "" : " Did you mean " + nearest + "?");
    } else {
      *value = node.text;
    }
    return;
  }
  if (!rule.choices.empty()) return Complain(at, rule, Allowed(rule), problems);
  Complain(at, rule, "a word", problems,
           node.kind == Kind::kScalar ? " To use this value as a word, write it in quotation marks."
                                      : "");
}

void ReadNumbers(const PathNode& at, const Rule& rule, std::size_t count, Problems* problems,
                 double* values) {
  Rule exact = rule;
  exact.least = exact.most = count;
  const std::vector<YamlNode>* entries = Entries(at, exact, problems);
  if (entries == nullptr) return;
  std::vector<double> read(count);
  bool good = true;
  for (std::size_t i = 0; i < count; ++i) {
    const PathNode entry{(*entries)[i], at.path + "." + std::to_string(i)};
    good = ReadOne(entry, rule, problems, &read[i]) && good;
  }
  if (good) std::copy(read.begin(), read.end(), values);
}

void Read(const PathNode& at, const Rule& rule, Problems* problems, std::vector<double>* values) {
  if (rule.one_for_all && at.node.kind == Kind::kScalar) {
    double one = 0;
    if (ReadOne(at, rule, problems, &one)) *values = {one};
    return;
  }
  const std::vector<YamlNode>* entries = Entries(at, rule, problems);
  if (entries == nullptr) return;
  std::vector<double> read(entries->size());
  ReadNumbers(at, rule, read.size(), problems, read.data());
  *values = std::move(read);
}

void Read(const PathNode& at, const Rule& rule, Problems* problems,
          std::vector<std::string>* values) {
  const std::vector<YamlNode>* entries = Entries(at, rule, problems);
  if (entries == nullptr) return;
  values->assign(entries->size(), "");
  for (std::size_t i = 0; i < entries->size(); ++i) {
    Read({(*entries)[i], at.path + "." + std::to_string(i)}, rule, problems, &(*values)[i]);
  }
}

void Read(const PathNode& at, const Rule& rule, Problems* problems,
          std::vector<std::array<std::string, 2>>* values) {
  const std::vector<YamlNode>* entries = Entries(at, rule, problems);
  if (entries == nullptr) return;
  values->assign(entries->size(), {});
  for (std::size_t i = 0; i < entries->size(); ++i) {
    std::vector<std::string> pair;
    const PathNode entry{(*entries)[i], at.path + "." + std::to_string(i)};
    Read(entry, List(Word(rule.doc), 2, 2), problems, &pair);
    if (pair.size() == 2) (*values)[i] = {pair[0], pair[1]};
  }
}

const std::vector<YamlNode>* Entries(const PathNode& at, const Rule& rule, Problems* problems) {
  const std::size_t count = at.node.items.size();
  if (at.node.kind == Kind::kList && count >= rule.least && count <= rule.most) {
    return &at.node.items;
  }
  const std::string number = rule.least == rule.most
                                 ? std::to_string(rule.most)
                                 : std::to_string(rule.least) + " to " + std::to_string(rule.most);
  const std::string of = rule.unit.empty() ? " entries" : " numbers [" + rule.unit + "]";
  const std::string one = rule.one_for_all ? "one number or " : "";
  const bool needs_brackets = at.node.kind == Kind::kNull && rule.least == 0;
  Complain(at, rule, one + "a list of " + number + of, problems,
           needs_brackets ? " For an empty list, write []." : "");
  return nullptr;
}

YamlNode Write(const Rule&, double value) { return Scalar(WriteNumber(value)); }
YamlNode Write(const Rule&, int value) { return Scalar(std::to_string(value)); }
YamlNode Write(const Rule&, std::uint64_t value) { return Scalar(std::to_string(value)); }
YamlNode Write(const Rule&, bool value) { return Scalar(value ? "true" : "false"); }
YamlNode Write(const Rule&, const std::string& value) { return Scalar(value, !IsPlain(value)); }

YamlNode WriteNumbers(const double* values, std::size_t count) {
  YamlNode list = ListNode();
  for (std::size_t i = 0; i < count; ++i) list.items.push_back(Scalar(WriteNumber(values[i])));
  return list;
}

YamlNode Write(const Rule& rule, const std::vector<double>& values) {
  if (rule.one_for_all && values.size() == 1) return Scalar(WriteNumber(values[0]));
  return WriteNumbers(values.data(), values.size());
}

YamlNode Write(const Rule& rule, const std::vector<std::string>& values) {
  YamlNode list = ListNode();
  for (const std::string& value : values) list.items.push_back(Write(rule, value));
  return list;
}

YamlNode Write(const Rule& rule, const std::vector<std::array<std::string, 2>>& values) {
  YamlNode list = ListNode();
  for (const auto& pair : values) {
    list.items.push_back(Write(rule, std::vector<std::string>(pair.begin(), pair.end())));
  }
  return list;
}

}  // namespace predictor
