// Publishes the recorded quantities as JSON topics. The quantities have the same names as in a
// recording.
#include <cmath>
#include <string>
#include <type_traits>

#include "core/tick_fields.h"
#include "foxglove/json.h"

namespace predictor::foxglove {
namespace {

Json Word(RunState state) { return Name(state); }
Json Word(StopCause cause) { return Name(cause); }
Json Word(Quantity quantity) { return kQuantityNames[static_cast<std::size_t>(quantity)]; }

// Writes the members of a message. JSON has no infinity, so numbers that are not finite are
// omitted.
class JsonVisitor {
 public:
  explicit JsonVisitor(Json* json) : json_(json) {}

  template <class T>
  void Value(const TickField& f, const T& x) {
    if constexpr (std::is_enum_v<T>)
      Add(f.name, Word(x));
    else if constexpr (std::is_floating_point_v<T>)
      AddNumber(f.name, x);
    else
      Add(f.name, x);
  }
  void Flag(const TickField& f, std::uint8_t x) { Add(f.name, x != 0); }
  void Presence(const TickField& f, std::uint8_t x) {
    Add(f.name, x != 0);
    absent_ = x == 0;
  }
  void Values(const TickField& f, const auto& x) { AddList(f, x, x.size()); }
  void Named(const TickField&, const auto& names, const auto& x) {
    for (std::size_t i = 0; i < x.size(); ++i) AddNumber(names[i], static_cast<double>(x[i]));
  }
  void Joints(const TickField& f, const auto& x, std::uint8_t dof) {
    AddList(f, x, std::min<std::size_t>(dof, x.size()));
  }
  void Pose(const TickField& f, const PoseRecord& x) { Add(f.name, PoseJson(FromRecord(x))); }
  void Poses(const TickField& f, const auto& x, std::uint8_t count) {
    Json list = Json::array();
    for (std::size_t i = 0; i < std::min<std::size_t>(count, x.size()); ++i)
      list.push_back(PoseJson(FromRecord(x[i])));
    Add(f.name, std::move(list));
  }
  void Twist(const TickField& f, const std::array<double, 6>& x) {
    Add(f.name, {{"linear", Xyz(x.data())}, {"angular", Xyz(x.data() + 3)}});
  }
  void Wrench(const TickField& f, const std::array<double, 6>& x) {
    Add(f.name, {{"force", Xyz(x.data())}, {"torque", Xyz(x.data() + 3)}});
  }
  void Reserved(const auto&) {}
  void Unchecked(const TickField&, const auto&) {}
  void Inputs(const TickField&, const char*, const auto&, std::uint8_t, auto&&) {}
  void Message(const TickField& f, const char*, auto&& visit) {
    Json inner = Json::object();
    JsonVisitor visitor(&inner);
    visit(visitor);
    Add(f.name, std::move(inner));
  }

 private:
  void Add(const char* name, Json value) {
    if (!absent_) (*json_)[name] = std::move(value);
  }
  void AddNumber(const char* name, double x) {
    if (std::isfinite(x)) Add(name, x);
  }
  void AddList(const TickField& f, const auto& x, std::size_t count) {
    Json list = Json::array();
    for (std::size_t i = 0; i < count; ++i) list.push_back(x[i]);
    Add(f.name, std::move(list));
  }

  Json* json_;
  bool absent_ = false;
};

Json MessageOf(TickGroup group, const TickRecord& record, std::uint64_t ns) {
  Json message = {{"timestamp", Time(ns)}};
  JsonVisitor visitor(&message);
  VisitGroup(group, visitor, record);
  return message;
}

// `value` is a message that contains all its members.
Json SchemaOf(const Json& value) {
  if (value.is_boolean()) return {{"type", "boolean"}};
  if (value.is_number_integer()) return Integer();
  if (value.is_number()) return Number();
  if (value.is_string()) return Text();
  if (value.is_array()) return ListOf(SchemaOf(value.front()));
  Json members = Json::object();
  for (const auto& [name, member] : value.items()) members[name] = SchemaOf(member);
  return {{"type", "object"}, {"properties", members}};
}

// Returns a record in which every optional group is present.
TickRecord Full() {
  TickRecord record = {};
  record.cobot_dof = kMaxCobotJoints;
  record.movable_count = kMaxMovables;
  for (HandRecord& hand : record.hands) {
    hand.present = 1;
    hand.arm_dof = kMaxArmJoints;
  }
  return record;
}

}  // namespace

std::vector<FoxgloveChannel> QuantityChannels() {
  std::vector<FoxgloveChannel> channels;
  for (int g = 0; g < kTickGroupCount; ++g) {
    const auto group = static_cast<TickGroup>(g);
    if (group == TickGroup::kInputs) continue;
    const TickGroupRow& row = kTickGroups[static_cast<std::size_t>(g)];
    const std::string type = row.type;
    const std::string title = "predictor." + type.substr(type.rfind('/') + 1);
    Json schema = SchemaOf(MessageOf(group, Full(), 0));
    schema["title"] = title;
    schema["properties"]["timestamp"] = TimeSchema();
    channels.push_back({row.topic, title, schema, [group](const TickRecord& r, std::uint64_t ns) {
                          return MessageOf(group, r, ns);
                        }});
  }
  return channels;
}

}  // namespace predictor::foxglove
