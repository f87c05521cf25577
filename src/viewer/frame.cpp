#include "viewer/frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <type_traits>

namespace predictor {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

struct Source {
  const TickRecord& record;
  const Peaks& peaks;
  std::uint64_t sent_ns;
  bool recording;
};

struct Column {
  FrameField field;
  std::size_t bytes;
  std::function<void(const Source&, char*)> write;
};

template <class T>
const char* TypeName() {
  if constexpr (std::is_same_v<T, std::uint8_t>) return "u8";
  if constexpr (std::is_same_v<T, std::int8_t>) return "i8";
  if constexpr (std::is_same_v<T, std::int32_t>) return "i32";
  if constexpr (std::is_same_v<T, std::uint64_t>) return "u64";
  if constexpr (std::is_same_v<T, float>) return "f32";
  if constexpr (std::is_same_v<T, double>) return "f64";
}

template <class T>
void Store(T value, char* to) {
  std::memcpy(to, &value, sizeof value);
}

class Table {
 public:
  Table() {
    AddRun();
    AddStop();
    AddWorld();
    for (std::size_t h = 0; h < kHands; ++h) AddHand(h);
    AddLoop();
    for (const Column& column : columns_) fields_.push_back(column.field);
  }
  const std::vector<Column>& columns() const { return columns_; }
  const std::vector<FrameField>& fields() const { return fields_; }
  std::size_t bytes() const { return bytes_; }

 private:
  void Add(const std::string& name, const char* type, std::size_t count, std::size_t bytes,
           std::function<void(const Source&, char*)> write) {
    columns_.push_back(
        {{name, static_cast<std::uint32_t>(bytes_), type, static_cast<std::uint32_t>(count)},
         bytes,
         std::move(write)});
    bytes_ += bytes;
  }
  // get(source): one value.
  template <class T, class Get>
  void One(const std::string& name, Get get) {
    Add(name, TypeName<T>(), 1, sizeof(T),
        [get](const Source& s, char* to) { Store(static_cast<T>(get(s)), to); });
  }
  // get(source): an array, sent in single precision.
  template <std::size_t N, class Get>
  void Many(const std::string& name, Get get) {
    Add(name, TypeName<float>(), N, N * sizeof(float), [get](const Source& s, char* to) {
      const auto& values = get(s);
      static_assert(std::tuple_size_v<std::decay_t<decltype(values)>> == N);
      for (std::size_t i = 0; i < N; ++i)
        Store(static_cast<float>(values[i]), to + i * sizeof(float));
    });
  }
  // get(source): a PoseRecord.
  template <class Get>
  void Placement(const std::string& name, Get get) {
    Many<7>(name, [get](const Source& s) {
      const PoseRecord& X = get(s);
      return std::array<double, 7>{X.p[0], X.p[1], X.p[2], X.q[0], X.q[1], X.q[2], X.q[3]};
    });
  }

