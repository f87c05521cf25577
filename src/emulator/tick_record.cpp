#include "emulator/tick_record.h"

#include <algorithm>
#include <cmath>

#include "scenario/action_time.h"

namespace predictor {
namespace {

MotionRecord ToRecord(const FrameMotion& m) {
  MotionRecord r;
  r.pose = predictor::ToRecord(m.X_W);
  Eigen::Map<Vector6>(r.twist.data()) = m.V_W;
  return r;
}

template <std::size_t N>
void Fill(const JointVector& from, std::array<double, N>* to) {
  for (Eigen::Index j = 0; j < from.size(); ++j) (*to)[static_cast<std::size_t>(j)] = from[j];
}

void FillHand(const RecordSources& from, std::size_t i, HandRecord* hand) noexcept {
  HandRecord& h = *hand;
  const TickData& data = from.data;
  const bool direct = from.scenario.mode == Mode::kDirect;
  h.gripping = from.simulated_operator ? data.person.grip[i] > 0.5
                                       : from.supervisor.state() == RunState::kRun;
  h.real = ToRecord(data.real[i]);
  h.virtual_ = ToRecord(data.before.handle[i]);
  Eigen::Map<Vector6>(h.wrench.data()) = data.wrench[i].F_H_W;
  Eigen::Map<Vector6>(h.coupling.data()) = data.after->coupling[i];
  if (from.simulated_operator)
    Eigen::Map<Vector6>(h.true_wrench.data()) =
        direct ? data.wrench[i].F_H_W : data.person.F_H_W[i];
  if (direct) return;
  const ArmSample& arm = data.sample.arms[i];
  h.arm_dof = static_cast<std::uint8_t>(arm.q.size());
  h.sensor_saturated = arm.sensor_saturated;
  h.arm_fault = arm.fault;
  h.arm_in_motion = arm.in_motion;
  h.arm_waits = arm.waits;
  h.warnings = from.supervisor.warnings().bits(i);
  h.warning_values = from.supervisor.warnings().values(i);
  h.arm_sequence = arm.arm_sequence;
  h.sensor_sequence = arm.sensor_sequence;
  Eigen::Map<Vector6>(h.wrench_raw.data()) = arm.F_S_raw;
  Fill(arm.q, &h.q);
  Fill(arm.v, &h.v);
  Fill(data.command.v[i], &h.command);
  h.arm_age = arm.arm_age;
  h.sensor_age = arm.sensor_age;
  h.manipulability = data.rendered.manipulability[i];
  h.at_lower = data.rendered.at_lower[i];
  h.at_upper = data.rendered.at_upper[i];
}

void FillHands(const RecordSources& from, TickRecord* record) noexcept {
  record->hands_gripping = 0;
  for (std::size_t i = 0; i < kHands; ++i) {
    HandRecord& hand = record->hands[i];
    hand.present = from.scenario.Has(static_cast<int>(i));
    if (!hand.present) continue;
    FillHand(from, i, &hand);
    record->hands_gripping = static_cast<std::uint8_t>(record->hands_gripping + hand.gripping);
  }
}

void FillRendering(const RecordSources& from, TickRecord* record) noexcept {
  TickRecord& r = *record;
  const RenderResult& rendered = from.data.rendered;
  r.rendered = from.plan.renders;
  r.qp_relaxed = rendered.relaxed;
  r.qp_failed = rendered.failed;
  r.qp_iterations = rendered.iterations;
  r.qp_rows = rendered.rows;
  Eigen::Map<Vector6>(r.relative_slack.data()) = rendered.relative_slack;
  r.limit_slack = rendered.limit_slack;
  r.link_distance = from.scenario.mode == Mode::kDirect ? HUGE_VAL : rendered.link_distance;
  r.kkt_residual = rendered.kkt_residual;
}

void FillWorld(const TickData& data, TickRecord* record) noexcept {
  TickRecord& r = *record;
  r.cobot_dof = static_cast<std::uint8_t>(data.before.cobot_dof);
  Fill(data.before.q, &r.cobot_q);
  Fill(data.before.v, &r.cobot_v);
  Fill(data.after->torque, &r.cobot_torque);
  r.object = ToRecord(data.before.object);
  r.end_effector = ToRecord(data.before.end_effector);
  r.movable_count = static_cast<std::uint8_t>(data.before.movables.count);
  for (std::size_t i = 0; i < r.movable_count; ++i)
    r.movables[i] = predictor::ToRecord(data.before.movables.motion[i].X_W);
  r.energy = data.after->energy;
  r.controller = static_cast<std::uint8_t>(data.after->controller);
  r.events = data.after->events;
  r.latest_event = data.after->latest_event;
  r.cobot_stop = data.after->cobot_stop;
  r.attachment = static_cast<std::uint8_t>(data.after->attachment);
  r.held = static_cast<std::uint8_t>(data.after->movables.held + 1);
  r.held_grip =
      r.movable_count > 0 ? static_cast<std::uint8_t>(data.after->movables.grip) : std::uint8_t{0};
}

void FillDecisions(const RecordSources& from, TickRecord* record) noexcept {
  TickRecord& r = *record;
  const Supervisor& supervisor = from.supervisor;
  r.run_time = supervisor.run_time();
  r.state = supervisor.state();
  const Status& fault = supervisor.fault();
  r.cause = fault.cause;
  r.cause_hand = fault.hand;
  r.cause_value = fault.value;
  r.cause_limit = fault.limit;
  r.cause_quantity = fault.quantity;
  r.harder = ToRecord(supervisor.power_off_cause());
  r.requests = from.data.requests.recorded();
  r.refused = supervisor.refused().event;
  r.why_refused = static_cast<std::uint8_t>(supervisor.refused().why);
  const int count = supervisor.input_count();
  r.input_count = static_cast<std::uint8_t>(count);
  std::copy_n(supervisor.inputs().begin(), count, r.inputs.begin());
  std::fill(r.inputs.begin() + count, r.inputs.end(), RunInput());
  std::copy_n(supervisor.parameters().values(), kParameters, r.parameters.begin());
}

// If no hands of a person are measured, the recorded action is the current action of the script.
int ActionOf(const RecordSources& from) noexcept {
  if (from.simulated_operator) return from.data.person.action;
  if (from.supervisor.state() != RunState::kRun) return -1;
  return ActionAt(from.script, from.supervisor.run_time());
}

}  // namespace

void BuildRecord(const RecordSources& from, std::uint64_t wall_ns, TickRecord* record) noexcept {
  TickRecord& r = *record;
  ++r.tick;
  r.wall_ns = wall_ns;
  r.missed = from.data.missed;
  r.read = ToRecord(from.data.reading);
  r.written = ToRecord(from.data.writing);
  r.ran = from.plan.time_passes;
  r.action = ActionOf(from);
  r.guard_altered = static_cast<std::uint8_t>(from.data.guard_altered);
  Eigen::Map<Vector3>(r.perturbation.data()) = from.data.perturbation;
  FillDecisions(from, record);
  FillHands(from, record);
  FillWorld(from.data, record);
  FillRendering(from, record);
}

}  // namespace predictor
