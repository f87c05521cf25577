// Fills the record of a tick.
#include <algorithm>
#include <cmath>

#include "emulator/emulator_impl.h"
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

}  // namespace

// truth: what the virtual operator does; null: a person holds the handles, whom nobody reads.
void Emulator::Impl::RecordHand(std::size_t i, const OperatorOutput* truth) noexcept {
  HandRecord& h = record.hands[i];
  h.gripping = truth ? truth->grip[i] > 0.5 : record.state == RunState::kRun;
  h.real = ToRecord(real[i]);
  h.virtual_ = ToRecord(before.handle[i]);
  Eigen::Map<Vector6>(h.wrench.data()) = wrench[i].F_H_W;
  Eigen::Map<Vector6>(h.coupling.data()) = world.state().coupling[i];
  if (truth) Eigen::Map<Vector6>(h.true_wrench.data()) = direct ? wrench[i].F_H_W : truth->F_H_W[i];
  if (direct) return;
  const ArmSample& arm = sample.arms[i];
  h.arm_dof = static_cast<std::uint8_t>(arm.q.size());
  h.sensor_saturated = arm.sensor_saturated;
  h.arm_fault = arm.fault;
  h.arm_in_motion = arm.in_motion;
  h.arm_waits = arm.waits;
  h.warnings = warnings.bits(i);
  h.warning_values = warnings.values(i);
  h.arm_sequence = arm.arm_sequence;
  h.sensor_sequence = arm.sensor_sequence;
  Eigen::Map<Vector6>(h.wrench_raw.data()) = arm.F_S_raw;
  Fill(arm.q, &h.q);
  Fill(arm.v, &h.v);
  Fill(command.v[i], &h.command);
  h.arm_age = arm.arm_age;
  h.sensor_age = arm.sensor_age;
  h.manipulability = rendered.manipulability[i];
  h.at_lower = rendered.at_lower[i];
  h.at_upper = rendered.at_upper[i];
}

void Emulator::Impl::RecordRendering() noexcept {
  TickRecord& r = record;
  r.qp_relaxed = rendered.relaxed;
  r.qp_failed = rendered.failed;
  r.qp_iterations = rendered.iterations;
  r.qp_rows = rendered.rows;
  Eigen::Map<Vector6>(r.relative_slack.data()) = rendered.relative_slack;
  r.elbow_slack = rendered.elbow_slack;
  r.elbow_distance = direct ? HUGE_VAL : rendered.elbow_distance;
  r.kkt_residual = rendered.kkt_residual;
}

void Emulator::Impl::Record(std::uint64_t wall_ns) noexcept {
  TickRecord& r = record;
  ++r.tick;
  r.run_time = run_time;
  r.wall_ns = wall_ns;
  r.state = states.state();
  r.cause = latched.cause;
  r.cause_hand = latched.hand;
  r.cause_value = latched.value;
  r.cause_limit = latched.limit;
  r.cause_quantity = latched.quantity;
  const OperatorOutput* truth = direct || rig ? &hands : nullptr;
  if (truth)
    r.action = truth->action;
  else  // a person whom nobody reads: by the clock
    r.action = r.state == RunState::kRun ? ActionAt(scenario.operator_.script, run_time) : -1;
  r.hands_gripping = 0;
  for (std::size_t i = 0; i < kHands; ++i) {
    HandRecord& h = r.hands[i];
    h.present = present[i];
    if (!present[i]) continue;
    RecordHand(i, truth);
    r.hands_gripping = static_cast<std::uint8_t>(r.hands_gripping + h.gripping);
  }
  r.cobot_dof = static_cast<std::uint8_t>(before.cobot_dof);
  Fill(before.q, &r.cobot_q);
  Fill(before.v, &r.cobot_v);
  Fill(world.state().torque, &r.cobot_torque);
  r.object = ToRecord(before.object);
  r.end_effector = ToRecord(before.end_effector);
  r.ran = ran;
  r.rendered = solved;
  r.input_count = static_cast<std::uint8_t>(input_count);
  std::copy_n(inputs.begin(), input_count, r.inputs.begin());
  std::fill(r.inputs.begin() + input_count, r.inputs.end(), RunInput());
  r.requests = asked;
  r.missed = missed;
  r.read = ToRecord(reading);
  r.written = ToRecord(writing);
  r.harder = ToRecord(harder);
  std::copy_n(parameters.values(), kParameters, r.parameters.begin());
  r.energy = world.state().energy;
  RecordRendering();
  timer.Finish(&r.stage_us);
}

// Everything that a later tick depends on, and what the record tells of earlier ones.
void Emulator::Impl::Archive(StateArchive& a) noexcept {
  a(world, arms, parameters, monitor, warnings, guard, states, stopper, hand_inputs, sample,
    command.v, hands, rendered, real, wrench, headset, latched, harder, enabling_age, well_time,
    doubtful, aligned, tared, handle_twist, handle_speed, handle_rate, run_time, state_time,
    record.tick);
  for (std::size_t i = 0; i < kHands; ++i)
    if ((sample.arms[i].present || wrench[i].present) && !present[i]) a.Fail();
  if (device) device->Archive(a);
  if (renderer) renderer->Archive(a);
  if (person) person->Archive(a);
}

}  // namespace predictor
