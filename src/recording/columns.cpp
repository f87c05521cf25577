#include "recording/columns.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "recording/fields.h"

namespace predictor {
namespace {

template <class T>
constexpr NumberKind KindOf() {
  if constexpr (std::is_enum_v<T> || std::is_same_v<T, std::uint8_t>)
    return NumberKind::kU8;
  else if constexpr (std::is_same_v<T, std::int8_t>)
    return NumberKind::kI8;
  else if constexpr (std::is_same_v<T, std::uint16_t>)
    return NumberKind::kU16;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return NumberKind::kI32;
  else if constexpr (std::is_same_v<T, std::uint32_t>)
    return NumberKind::kU32;
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return NumberKind::kU64;
  else if constexpr (std::is_same_v<T, float>)
    return NumberKind::kF32;
  else {
    static_assert(std::is_same_v<T, double>);
    return NumberKind::kF64;
  }
}

std::size_t SizeOf(NumberKind kind) {
  switch (kind) {
    case NumberKind::kU8:
    case NumberKind::kI8:
      return 1;
    case NumberKind::kU16:
      return 2;
    case NumberKind::kI32:
    case NumberKind::kU32:
    case NumberKind::kF32:
      return 4;
    default:
      return 8;
  }
}

// "[m/s] of something" -> "m/s".
std::string UnitIn(const char* comment) {
  const std::string text(comment);
  const std::size_t end = text.find(']');
  return text.starts_with('[') && end != std::string::npos ? text.substr(1, end - 1) : "";
}

template <class T>
T At(const TickRecord& record, std::size_t offset) {
  T value;
  std::memcpy(&value, reinterpret_cast<const std::byte*>(&record) + offset, sizeof value);
  return value;
}

// Walks a record and notes what lies where.
class Surveyor {
 public:
  explicit Surveyor(const TickRecord& record)
      : start_(reinterpret_cast<const std::byte*>(&record)) {}

  template <class T>
  void Value(const char* name, const T& x, const char* comment = "") {
    Note(name, x, UnitIn(comment));
  }
  void Enum(const char* name, const auto& x) { Note(name, x, ""); }
  void Loose(const char* name, const auto& x) { Note(name, x, ""); }
  template <class T, std::size_t N>
  void Values(const char* name, const std::array<T, N>& x, const char* comment = "") {
    for (std::size_t i = 0; i < N; ++i) Note(Indexed(name, i), x[i], UnitIn(comment));
  }
  template <std::size_t N>
  void Joints(const char* name, const std::array<double, N>& x, std::size_t, const char* comment) {
    Values(name, x, comment);
  }
  void Pose(const std::string& name, const PoseRecord& x) {
    Axes(name + ".p", x.p.data(), "m");
    for (std::size_t i = 0; i < 4; ++i) Note(name + ".q." + "wxyz"[i], x.q[i], "");
  }
  void Twist(const std::string& name, const std::array<double, 6>& x, const char* = "") {
    Axes(name + ".linear", x.data(), "m/s");
    Axes(name + ".angular", x.data() + 3, "rad/s");
  }
  void Wrench(const std::string& name, const std::array<double, 6>& x, const char* = "") {
    Axes(name + ".force", x.data(), "N");
    Axes(name + ".torque", x.data() + 3, "N m");
  }
  void Reserved(const auto&) {}
  void Message(const char* name, const char*, auto&& visit) { Within(name, visit); }
  void Inputs(const char* name, const char*, const auto& list, std::size_t, auto&& visit) {
    for (std::size_t i = 0; i < list.size(); ++i)
      Within(Indexed(name, i), [&](Surveyor& inner) { visit(inner, list[i]); });
  }
  void Within(const std::string& name, auto&& visit) {
    const std::string before = std::exchange(prefix_, prefix_ + name + ".");
    visit(*this);
    prefix_ = before;
  }

  std::vector<Column> columns;

 private:
  static std::string Indexed(const std::string& name, std::size_t i) {
    return name + "[" + std::to_string(i) + "]";
  }
  template <class T>
  void Note(const std::string& name, const T& x, std::string unit) {
    const std::byte* at = reinterpret_cast<const std::byte*>(&x);
    columns.push_back(
        {prefix_ + name, std::move(unit), static_cast<std::size_t>(at - start_), KindOf<T>()});
  }
  void Axes(const std::string& name, const double* x, const char* unit) {
    for (std::size_t i = 0; i < 3; ++i) Note(name + "." + "xyz"[i], x[i], unit);
  }

