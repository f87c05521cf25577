#include "viewer/frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

#include "core/tick_fields.h"

namespace predictor::viewer {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

// Values that only the viewer knows and adds to the record, together with a warning that the viewer
// raises.
struct Additions {
  std::uint64_t sent_ns;
  bool recording;
  std::array<bool, kHands> keeps_power;
  Peaks peaks;
};

template <class T>
constexpr const char* TypeName() {
  if constexpr (std::is_enum_v<T> || std::is_same_v<T, std::uint8_t>) return "u8";
  if constexpr (std::is_same_v<T, std::int8_t>) return "i8";
  if constexpr (std::is_same_v<T, std::uint16_t>) return "u16";
  if constexpr (std::is_same_v<T, std::int32_t>) return "i32";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "u32";
  if constexpr (std::is_same_v<T, std::uint64_t>) return "u64";
  if constexpr (std::is_same_v<T, float>) return "f32";
  if constexpr (std::is_same_v<T, double>) return "f64";
}

template <class T>
constexpr FrameKind KindOf() {
  if constexpr (std::is_same_v<T, RunState>) return FrameKind::kState;
  if constexpr (std::is_same_v<T, StopCause>) return FrameKind::kCause;
  if constexpr (std::is_same_v<T, Quantity>) return FrameKind::kQuantity;
  return FrameKind::kNumber;
}

// Iterates over the table of quantities and passes those with a name on the page to Sink: a single
// number in its own type, several numbers in single precision.
//   sink(name, row, kind, number)
//   sink(name, row, kind, floats)
template <class Sink>
class PageVisitor {
 public:
  explicit PageVisitor(Sink* sink) : sink_(sink) {}

  void Value(const TickField& f, const auto& x) { Send(f, KindOf<std::decay_t<decltype(x)>>(), x); }
  void Flag(const TickField& f, std::uint8_t x) { Send(f, FrameKind::kFlag, x); }
  void Presence(const TickField& f, std::uint8_t x) { Send(f, FrameKind::kFlag, x); }
  template <class T, std::size_t N>
  void Values(const TickField& f, const std::array<T, N>& x) {
    std::array<float, N> floats;
    for (std::size_t i = 0; i < N; ++i) floats[i] = static_cast<float>(x[i]);
    Send(f, FrameKind::kNumbers, floats);
  }
  void Named(const TickField& f, const auto&, const auto& x) { Values(f, x); }
  void Joints(const TickField& f, const auto& x, std::uint8_t) { Values(f, x); }
  void Twist(TickField f, const auto& x) { Values(WithUnit(f, "m/s, rad/s"), x); }
  void Wrench(TickField f, const auto& x) { Values(WithUnit(f, "N, N m"), x); }
  void Pose(const TickField& f, const PoseRecord& X) {
    std::array<float, kPoseNumbers> floats;
    WritePose(X, floats.data());
    Send(WithUnit(f, "m"), FrameKind::kPose, floats);
  }
  template <std::size_t N>
  void Poses(const TickField& f, const std::array<PoseRecord, N>& X, std::uint8_t) {
    std::array<float, kPoseNumbers * N> floats;
    for (std::size_t i = 0; i < N; ++i) WritePose(X[i], floats.data() + kPoseNumbers * i);
    Send(WithUnit(f, "m"), FrameKind::kPoses, floats);
  }
  void Reserved(const auto&) {}
  void Unchecked(const TickField&, const auto&) {}
  void Inputs(const TickField&, const char*, const auto&, std::uint8_t, auto&&) {}
  void Message(const TickField& f, const char*, auto&& visit) {
    if (f.page) Within(f.page, visit);
  }
  void Within(const char* prefix, auto&& visit) {
    const std::string before = std::exchange(prefix_, prefix_ + prefix);
    visit(*this);
    prefix_ = before;
  }

 private:
  static constexpr std::size_t kPoseNumbers = 7;
  static void WritePose(const PoseRecord& X, float* floats) {
    for (std::size_t i = 0; i < 3; ++i) floats[i] = static_cast<float>(X.p[i]);
    for (std::size_t i = 0; i < 4; ++i) floats[3 + i] = static_cast<float>(X.q[i]);
  }
  static TickField WithUnit(TickField f, const char* unit) {
    f.unit = unit;
    return f;
  }
  void Send(const TickField& f, FrameKind kind, const auto& x) {
    if (f.page) (*sink_)(prefix_ + f.page, f, kind, x);
  }
  Sink* sink_;
  std::string prefix_;
};

template <class Sink>
void SendRecord(const TickRecord& record, const Additions& added, Sink sink) {
  PageVisitor<Sink> visitor(&sink);
  for (int g = 0; g < kTickGroupCount; ++g)
    visitor.Within(kTickGroups[static_cast<std::size_t>(g)].page,
                   [&](auto& inner) { VisitGroup(static_cast<TickGroup>(g), inner, record); });
  visitor.Value({"", "ns", "", "monotonic clock when the server sent it", "sent_ns"},
                added.sent_ns);
  visitor.Flag({"", "", "", "the run is recorded", "recording"}, added.recording);
  for (std::size_t h = 0; h < kHands; ++h)
    visitor.Within(h == 0 ? "left_" : "right_", [&](auto& inner) {
      inner.Values({"", "N, N m", "", "largest force and torque since the previous state", "peak"},
                   added.peaks.hands[h]);
      inner.Flag(
          {"", "", "", "the arm reports power although it should have been cut", "keeps_power"},
          added.keeps_power[h]);
    });
}

std::string Comment(const TickField& f) {
  std::string text = *f.unit ? std::string("[") + f.unit + "]" : "";
  const auto add = [&](const std::string& words) {
    if (!words.empty()) text += (text.empty() ? "" : " ") + words;
  };
  add(*f.frame ? std::string("in ") + f.frame : "");
  add(f.meaning);
  return text;
}

struct Layout {
  std::vector<FrameField> fields;
  std::size_t bytes = 0;
};

const Layout& TheLayout() {
  static const Layout layout = [] {
    Layout made;
    const auto add = [&](const std::string& name, const TickField& f, FrameKind kind,
                         const auto& x) {
      FrameField field{name, static_cast<std::uint32_t>(made.bytes)};
      field.kind = kind;
      field.comment = Comment(f);
      if constexpr (requires { x.size(); }) {
        field.type = TypeName<float>();
        field.count = static_cast<std::uint32_t>(x.size());
      } else {
        field.type = TypeName<std::decay_t<decltype(x)>>();
      }
      made.fields.push_back(std::move(field));
      made.bytes += sizeof x;
    };
    SendRecord(TickRecord{}, {}, add);
    return made;
  }();
  return layout;
}

}  // namespace

const std::vector<FrameField>& FrameFields() { return TheLayout().fields; }

std::size_t FrameBytes() { return TheLayout().bytes; }

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
  Additions added{sent_ns, recording, {}, peaks};
  for (std::size_t h = 0; h < kHands; ++h)
    added.keeps_power[h] = Has(record.hands[h], Warning::kKeepsPower);
  std::string bytes;
  bytes.reserve(FrameBytes());
  SendRecord(record, added, [&](const std::string&, const TickField&, FrameKind, const auto& x) {
    char raw[sizeof x];
    std::memcpy(raw, &x, sizeof x);
    bytes.append(raw, sizeof x);
  });
  return bytes;
}

}  // namespace predictor::viewer
