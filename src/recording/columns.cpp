#include "recording/columns.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "core/tick_fields.h"
#include "recording/type_name.h"

namespace predictor {
namespace {

template <class T>
std::string TextOf(const std::byte* number) {
  T value;
  std::memcpy(&value, number, sizeof value);
  if constexpr (std::is_floating_point_v<T>) {
    char text[40];
    const int digits = std::numeric_limits<T>::max_digits10;
    std::snprintf(text, sizeof text, "%.*g", digits, static_cast<double>(value));
    return text;
  } else if constexpr (std::is_enum_v<T>) {
    return std::to_string(static_cast<int>(value));
  } else {
    return std::to_string(value);
  }
}

// Records name, unit and offset of each number of a record.
class Surveyor {
 public:
  explicit Surveyor(const TickRecord& record)
      : start_(reinterpret_cast<const std::byte*>(&record)) {}

  void Value(const TickField& f, const auto& x) { Note(f.name, f, x); }
  void Flag(const TickField& f, const auto& x) { Note(f.name, f, x); }
  void Presence(const TickField& f, const auto& x) {
    conditions_.push_back({OffsetOf(x), 0});
    Note(f.name, f, x);
  }
  void Unchecked(const TickField& f, const auto& x) { Note(f.name, f, x); }
  void Values(const TickField& f, const auto& x) {
    for (std::size_t i = 0; i < x.size(); ++i) Note(Indexed(f.name, i), f, x[i]);
  }
  void Named(const TickField& f, const auto& names, const auto& x) {
    for (std::size_t i = 0; i < x.size(); ++i) Note(names[i], f, x[i]);
  }
  void Joints(const TickField& f, const auto& x, const std::uint8_t& dof) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      Note(Indexed(f.name, i), f, x[i]);
      columns.back().conditions.push_back({OffsetOf(dof), i});
    }
  }
  void Pose(const TickField& f, const PoseRecord& x) {
    Axes(f, ".p", x.p.data(), "m");
    for (std::size_t i = 0; i < 4; ++i) Note(f.name + (std::string(".q.") + "wxyz"[i]), f, x.q[i]);
  }
  void Poses(const TickField& f, const auto& x, const std::uint8_t& count) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::string name = Indexed(f.name, i);
      TickField one = f;
      one.name = name.c_str();
      const std::size_t before = columns.size();
      Pose(one, x[i]);
      for (std::size_t k = before; k < columns.size(); ++k)
        columns[k].conditions.push_back({OffsetOf(count), i});
    }
  }
  void Twist(const TickField& f, const std::array<double, 6>& x) {
    Axes(f, ".linear", x.data(), "m/s");
    Axes(f, ".angular", x.data() + 3, "rad/s");
  }
  void Wrench(const TickField& f, const std::array<double, 6>& x) {
    Axes(f, ".force", x.data(), "N");
    Axes(f, ".torque", x.data() + 3, "N m");
  }
  void Reserved(const auto&) {}
  void Message(const TickField& f, const char*, auto&& visit) { Within(f.name, f.meaning, visit); }
  void Inputs(const TickField& f, const char*, const auto& list, const auto&, auto&& visit) {
    in_inputs_ = true;
    for (std::size_t i = 0; i < list.size(); ++i)
      Within(Indexed(f.name, i), f.meaning, [&](Surveyor& inner) { visit(inner, list[i]); });
    in_inputs_ = false;
  }
  void Group(const std::string& name, auto&& visit) {
    Within(name, "", visit);
    conditions_.clear();
  }

  std::vector<Column> columns;

 private:
  static std::string Indexed(const std::string& name, std::size_t i) {
    return name + "[" + std::to_string(i) + "]";
  }
  std::size_t OffsetOf(const auto& x) const {
    return static_cast<std::size_t>(reinterpret_cast<const std::byte*>(&x) - start_);
  }
  void Within(const std::string& name, const char* meaning, auto&& visit) {
    const std::string before = std::exchange(prefix_, prefix_ + name + ".");
    const std::string outer = std::exchange(message_, meaning);
    visit(*this);
    prefix_ = before;
    message_ = outer;
  }
  template <class T>
  void Note(const std::string& name, const TickField& f, const T& x) {
    std::string meaning = message_;
    if (*f.meaning) meaning += (meaning.empty() ? "" : ": ") + std::string(f.meaning);
    columns.push_back({prefix_ + name, recording::TypeName<T>(), f.unit, f.frame,
                       std::move(meaning), OffsetOf(x), sizeof(T), TextOf<T>, f.of_clock,
                       in_inputs_, conditions_});
  }
  void Axes(TickField f, const char* part, const double* x, const char* unit) {
    f.unit = unit;
    for (std::size_t i = 0; i < 3; ++i) Note(std::string(f.name) + part + "." + "xyz"[i], f, x[i]);
  }

  const std::byte* start_;
  std::string prefix_, message_;  // prefix of the names; meaning of the enclosing message
  std::vector<Column::Condition> conditions_;
  bool in_inputs_ = false;
};

std::vector<Column> Survey() {
  const TickRecord record{};
  Surveyor surveyor(record);
  for (int g = 0; g < kTickGroupCount; ++g) {
    std::string topic = kTickGroups[static_cast<std::size_t>(g)].topic + 1;
    std::replace(topic.begin(), topic.end(), '/', '.');
    surveyor.Group(topic,
                   [&](Surveyor& inner) { VisitGroup(static_cast<TickGroup>(g), inner, record); });
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

// Returns whether the pattern matches this name or a group that contains it.
bool IsMeant(const std::string& name, const std::string& pattern) {
  return Matches(name, pattern) || Matches(name, pattern + ".*") || Matches(name, pattern + "[*");
}

}  // namespace

std::uint64_t Column::Bits(const TickRecord& record) const {
  std::uint64_t bits = 0;
  std::memcpy(&bits, At(record), size);
  return bits;
}

const std::vector<Column>& AllColumns() {
  static const std::vector<Column> columns = Survey();
  return columns;
}

bool Column::ExistsIn(const TickRecord& record) const {
  return std::all_of(conditions.begin(), conditions.end(), [&](const Condition& condition) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&record);
    return bytes[condition.offset] > condition.above;
  });
}

std::vector<Column> ColumnsOf(const TickRecord& record, InputColumns inputs) {
  std::vector<Column> columns;
  for (const Column& column : AllColumns())
    if (column.ExistsIn(record) && (inputs == InputColumns::kIncluded || !column.of_input))
      columns.push_back(column);
  return columns;
}

void SetJointUnits(const std::vector<bool>& prismatic, std::vector<Column>* columns) {
  constexpr std::string_view kOr = " or ";
  for (Column& column : *columns) {
    const std::size_t at = column.unit.find(kOr);
    const std::size_t bracket = column.name.rfind('[');
    if (at == std::string::npos || bracket == std::string::npos) continue;
    const std::size_t joint = std::stoul(column.name.substr(bracket + 1));
    if (joint >= prismatic.size()) continue;
    column.unit =
        prismatic[joint] ? column.unit.substr(at + kOr.size()) : column.unit.substr(0, at);
  }
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
    throw InputError("There is no channel " + Quote(pattern) + "." +
                     (nearest.empty() ? "" : " Did you mean " + nearest + "?") +
                     " `predictor export channels FILE` lists all channels.");
  }
  return selected;
}

}  // namespace predictor