  const std::byte* start_;
  std::string prefix_;
};

std::vector<Column> Survey() {
  const TickRecord record{};
  Surveyor surveyor(record);
  for (int g = 0; g < recording::kGroups; ++g) {
    std::string topic = recording::kGroupNames[static_cast<std::size_t>(g)].topic + 1;
    std::replace(topic.begin(), topic.end(), '/', '.');
    surveyor.Within(topic, [&](Surveyor& inner) {
      recording::VisitGroup(static_cast<recording::Group>(g), inner, record);
    });
  }
  return std::move(surveyor.columns);
}

bool Matches(std::string_view name, std::string_view pattern) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() == '*')
    return Matches(name, pattern.substr(1)) || (!name.empty() && Matches(name.substr(1), pattern));
  return !name.empty() && name.front() == pattern.front() &&
         Matches(name.substr(1), pattern.substr(1));
}

// A name, a pattern, or the name of a group.
bool IsMeant(const std::string& name, const std::string& pattern) {
  if (Matches(name, pattern)) return true;
  return name.starts_with(pattern) && name.size() > pattern.size() &&
         (name[pattern.size()] == '.' || name[pattern.size()] == '[');
}

}  // namespace

std::string Column::Text(const TickRecord& record) const {
  char text[40];
  switch (kind) {
    case NumberKind::kF64:
      std::snprintf(text, sizeof text, "%.17g", At<double>(record, offset));
      return text;
    case NumberKind::kF32:
      std::snprintf(text, sizeof text, "%.9g", static_cast<double>(At<float>(record, offset)));
      return text;
    case NumberKind::kI8:
      return std::to_string(At<std::int8_t>(record, offset));
    case NumberKind::kI32:
      return std::to_string(At<std::int32_t>(record, offset));
    default:
      return std::to_string(Bits(record));
  }
}

std::uint64_t Column::Bits(const TickRecord& record) const {
  std::uint64_t bits = 0;
  std::memcpy(&bits, reinterpret_cast<const std::byte*>(&record) + offset, SizeOf(kind));
  return bits;
}

const std::vector<Column>& AllColumns() {
  static const std::vector<Column> columns = Survey();
  return columns;
}

std::vector<Column> ColumnsOf(const TickRecord& record, InputColumns inputs) {
  const auto beyond = [](const std::string& name, const std::string& list, std::size_t dof) {
    return name.starts_with(list + "[") &&
           std::strtoul(name.c_str() + list.size() + 1, nullptr, 10) >= dof;
  };
  std::vector<Column> columns;
  for (const Column& column : AllColumns()) {
    bool exists = inputs == InputColumns::kIncluded || !column.name.starts_with("inputs.inputs");
    for (std::size_t h = 0; h < kHands; ++h) {
      const std::string hand = std::string("hands.") + kHandNames[h];
      if (!column.name.starts_with(hand)) continue;
      exists &= record.hands[h].present != 0;
      for (const char* list : {".q", ".v", ".command"})
        exists &= !beyond(column.name, hand + list, record.hands[h].arm_dof);
    }
    for (const char* list : {"cobot.q", "cobot.v", "cobot.torque"})
      exists &= !beyond(column.name, list, record.cobot_dof);
    if (exists) columns.push_back(column);
  }
  return columns;
}

std::vector<Column> Select(const std::vector<Column>& columns,
                           const std::vector<std::string>& patterns) {
  std::vector<Column> selected;
  for (const std::string& pattern : patterns) {
    const std::size_t before = selected.size();
    for (const Column& column : columns)
      if (IsMeant(column.name, pattern)) selected.push_back(column);
    if (selected.size() > before) continue;
    std::vector<std::string> names;
    names.reserve(columns.size());
    for (const Column& column : columns) names.push_back(column.name);
    const std::string nearest = Nearest(pattern, names);
    throw InputError("No channel is called " + Quote(pattern) + "." +
                     (nearest.empty() ? "" : " Did you mean " + nearest + "?") +
                     " `predictor export-data FILE --list` names them all.");
  }
  return selected;
}

}  // namespace predictor
