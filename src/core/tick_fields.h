// The table of recorded quantities: name, unit, frame and meaning of every field of TickRecord.
//
// All code that reads records by name is derived from this table: the schema, the writer and the
// reader of recordings; the columns of `export-data`; `replay --verify`; the states that pages
// receive, with their TypeScript types; and the topics for Foxglove. To add a quantity, add a
// member to TickRecord, a row for the member here, and the line that sets the member.
//
// A visitor V offers a method for each kind of row, called with the row and the member:
//   Value      a number or an enumeration       Flag      0 or 1
//   Presence   a Flag: 0 empties its group      Unchecked an enumeration that may hold any byte
//   Values     numbers                          Named     numbers that have names
//   Joints     a number per joint, dof of them  Pose, Twist, Wrench
//   Poses      a list of poses, count of them
//   Reserved   padding, always zero             Message   a group of rows with a name of its own
//   Inputs     a list of messages, count of them
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/record.h"

namespace predictor {

inline constexpr std::array<const char*, kQuantities> kQuantityNames = {
    "none",         "count",
    "force",        "torque",
    "length",       "angle",
    "speed",        "angular_speed",
    "time",         "arm_age",
    "sensor_age",   "vibration",
    "acceleration", "angular_acceleration",
    "not_finite",   "allocations"};
static_assert(kQuantityNames.back() != nullptr);  // a name for each quantity

struct TickField {
  const char* name;
  // "" for counts, ratios, flags and enumerations; "A or B" is A for a revolute joint and B for a
  // prismatic joint.
  const char* unit = "";
  const char* frame = "";  // frame whose axes the components refer to
  const char* meaning = "";
  // Name of the field in the states that are sent to pages. It is appended to the names of the
  // field's group and message. If the name is null, the field is not sent.
  const char* page = nullptr;
  bool of_clock = false;  // measured by the computer's clock, so a replay does not reproduce it
};

// The messages of one tick, in the order in which they are recorded.
enum class TickGroup : int {
  kRun,
  kInputs,
  kLeft,
  kRight,
  kCobot,
  kObject,
  kMovables,
  kQp,
  kTiming
};
struct TickGroupRow {
  const char *topic, *type, *page;
};
inline constexpr std::array kTickGroups = {
    TickGroupRow{"/run", "predictor_msgs/msg/Run", ""},
    TickGroupRow{"/inputs", "predictor_msgs/msg/Inputs", ""},
    TickGroupRow{"/hands/left", "predictor_msgs/msg/Hand", "left_"},
    TickGroupRow{"/hands/right", "predictor_msgs/msg/Hand", "right_"},
    TickGroupRow{"/cobot", "predictor_msgs/msg/Cobot", ""},
    TickGroupRow{"/object", "predictor_msgs/msg/Object", ""},
    TickGroupRow{"/movables", "predictor_msgs/msg/Movables", ""},
    TickGroupRow{"/qp", "predictor_msgs/msg/Qp", ""},
    TickGroupRow{"/timing", "predictor_msgs/msg/Timing", ""},
};
inline constexpr int kTickGroupCount = kTickGroups.size();
static_assert(static_cast<int>(TickGroup::kTiming) + 1 == kTickGroupCount);

template <class V, class S>
constexpr void VisitStatus(V& v, S& s) {
  v.Value({"cause", "", "", "", "cause"}, s.cause);
  v.Value({"hand", "", "", "0 left, 1 right, -1 neither or both", "cause_hand"}, s.hand);
  v.Value({"quantity", "", "", "quantity of that value and limit", "cause_quantity"}, s.quantity);
  v.Flag({"power_off", "", "", "the stop must cut the power (S1)"}, s.power_off);
  v.Reserved(s.reserved);
  v.Value({"value", "", "", "measured value of the cause, SI", "cause_value"}, s.value);
  v.Value({"limit", "", "", "limit of that value, SI", "cause_limit"}, s.limit);
}

template <class V, class I>
constexpr void VisitInput(V& v, I& input) {
  v.Unchecked({"kind", "", "", "number of the InputKind"}, input.kind);
  v.Unchecked({"parameter", "", "", "number of the live parameter that the input sets"},
              input.parameter);
  v.Value({"hand", "", "", "0 left, 1 right"}, input.hand);
  v.Flag({"grip", "", "", "the hand is closed"}, input.grip);
  v.Value({"client", "", "", "number of the page"}, input.client);
  v.Value({"value", "", "", "new value of the parameter, or the value that the kind needs"},
          input.value);
  v.Values({"p", "m", "W", "position; of a latency: times [ms]"}, input.p);
  v.Values({"q", "", "W", "orientation, scalar first"}, input.q);
}

template <class V, class M>
constexpr void VisitMotion(V& v, M& m) {
  v.Pose({"pose", "", "W", "", ""}, m.pose);
  v.Twist({"twist", "", "W"}, m.twist);
}

template <class V, class R>
constexpr void VisitRun(V& v, R& r) {
  v.Value({"tick", "", "", "counts from process start", "tick"}, r.tick);
  v.Value({"run_time", "s", "", "simulated time since RUN began", "run_time"}, r.run_time);
  v.Value({"wall_ns", "ns", "", "monotonic clock at the tick's start; 0 in virtual time", "wall_ns",
           true},
          r.wall_ns);
  v.Value({"state", "", "", "state of the run", "state"}, r.state);
  v.Value({"cause", "", "", "cause of the stop, until reset", "cause"}, r.cause);
  v.Value({"cause_hand", "", "", "0 left, 1 right, -1 neither or both", "cause_hand"},
          r.cause_hand);
  v.Value({"hands_gripping", "", "", "number of hands that grip"}, r.hands_gripping);
  v.Value({"action", "", "", "index in the operator's script; -1 none", "action"}, r.action);
  v.Value({"cause_value", "", "", "measured value of the cause, SI", "cause_value"}, r.cause_value);
  v.Value({"cause_limit", "", "", "limit of that value, SI", "cause_limit"}, r.cause_limit);
  v.Value({"cause_quantity", "", "", "quantity of that value and limit", "cause_quantity"},
          r.cause_quantity);
  v.Flag({"ran", "", "", "simulated time passed in this tick"}, r.ran);
  v.Flag({"rendered", "", "", "a QP was solved, or the attempt failed"}, r.rendered);
  v.Value({"refused", "", "", "1 + event of the last request that was refused; 0 none"}, r.refused);
  v.Value({"why_refused", "", "",
           "0 none, then: not enabled, joint limit exceeded, links too close, cause still present, "
           "hand loaded, not free, moving, not aligned"},
          r.why_refused);
  v.Value({"controller", "", "",
           "the cobot's controller: 0 computed, 1 was late and fell back, 2 failed"},
          r.controller);
  v.Value({"events", "", "", "bits: active entries of the scenario's events", "events"}, r.events);
  v.Value(
      {"latest_event", "", "", "1 + number of the hazard that began last; 0 none", "latest_event"},
      r.latest_event);
  v.Value({"cobot_stop", "", "",
           "protective stop of the virtual cobot itself: 0 none, then: force, speed, momentum, "
           "joint torque (in a prismatic joint: force)",
           "cobot_stop"},
          r.cobot_stop);
  v.Value({"attachment", "", "",
           "the cobot's grip on the object: 0 holds, 1 slips, 2 open, 3 open, because the object "
           "was too far away to be grasped",
           "attachment"},
          r.attachment);
  v.Reserved(r.reserved);
  v.Value({"requests", "", "", "bits: requests handled in this tick"}, r.requests);
  v.Value({"qp_rows", "", "", "bits: active rows of the limits (link pairs)"}, r.qp_rows);
  v.Value({"missed", "", "", "deadlines missed in a row"}, r.missed);
  v.Message({"read", "", "", "result of the device's read"}, "predictor_msgs/Status",
            [&](auto& inner) { VisitStatus(inner, r.read); });
  v.Message({"written", "", "", "result of the device's write"}, "predictor_msgs/Status",
            [&](auto& inner) { VisitStatus(inner, r.written); });
  v.Message({"harder", "", "", "fault that escalated the stop from hold to power-off", "harder_"},
            "predictor_msgs/Status", [&](auto& inner) { VisitStatus(inner, r.harder); });
  v.Values({"parameters", "", "",
            "factors of translational stiffness, rotational stiffness and damping; thresholds of "
            "force [N] and torque [N m]",
            "parameters"},
           r.parameters);
  v.Values({"perturbation", "m", "W",
            "commanded displacement of the real handles from the virtual ones"},
           r.perturbation);
}

template <class V, class R>
constexpr void VisitInputs(V& v, R& r) {
  v.Value({"input_count", "", "", "inputs taken in this tick"}, r.input_count);
  v.Inputs({"inputs", "", "", "from people and pages"}, "predictor_msgs/Input", r.inputs,
           r.input_count, [](auto& inner, auto& input) { VisitInput(inner, input); });
}

template <class V, class H>
constexpr void VisitHand(V& v, H& h) {
  v.Presence({"present", "", "", "the arm exists", "present"}, h.present);
  v.Flag({"gripping", "", "", "simulated operator: grips; otherwise: the state is RUN", "gripping"},
         h.gripping);
  v.Value({"arm_dof", "", "", "joints of the arm"}, h.arm_dof);
  v.Flag({"sensor_saturated", "", "", "a reading exceeds the range of the force-torque sensor"},
         h.sensor_saturated);
  v.Flag({"arm_fault", "", "", "the arm reports a fault", "arm_fault"}, h.arm_fault);
  v.Value(
      {"warnings", "", "",
       "bits: arm samples lost, sensor samples lost, packets refused, bias drifts, power cannot "
       "be cut, power on although it was to be cut"},
      h.warnings);
  v.Value({"at_lower", "", "", "bits: joints whose lower bound was active"}, h.at_lower);
  v.Value({"at_upper", "", "", "bits: joints whose upper bound was active"}, h.at_upper);
  v.Flag({"arm_in_motion", "", "", "the driver is still ramping the arm down"}, h.arm_in_motion);
  v.Flag({"arm_waits", "", "", "the arm's controller has not started the motion yet"}, h.arm_waits);
  v.Reserved(h.more_reserved);
  v.Message({"real", "", "", "handle H, measured", "real"}, "predictor_msgs/Motion",
            [&](auto& inner) { VisitMotion(inner, h.real); });
  v.Message({"virtual_handle", "", "", "handle D", "virtual"}, "predictor_msgs/Motion",
            [&](auto& inner) { VisitMotion(inner, h.virtual_); });
  v.Wrench({"wrench_raw", "", "S", "reading of the sensor"}, h.wrench_raw);
  v.Wrench({"wrench", "", "W", "wrench of the hand on the handle, about H", "wrench"}, h.wrench);
  v.Wrench({"coupling", "", "W", "wrench of the virtual coupling on D", "coupling"}, h.coupling);
  v.Wrench({"true_wrench", "", "W", "simulated rig: true wrench of the hand, about H"},
           h.true_wrench);
  v.Joints({"q", "rad", "", "joint positions of the arm, measured", "arm_q"}, h.q, h.arm_dof);
  v.Joints({"v", "rad/s", "", "joint velocities of the arm, measured"}, h.v, h.arm_dof);
  v.Joints({"command", "rad/s", "", "joint velocities sent to the arm"}, h.command, h.arm_dof);
  v.Value({"arm_age", "s", "", "age of the arm's sample"}, h.arm_age);
  v.Value({"sensor_age", "s", "", "age of the sensor's sample", "sensor_age"}, h.sensor_age);
  v.Value({"arm_sequence", "", "", "number of the arm's sample"}, h.arm_sequence);
  v.Value({"sensor_sequence", "", "", "number of the sensor's sample"}, h.sensor_sequence);
  v.Value({"manipulability", "", "", "translational manipulability of the arm", "manipulability"},
          h.manipulability);
  v.Values({"warning_values", "", "",
            "share of samples lost within a second (arm, sensor), packets refused [1/s], drift of "
            "the bias [N/min]"},
           h.warning_values);
}

template <class V, class R>
constexpr void VisitCobot(V& v, R& r) {
  v.Value({"dof", "", "", "joints of the cobot"}, r.cobot_dof);
  v.Joints({"q", "rad or m", "", "joint positions; in m for a prismatic joint", "cobot_q"},
           r.cobot_q, r.cobot_dof);
  v.Joints({"v", "rad/s or m/s", "", "joint velocities; in m/s for a prismatic joint"}, r.cobot_v,
           r.cobot_dof);
  v.Joints({"torque", "N m or N", "",
            "torques that the controller commands; in N for a prismatic joint"},
           r.cobot_torque, r.cobot_dof);
  v.Message({"end_effector", "", "", "end-effector E", "end_effector"}, "predictor_msgs/Motion",
            [&](auto& inner) { VisitMotion(inner, r.end_effector); });
}

template <class V, class R>
constexpr void VisitObject(V& v, R& r) {
  v.Message({"object", "", "", "object O", "object"}, "predictor_msgs/Motion",
            [&](auto& inner) { VisitMotion(inner, r.object); });
  v.Value({"energy", "J", "", "energy of the virtual world"}, r.energy);
}

template <class V, class R>
constexpr void VisitMovables(V& v, R& r) {
  v.Value({"count", "", "", "entries of the scenario's environment.objects"}, r.movable_count);
  v.Poses({"poses", "", "W", "of the scenario's environment.objects, in their order", "movables"},
          r.movables, r.movable_count);
  v.Value(
      {"held", "", "", "1 + entry of environment.objects that the carried object holds; 0 none"},
      r.held);
  v.Value({"held_grip", "", "",
           "the carried object's grip on a movable one: 0 holds, 1 slips, 2 open, 3 open, because "
           "the movable object was too far away to be picked up"},
          r.held_grip);
}

template <class V, class R>
constexpr void VisitQp(V& v, R& r) {
  v.Flag({"relaxed", "", "", "a slack is above its tolerance", "qp_relaxed"}, r.qp_relaxed);
  v.Flag({"failed", "", "", "no verified solution", "qp_failed"}, r.qp_failed);
  v.Flag({"guard_altered", "", "", "the guard changed the command", "guard_altered"},
         r.guard_altered);
  v.Value({"iterations", "", "", "iterations of the solver"}, r.qp_iterations);
  v.Twist({"relative_slack", "", "", "slack of the relative-pose task", "relative_slack"},
          r.relative_slack);
  v.Value({"limit_slack", "m/s", "", "amount by which the QP relaxed the worst limit"},
          r.limit_slack);
  v.Value({"link_distance", "m", "",
           "distance of the nearest link pair; inf without pairs and before the first QP",
           "link_distance"},
          r.link_distance);
  v.Value({"kkt_residual", "", "", "largest residual of the optimality conditions, scaled"},
          r.kkt_residual);
}

template <class V, class R>
constexpr void VisitTiming(V& v, R& r) {
  v.Named({"stage_us", "us", "", "computing time of the stage (tick: of all)", "stage_us", true},
          kStageNames, r.stage_us);
}

template <class V, class R>
constexpr void VisitGroup(TickGroup group, V& v, R& r) {
  switch (group) {
    case TickGroup::kRun:
      return VisitRun(v, r);
    case TickGroup::kInputs:
      return VisitInputs(v, r);
    case TickGroup::kLeft:
      return VisitHand(v, r.hands[0]);
    case TickGroup::kRight:
      return VisitHand(v, r.hands[1]);
    case TickGroup::kCobot:
      return VisitCobot(v, r);
    case TickGroup::kObject:
      return VisitObject(v, r);
    case TickGroup::kMovables:
      return VisitMovables(v, r);
    case TickGroup::kQp:
      return VisitQp(v, r);
    case TickGroup::kTiming:
      return VisitTiming(v, r);
  }
}

// Sums the sizes of the visited members.
struct SizeVisitor {
  std::size_t bytes = 0;
  constexpr void Reserved(const auto& x) { bytes += sizeof x; }
  constexpr void Value(const TickField&, const auto& x) { bytes += sizeof x; }
  constexpr void Flag(const TickField&, const auto& x) { bytes += sizeof x; }
  constexpr void Presence(const TickField&, const auto& x) { bytes += sizeof x; }
  constexpr void Unchecked(const TickField&, const auto& x) { bytes += sizeof x; }
  constexpr void Values(const TickField&, const auto& x) { bytes += sizeof x; }
  constexpr void Named(const TickField&, const auto&, const auto& x) { bytes += sizeof x; }
  constexpr void Joints(const TickField&, const auto& x, const auto&) { bytes += sizeof x; }
  constexpr void Pose(const TickField&, const auto& x) { bytes += sizeof x; }
  constexpr void Poses(const TickField&, const auto& x, const auto&) { bytes += sizeof x; }
  constexpr void Twist(const TickField&, const auto& x) { bytes += sizeof x; }
  constexpr void Wrench(const TickField&, const auto& x) { bytes += sizeof x; }
  constexpr void Message(const TickField&, const char*, auto&& visit) { visit(*this); }
  constexpr void Inputs(const TickField&, const char*, const auto& list, const auto&,
                        auto&& visit) {
    for (const auto& item : list) visit(*this, item);
  }
};

constexpr std::size_t VisitedBytes() {
  const TickRecord r{};
  SizeVisitor v;
  for (int g = 0; g < kTickGroupCount; ++g) VisitGroup(static_cast<TickGroup>(g), v, r);
  return v.bytes;
}
static_assert(VisitedBytes() == sizeof(TickRecord),
              "Either a field of TickRecord has no row in this table, or TickRecord has padding "
              "between fields.");

}  // namespace predictor
