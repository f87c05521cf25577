// What of a record lies in which message. One walk over the fields serves the schema, the encoder
// and the decoder; that no field is forgotten is checked while compiling.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "core/record.h"

namespace predictor::recording {

// The messages of one tick, in the order in which they are written.
enum class Group : int { kRun, kInputs, kLeft, kRight, kCobot, kObject, kQp, kTiming };
inline constexpr int kGroups = 8;
struct GroupName {
  const char *topic, *type;
};
inline constexpr std::array<GroupName, kGroups> kGroupNames = {{
    {"/run", "predictor_msgs/msg/Run"},
    {"/inputs", "predictor_msgs/msg/Inputs"},
    {"/hands/left", "predictor_msgs/msg/Hand"},
    {"/hands/right", "predictor_msgs/msg/Hand"},
    {"/cobot", "predictor_msgs/msg/Cobot"},
    {"/object", "predictor_msgs/msg/Object"},
    {"/qp", "predictor_msgs/msg/Qp"},
    {"/timing", "predictor_msgs/msg/Timing"},
}};

template <class V, class S>
constexpr void VisitStatus(V& v, S& s) {
  v.Enum("cause", s.cause);
  v.Value("hand", s.hand, "0 left, 1 right, -1 neither or both");
  v.Enum("quantity", s.quantity);
  v.Value("power_off", s.power_off, "the stop must end without power");
  v.Reserved(s.reserved);
  v.Value("value", s.value, "SI");
  v.Value("limit", s.limit, "SI");
}

template <class V, class I>
constexpr void VisitInput(V& v, I& input) {
  v.Loose("kind", input.kind);
  v.Loose("parameter", input.parameter);
  v.Value("hand", input.hand);
  v.Value("grip", input.grip);
  v.Value("client", input.client);
  v.Value("value", input.value);
  v.Values("p", input.p, "[m] in W; of a latency [ms]");
  v.Values("q", input.q, "scalar first");
}

template <class V, class M>
constexpr void VisitMotion(V& v, M& m) {
  v.Pose("pose", m.pose);
  v.Twist("twist", m.twist);
}

template <class V, class R>
constexpr void VisitRun(V& v, R& r) {
  v.Value("tick", r.tick);
  v.Value("run_time", r.run_time, "[s] simulated, since RUN began");
  v.Value("wall_ns", r.wall_ns, "[ns] monotonic clock; 0 in virtual time");
  v.Enum("state", r.state);
  v.Enum("cause", r.cause);
  v.Value("cause_hand", r.cause_hand, "0 left, 1 right, -1 neither or both");
  v.Value("hands_gripping", r.hands_gripping);
  v.Value("action", r.action, "of the simulated person's script; -1 none");
  v.Value("cause_value", r.cause_value, "SI");
  v.Value("cause_limit", r.cause_limit, "SI");
  v.Enum("cause_quantity", r.cause_quantity);
  v.Value("ran", r.ran);
  v.Value("rendered", r.rendered);
  v.Value("refused", r.refused, "1 + event of a request that was not granted; 0 none");
  v.Value("why_refused", r.why_refused,
          "not enabled, beyond joint, beyond links, cause remains, hand loaded, not free, moves, "
          "not aligned");
  v.Reserved(r.reserved);
  v.Value("requests", r.requests, "bits");
  v.Value("qp_rows", r.qp_rows, "bits: rows of limits (link pairs) that were active");
  v.Value("missed", r.missed, "deadlines in a row");
  v.Message("read", "predictor_msgs/Status", [&](auto& inner) { VisitStatus(inner, r.read); });
  v.Message("written", "predictor_msgs/Status",
            [&](auto& inner) { VisitStatus(inner, r.written); });
  v.Message("harder", "predictor_msgs/Status", [&](auto& inner) { VisitStatus(inner, r.harder); });
  v.Values("parameters", r.parameters,
           "stiffness translation, rotation, damping ratio (factors), force [N], torque [N m]");
}

template <class V, class R>
constexpr void VisitInputs(V& v, R& r) {
  v.Value("input_count", r.input_count, "taken in this tick");
  v.Inputs("inputs", "predictor_msgs/Input", r.inputs, r.input_count,
           [](auto& inner, auto& input) { VisitInput(inner, input); });
}

template <class V, class H>
constexpr void VisitHand(V& v, H& h) {
  v.Value("present", h.present);
  v.Value("gripping", h.gripping);
  v.Value("arm_dof", h.arm_dof);
  v.Value("sensor_saturated", h.sensor_saturated);
  v.Value("arm_fault", h.arm_fault);
  v.Value(
      "warnings", h.warnings,
      "bits: arm's samples lost, sensor's samples lost, packets refused, bias drifts, power off "
      "cannot be asked for any more, power is kept though it was to be cut");
  v.Value("at_lower", h.at_lower, "bits: joints whose lower bound was active");
  v.Value("at_upper", h.at_upper, "bits: joints whose upper bound was active");
  v.Value("arm_in_motion", h.arm_in_motion,
          "1: its driver leads it to rest by a way of its own, and is not there yet");
  v.Value("arm_waits", h.arm_waits, "1: its controller has not begun a motion: it does not obey");
  v.Reserved(h.more_reserved);
  v.Message("real", "predictor_msgs/Motion", [&](auto& inner) { VisitMotion(inner, h.real); });
  v.Message("virtual_handle", "predictor_msgs/Motion",
            [&](auto& inner) { VisitMotion(inner, h.virtual_); });
  v.Wrench("wrench_raw", h.wrench_raw, "[N, N m] sensor's reading, axes of S");
  v.Wrench("wrench", h.wrench, "[N, N m] of the hand on the handle, about H, axes of W");
  v.Wrench("coupling", h.coupling, "[N, N m] on D, axes of W");
  v.Wrench("true_wrench", h.true_wrench, "[N, N m] simulated rig only");
  v.Joints("q", h.q, h.arm_dof, "[rad]");
  v.Joints("v", h.v, h.arm_dof, "[rad/s]");
  v.Joints("command", h.command, h.arm_dof, "[rad/s]");
  v.Value("arm_age", h.arm_age, "[s]");
  v.Value("sensor_age", h.sensor_age, "[s]");
  v.Value("arm_sequence", h.arm_sequence);
  v.Value("sensor_sequence", h.sensor_sequence);
  v.Value("manipulability", h.manipulability);
  v.Values(
      "warning_values", h.warning_values,
      "shares of the samples lost within a second (arm, sensor), refused [1/s], drift [N/min]");
}

template <class V, class R>
constexpr void VisitCobot(V& v, R& r) {
  v.Value("dof", r.cobot_dof);
  v.Joints("q", r.cobot_q, r.cobot_dof, "[rad]");
  v.Joints("v", r.cobot_v, r.cobot_dof, "[rad/s]");
  v.Joints("torque", r.cobot_torque, r.cobot_dof, "[N m]");
  v.Message("end_effector", "predictor_msgs/Motion",
            [&](auto& inner) { VisitMotion(inner, r.end_effector); });
}

template <class V, class R>
constexpr void VisitObject(V& v, R& r) {
  v.Message("object", "predictor_msgs/Motion", [&](auto& inner) { VisitMotion(inner, r.object); });
  v.Value("energy", r.energy, "[J] of the virtual world");
}

template <class V, class R>
constexpr void VisitQp(V& v, R& r) {
  v.Value("relaxed", r.qp_relaxed);
  v.Value("failed", r.qp_failed);
  v.Value("guard_altered", r.guard_altered);
  v.Value("iterations", r.qp_iterations);
  v.Twist("relative_slack", r.relative_slack);
  v.Value("elbow_slack", r.elbow_slack, "[m/s]");
  v.Value("elbow_distance", r.elbow_distance,
          "[m]; inf without link pairs, and before the first QP");
  v.Value("kkt_residual", r.kkt_residual);
}

template <class V, class R>
constexpr void VisitTiming(V& v, R& r) {
  for (std::size_t s = 0; s < kStages; ++s) v.Value(kStageNames[s], r.stage_us[s], "[us]");
}

template <class V, class R>
constexpr void VisitGroup(Group group, V& v, R& r) {
  switch (group) {
    case Group::kRun:
      return VisitRun(v, r);
    case Group::kInputs:
      return VisitInputs(v, r);
    case Group::kLeft:
      return VisitHand(v, r.hands[0]);
    case Group::kRight:
      return VisitHand(v, r.hands[1]);
    case Group::kCobot:
      return VisitCobot(v, r);
    case Group::kObject:
      return VisitObject(v, r);
    case Group::kQp:
      return VisitQp(v, r);
    case Group::kTiming:
      return VisitTiming(v, r);
  }
}

// Bit by bit: −0 is not 0, and what is no number is what it was.
template <class T>
bool SameBits(const T& a, const T& b) {
  static_assert(std::is_trivially_copyable_v<T>);
  const void *at = &a, *bt = &b;
  return std::memcmp(at, bt, sizeof(T)) == 0;
}

// Sums the sizes of what is visited.
struct SizeVisitor {
  std::size_t bytes = 0;
  template <class T>
  constexpr void Add(const T&) {
    bytes += sizeof(T);
  }
  constexpr void Value(const char*, const auto& x, const char* = "") { Add(x); }
  constexpr void Enum(const char*, const auto& x) { Add(x); }
  constexpr void Loose(const char*, const auto& x) { Add(x); }
  constexpr void Values(const char*, const auto& x, const char* = "") { Add(x); }
  constexpr void Joints(const char*, const auto& x, std::size_t, const char*) { Add(x); }
  constexpr void Pose(const char*, const auto& x) { Add(x); }
  constexpr void Twist(const char*, const auto& x, const char* = "") { Add(x); }
  constexpr void Wrench(const char*, const auto& x, const char* = "") { Add(x); }
  constexpr void Reserved(const auto& x) { Add(x); }
  constexpr void Message(const char*, const char*, auto&& visit) { visit(*this); }
  constexpr void Inputs(const char*, const char*, const auto& list, std::size_t, auto&& visit) {
    for (const auto& item : list) visit(*this, item);
  }
};

constexpr std::size_t VisitedBytes() {
  const TickRecord r{};
  SizeVisitor v;
  for (int g = 0; g < kGroups; ++g) VisitGroup(static_cast<Group>(g), v, r);
  return v.bytes;
}
static_assert(VisitedBytes() == sizeof(TickRecord),
              "a field of TickRecord is in no message of a recording (add it to a Visit above), or "
              "there is padding between the fields");

}  // namespace predictor::recording