  void AddRun() {
    One<std::uint64_t>("tick", [](const Source& s) { return s.record.tick; });
    One<double>("run_time", [](const Source& s) { return s.record.run_time; });
    One<std::uint64_t>("wall_ns", [](const Source& s) { return s.record.wall_ns; });
    One<std::uint64_t>("sent_ns", [](const Source& s) { return s.sent_ns; });
  }
  void AddStop() {
    One<std::uint8_t>("state", [](const Source& s) { return s.record.state; });
    One<std::uint8_t>("cause", [](const Source& s) { return s.record.cause; });
    One<std::int8_t>("cause_hand", [](const Source& s) { return s.record.cause_hand; });
    One<std::uint8_t>("cause_quantity", [](const Source& s) { return s.record.cause_quantity; });
    One<double>("cause_value", [](const Source& s) { return s.record.cause_value; });
    One<double>("cause_limit", [](const Source& s) { return s.record.cause_limit; });
    One<std::uint8_t>("harder_cause", [](const Source& s) { return s.record.harder.cause; });
    One<std::int8_t>("harder_cause_hand", [](const Source& s) { return s.record.harder.hand; });
    One<std::uint8_t>("harder_cause_quantity",
                      [](const Source& s) { return s.record.harder.quantity; });
    One<double>("harder_cause_value", [](const Source& s) { return s.record.harder.value; });
    One<double>("harder_cause_limit", [](const Source& s) { return s.record.harder.limit; });
    One<std::int32_t>("action", [](const Source& s) { return s.record.action; });
  }
  void AddWorld() {
    Many<kMaxCobotJoints>(
        "cobot_q", [](const Source& s) -> const auto& { return s.record.cobot_q; });
    Placement(
        "object", [](const Source& s) -> const auto& { return s.record.object.pose; });
    Placement(
        "end_effector", [](const Source& s) -> const auto& { return s.record.end_effector.pose; });
  }
  void AddHand(std::size_t h) {
    const std::string side = std::string(kHandNames[h]) + "_";
    const auto hand = [h](const Source& s) -> const HandRecord& { return s.record.hands[h]; };
    One<std::uint8_t>(side + "present", [hand](const Source& s) { return hand(s).present; });
    One<std::uint8_t>(side + "gripping", [hand](const Source& s) { return hand(s).gripping; });
    One<std::uint8_t>(side + "arm_fault", [hand](const Source& s) { return hand(s).arm_fault; });
    One<std::uint8_t>(side + "keeps_power",
                      [hand](const Source& s) { return Has(hand(s), Warning::kKeepsPower); });
    Placement(
        side + "real", [hand](const Source& s) -> const auto& { return hand(s).real.pose; });
    Placement(
        side + "virtual", [hand](const Source& s) -> const auto& { return hand(s).virtual_.pose; });
    Many<6>(
        side + "wrench", [hand](const Source& s) -> const auto& { return hand(s).wrench; });
    Many<2>(
        side + "peak", [h](const Source& s) -> const auto& { return s.peaks.hands[h]; });
    Many<6>(
        side + "coupling", [hand](const Source& s) -> const auto& { return hand(s).coupling; });
    Many<kMaxArmJoints>(
        side + "arm_q", [hand](const Source& s) -> const auto& { return hand(s).q; });
    One<float>(side + "sensor_age", [hand](const Source& s) { return hand(s).sensor_age; });
    One<float>(side + "manipulability", [hand](const Source& s) { return hand(s).manipulability; });
  }
  void AddLoop() {
    One<float>("elbow_distance", [](const Source& s) { return s.record.elbow_distance; });
    Many<6>(
        "relative_slack", [](const Source& s) -> const auto& { return s.record.relative_slack; });
    Many<kStages>(
        "stage_us", [](const Source& s) -> const auto& { return s.record.stage_us; });
    Many<kParameters>(
        "parameters", [](const Source& s) -> const auto& { return s.record.parameters; });
    One<std::uint8_t>("qp_relaxed", [](const Source& s) { return s.record.qp_relaxed; });
    One<std::uint8_t>("qp_failed", [](const Source& s) { return s.record.qp_failed; });
    One<std::uint8_t>("guard_altered", [](const Source& s) { return s.record.guard_altered; });
    One<std::uint8_t>("recording", [](const Source& s) { return s.recording ? 1 : 0; });
  }

  std::vector<Column> columns_;
  std::vector<FrameField> fields_;
  std::size_t bytes_ = 0;
};

const Table& TheTable() {
  static const Table table;
  return table;
}

}  // namespace

const std::vector<FrameField>& FrameFields() { return TheTable().fields(); }

std::size_t FrameBytes() { return TheTable().bytes(); }

void Peaks::See(const TickRecord& record) {
  for (std::size_t h = 0; h < kHands; ++h) {
    const auto& F = record.hands[h].wrench;
    for (std::size_t part = 0; part < 2; ++part) {
      const double size = std::hypot(F[3 * part], F[3 * part + 1], F[3 * part + 2]);
      hands[h][part] = std::max(hands[h][part], static_cast<float>(size));
    }
  }
}

std::string PackFrame(const TickRecord& record, const Peaks& peaks, std::uint64_t sent_ns,
                      bool recording) {
  const Table& table = TheTable();
  std::string bytes(table.bytes(), '\0');
  const Source source{record, peaks, sent_ns, recording};
  for (const Column& column : table.columns())
    column.write(source, bytes.data() + column.field.offset);
  return bytes;
}

}  // namespace predictor
