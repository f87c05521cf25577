#include "recording/schema.h"

#include <cctype>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>
#include <vector>

#include "recording/type_name.h"

namespace predictor::recording {
namespace {

constexpr std::pair<const char*, const char*> kGeometry[] = {
    {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    {"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
    {"geometry_msgs/Wrench", "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n"},
    {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
};

class SchemaVisitor {
 public:
  using Types = std::vector<std::pair<std::string, std::string>>;
  explicit SchemaVisitor(Types* types) : types_(types) {}
  const std::string& text() const { return text_; }

  template <class T>
  void Value(const TickField& f, const T&) {
    Line(TypeName<T>(), f);
  }
  void Value(const TickField& f, RunState) {
    for (int k = 0; k < kRunStates; ++k) Constant("STATE_", Name(static_cast<RunState>(k)), k);
    Line("uint8", f);
  }
  void Value(const TickField& f, StopCause) {
    for (int k = 0; k < kStopCauses; ++k) Constant("CAUSE_", Name(static_cast<StopCause>(k)), k);
    Line("uint8", f);
  }
  void Value(const TickField& f, Quantity) {
    int k = 0;
    for (const char* quantity : kQuantityNames) Constant("QUANTITY_", quantity, k++);
    Line("uint8", f);
  }
  void Flag(const TickField& f, const auto&) { Line("uint8", f); }
  void Presence(const TickField& f, const auto&) { Line("uint8", f); }
  void Unchecked(const TickField& f, const auto&) { Line("uint8", f); }
  template <class T, std::size_t N>
  void Values(const TickField& f, const std::array<T, N>&) {
    Line(TypeName<T>() + "[" + std::to_string(N) + "]", f);
  }
  template <class T, std::size_t N>
  void Named(const TickField& f, const std::array<const char*, N>& names, const std::array<T, N>&) {
    for (const char* name : names) Line(TypeName<T>(), {name, f.unit, f.frame, f.meaning});
  }
  void Joints(const TickField& f, const auto&, const auto&) { Line("float64[]", f); }
  void Pose(const TickField& f, const auto&) { Geometry("geometry_msgs/Pose", f, "m"); }
  void Poses(const TickField& f, const auto&, const auto&) {
    TickField list = f;
    list.unit = "m";
    Line("geometry_msgs/Pose[]", list);
    DefineGeometry("geometry_msgs/Pose");
  }
  void Twist(const TickField& f, const auto&) { Geometry("geometry_msgs/Twist", f, "m/s, rad/s"); }
  void Wrench(const TickField& f, const auto&) { Geometry("geometry_msgs/Wrench", f, "N, N m"); }
  void Reserved(const auto&) {}
  void Message(const TickField& f, const char* type, auto&& visit) {
    Line(type, f);
    SchemaVisitor inner(types_);
    visit(inner);
    Define(type, inner.text());
  }
  void Inputs(const TickField& f, const char* type, const auto& list, const auto&, auto&& visit) {
    Line(std::string(type) + "[]", f);
    SchemaVisitor inner(types_);
    visit(inner, list[0]);
    Define(type, inner.text());
  }

 private:
  // Adds the comment "[unit] in frame: meaning", and omits the parts that the row does not have.
  void Line(const std::string& type, const TickField& f) {
    const std::string unit = *f.unit ? std::string("[") + f.unit + "]" : "";
    const std::string frame = *f.frame ? std::string("in ") + f.frame : "";
    std::string comment = unit + (unit.empty() || frame.empty() ? "" : " ") + frame;
    if (*f.meaning)
      comment += (frame.empty() ? comment.empty() ? "" : " " : ": ") + std::string(f.meaning);
    text_ += type + " " + f.name + (comment.empty() ? "" : "  # " + comment) + "\n";
  }
  void Constant(const char* prefix, const char* name, int value) {
    text_.append("uint8 ").append(prefix);
    for (; *name != 0; ++name)
      text_ += static_cast<char>(std::toupper(static_cast<unsigned char>(*name)));
    text_ += "=" + std::to_string(value) + "\n";
  }
  void Geometry(const std::string& type, TickField f, const char* unit) {
    f.unit = unit;
    Line(type, f);
    DefineGeometry(type);
  }
  // Adds the definition of a type and of the types of its members.
  void DefineGeometry(const std::string& type) {
    for (const auto& [known, definition] : kGeometry) {
      if (type != known) continue;
      Define(type, definition);
      std::istringstream lines(definition);
      for (std::string part, name; lines >> part >> name;) DefineGeometry(part);
    }
  }
  void Define(const std::string& type, const std::string& definition) {
    for (const auto& [known, text] : *types_)
      if (known == type) return;
    types_->emplace_back(type, definition);
  }

  Types* types_;
  std::string text_;
};

std::string Define(TickGroup group) {
  const TickRecord record{};
  SchemaVisitor::Types types;
  SchemaVisitor visitor(&types);
  VisitGroup(group, visitor, record);
  std::string text = visitor.text();
  if (group == TickGroup::kTiming)
    text += "uint32 record_crc  # CRC32 of the tick's log time and messages so far\n";
  for (const auto& [type, definition] : types)
    text.append(80, '=').append("\nMSG: ").append(type).append("\n").append(definition);
  return text;
}

}  // namespace

const std::string& Definition(TickGroup group) {
  static const std::array<std::string, kTickGroupCount> kDefinitions = [] {
    std::array<std::string, kTickGroupCount> all;
    for (int g = 0; g < kTickGroupCount; ++g)
      all[static_cast<std::size_t>(g)] = Define(static_cast<TickGroup>(g));
    return all;
  }();
  return kDefinitions[static_cast<std::size_t>(group)];
}

const std::string& EventSchema() {
  using Json = nlohmann::ordered_json;
  const Json text = {{"type", "string"}}, count = {{"type", "integer"}, {"minimum", 0}};
  const Json time = {{"type", "object"},
                     {"title", "time"},
                     {"properties", {{"sec", count}, {"nsec", count}}},
                     {"required", {"sec", "nsec"}}};
  static const std::string kSchema =
      Json{{"title", kEventType},
           {"type", "object"},
           {"properties",
            {{"timestamp", time},
             {"level", count},
             {"message", text},
             {"name", text},
             {"file", text},
             {"line", count},
             {"tick", count},
             {"lost", count}}},
           {"required", {"timestamp", "level", "message", "name", "file", "line", "tick"}}}
          .dump();
  return kSchema;
}

std::string Layout(const std::string& definition) {
  std::istringstream lines(definition);
  std::string layout;
  for (std::string line; std::getline(lines, line);) {
    line = line.substr(0, line.find('#'));
    while (!line.empty() && line.back() == ' ') line.pop_back();
    const bool separator = line.starts_with("===");
    if (!line.empty() && (separator || line.find('=') == std::string::npos)) layout += line + "\n";
  }
  return layout;
}

}  // namespace predictor::recording
