#include "core/person_json.h"

#include <charconv>
#include <cmath>
#include <concepts>
#include <string_view>

namespace predictor {
namespace {

class TextVisitor {
 public:
  explicit TextVisitor(std::string text) : text_(std::move(text)) {}
  const std::string& text() const { return text_; }

  void Number(const char* name, const char*, const char*, const auto& x) {
    Key(name);
    Put(x);
  }
  void Flag(const char* name, const char*, std::uint8_t x) {
    Key(name);
    text_ += x != 0 ? "true" : "false";
  }
  void Word(const char* name, const char*, const auto& names, std::size_t index) {
    Key(name);
    Quoted(names[std::min(index, names.size() - 1)]);
  }
  void Words(const char* name, const char*, const auto& names, std::uint32_t bits) {
    Key(name);
    text_ += '[';
    for (std::size_t i = 0; i < names.size(); ++i) {
      if ((bits >> i & 1U) == 0) continue;
      if (text_.back() != '[') text_ += ',';
      Quoted(names[i]);
    }
    text_ += ']';
  }
  void Vector(const char* name, const char*, const std::array<float, 3>& x, bool known) {
    Key(name);
    const bool finite = std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
    known&& finite ? Array(x, x.size()) : Null();
  }
  void List(const char* name, const char*, const auto& x, std::size_t count) {
    Key(name);
    std::isfinite(x[0]) ? Array(x, count) : Null();
  }
  void Group(const char* name, const char*, const auto& visit) {
    Key(name);
    text_ += '{';
    visit(*this);
    text_ += '}';
  }

 private:
  void Key(const char* name) {
    if (text_.back() != '{') text_ += ',';
    Quoted(name);
    text_ += ':';
  }
  void Quoted(const char* word) { text_.append("\"").append(word).append("\""); }
  void Null() { text_ += "null"; }
  void Array(const auto& x, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      text_ += i == 0 ? '[' : ',';
      Put(x[i]);
    }
    text_ += ']';
  }
  void Put(std::integral auto x) { text_ += std::to_string(x); }
  void Put(std::floating_point auto x) {
    if (!std::isfinite(x)) return Null();
    constexpr int kDigits = sizeof x == sizeof(double) ? 9 : 5;
    char buffer[32];
    const auto end =
        std::to_chars(buffer, buffer + sizeof buffer, x, std::chars_format::general, kDigits).ptr;
    text_.append(buffer, end);
  }

  std::string text_;
};

// Writes the JSON Schema for an object's members.
class SchemaVisitor {
 public:
  std::string Object(const char* meaning) const {
    return R"({"type":"object",)" + Description(meaning) + R"("properties":{)" + members_ +
           R"(},"required":[)" + names_ + "]}";
  }

  void Number(const char* name, const char* unit, const char* meaning,
              const std::floating_point auto&) {
    Add(name, R"({)" + Description(meaning, unit) + R"("type":["number","null"]})");
  }
  void Number(const char* name, const char* unit, const char* meaning, const std::integral auto&) {
    Add(name, R"({)" + Description(meaning, unit) + R"("type":"integer"})");
  }
  void Flag(const char* name, const char* meaning, const auto&) {
    Add(name, R"({)" + Description(meaning) + R"("type":"boolean"})");
  }
  void Word(const char* name, const char* meaning, const auto& names, std::size_t) {
    Add(name, R"({)" + Description(meaning) + R"("enum":[)" + Listed(names) + "]}");
  }
  void Words(const char* name, const char* meaning, const auto& names, const auto&) {
    Add(name, R"({)" + Description(meaning) + R"("type":"array","items":{"enum":[)" +
                  Listed(names) + "]}}");
  }
  void Vector(const char* name, const char* meaning, const auto&, bool) {
    Add(name, R"({)" + Description(meaning) + Array(3));
  }
  void List(const char* name, const char* meaning, const auto&, std::size_t count) {
    Add(name, R"({)" + Description(meaning) + Array(count));
  }
  void Group(const char* name, const char* meaning, const auto& visit) {
    SchemaVisitor inner;
    visit(inner);
    Add(name, inner.Object(meaning));
  }
  void Constant(const char* name, const char* value) {
    Add(name, std::string(R"({"const":")") + value + R"("})");
  }

 private:
  static std::string Description(std::string_view meaning, std::string_view unit = "") {
    if (meaning.empty() && unit.empty()) return "";
    std::string text = R"("description":")";
    if (!unit.empty()) text.append("[").append(unit).append("]").append(meaning.empty() ? "" : " ");
    return text.append(meaning).append(R"(",)");
  }
  static std::string Array(std::size_t count) {
    const std::string n = std::to_string(count);
    return R"("type":["array","null"],"items":{"type":["number","null"]},"minItems":)" + n +
           R"(,"maxItems":)" + n + "}";
  }
  static std::string Listed(const auto& names) {
    std::string text;
    for (const char* name : names)
      text.append(text.empty() ? "\"" : ",\"").append(name).append("\"");
    return text;
  }
  void Add(const char* name, const std::string& schema) {
    const char* comma = members_.empty() ? "" : ",";
    members_.append(comma).append("\"").append(name).append("\":").append(schema);
    names_.append(comma).append("\"").append(name).append("\"");
  }

  std::string members_, names_;
};

}  // namespace

std::string PersonJson(const PersonState& state) {
  TextVisitor visitor(R"({"type":"person")");
  VisitPerson(visitor, state);
  return visitor.text() + "}";
}

std::string PersonSchema() {
  SchemaVisitor visitor;
  visitor.Constant("type", "person");
  const PersonState state;
  VisitPerson(visitor, state);
  return visitor.Object("state of the person");
}

}  // namespace predictor
