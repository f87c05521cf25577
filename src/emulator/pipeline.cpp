#include "emulator/pipeline.h"

#include <algorithm>

#include "core/joint_twist.h"
#include "core/motion.h"
#include "emulator/placement.h"
#include "emulator/start_refusal.h"
#include "emulator/stop_reach.h"
#include "models/arm_limits.h"
#include "scenario/formulation.h"

namespace predictor {
namespace {

constexpr double kMaxStopSampleAge = 0.010;  // an older sample does not correct a stop [s]

}  // namespace

Pipeline::Pipeline(const Scenario& s)
    : scenario_(s),
      dt_(1 / s.rate),
      direct_(s.mode == Mode::kDirect),
      predicts_(RepairsOf(s.rendering).Has(Repair::kPredictedJacobian)),
      hands_(s.hands()),
      world_(s) {
  if (direct_) {
    person_ = MakeOperator(s, HandInertia::kInScene);
    return;
  }
  std::array<std::shared_ptr<const RobotModel>, kHands> models;
  double reaction = 0;
  for (const int i : hands_) {
    arms_[i].emplace(s, i, dt_);
    models[i] = arms_[i]->model();
    const ArmLimits limits = LimitsOf(s.arm(i), *models[i]);
    spec_.bounds[i] = {limits.lower, limits.upper, limits.velocity, limits.acceleration};
    spec_.lags[i] = HapticLoop::Lag(s.arm(i).loop, dt_);
    spec_.overruns[i] = Overrun(s.arm(i), dt_);
    reaction = std::max(reaction, ReactionTime(s.arm(i).loop) + dt_);
  }
  start_ = StartJoints(0);
  lead_ = ChooseLead(HapticLoop(world_.Linearise(), s, dt_), s, dt_);
  perturbation_.emplace(s, lead_.margin.gain, dt_);
  renderer_.emplace(s, models, lead_.lead, dt_);
  recovery_.emplace(s, models);
  guard_ = Guard(spec_.bounds, dt_, reaction);
}

std::array<JointVector, kHands> Pipeline::StartJoints(double offset) const {
  std::array<std::shared_ptr<const RobotModel>, kHands> models;
  std::array<FrameId, kHands> frames;
  for (int i = 0; i < kHands; ++i) {
    if (!arms_[i]) continue;
    models[i] = arms_[i]->model();
    frames[i] = arms_[i]->handle_frame();
  }
  const std::array<FrameMotion, kHands>& D = world_.state().handle;
  return PlaceArms(scenario_, models, frames, {D[0].X_W, D[1].X_W}, offset);
}

// ---- sense -------------------------------------------------------------------------------------

void Pipeline::Sense(const TickPlan& plan, TickData* data) noexcept {
  data->sensing = Status::Ok();
  if (direct_) return SenseDirectly(plan, data);
  for (const int i : hands_) SenseArm(plan, i, data);
}

void Pipeline::SenseArm(const TickPlan& plan, int hand, TickData* data) noexcept {
  ArmSide& arm = *arms_[hand];
  const ArmSample& sample = data->sample.arms[hand];
  Status status = arm.Update(sample);
  if (status.ok() && plan.state == RunState::kSelfTest) status = arm.Tare(sample);
  if (!status.ok() && data->sensing.ok()) {
    data->sensing = status;
    data->sensing.hand = static_cast<std::int8_t>(hand);
  }
  data->real[hand] = arm.handle();
  data->wrench[hand] = plan.wrench_known ? arm.wrench() : HandWrench();
}

// In direct mode, the hand's inertia is part of the scene. A sensor between hand and handle would
// therefore measure the hand's force without the force of its inertia.
void Pipeline::SenseDirectly(const TickPlan& plan, TickData* data) noexcept {
  OperatorInput input;
  input.dt = dt_;
  input.run_time = plan.run_time;
  input.running = plan.state == RunState::kRun;
  input.present = hands_;
  input.handle = data->before.handle;
  input.hands = plan.hand_inputs;
  person_->Step(input, &data->person);
  for (const int i : hands_) {
    const FrameMotion& handle = data->before.handle[i];
    data->real[i] = handle;
    data->wrench[i].present = true;
    data->wrench[i].F_H_W = data->person.F_H_W[i];
    data->wrench[i].F_H_W.head<3>() -= data->person.hand_mass[i] * handle.A_W.head<3>();
  }
}

// ---- simulate ----------------------------------------------------------------------------------

void Pipeline::Simulate(const TickPlan& plan, TickData* data) noexcept {
  data->simulation = Status::Ok();
  if (!plan.time_passes) return;
  if (plan.tuning) world_.Tune(*plan.tuning);
  // An invalid wrench never reaches the simulation.
  if (!data->reading.ok() || !data->sensing.ok()) return;
  WorldInput input;
  input.present = hands_;
  input.coupled = !direct_;
  input.handle = data->real;
  // A commanded displacement must not make the coupling pull the virtual handles.
  if (perturbation_) {
    for (const int i : hands_) {
      input.handle[i].X_W.p -= perturbation_->displacement();
      input.handle[i].V_W.head<3>() -= perturbation_->velocity();
    }
  }
  for (const int i : hands_) {
    input.F_H_W[i] = direct_ ? data->person.F_H_W[i] : data->wrench[i].F_H_W;
    input.hand_mass[i] = direct_ ? data->person.hand_mass[i] : 0;
  }
  data->simulation = world_.Step(input, dt_);
}

// ---- render ------------------------------------------------------------------------------------

std::array<RenderArm, kHands> Pipeline::View() const noexcept {
  std::array<RenderArm, kHands> view;
  for (const int i : hands_) {
    const ArmSide& arm = *arms_[i];
    view[i] = {true,
               arm.model().get(),
               &arm.data(),
               predicts_ ? &arm.ahead() : &arm.data(),
               arm.handle_frame(),
               &arm.q()};
  }
  return view;
}

// Outside RUN, there is no displacement, because only a stop or the alignment moves the arms.
void Pipeline::Perturb(const TickPlan& plan, TickData* data) noexcept {
  data->perturbation.setZero();
  if (!perturbation_ || plan.state != RunState::kRun || !plan.time_passes) return;
  PerturbationInput input;
  input.run_time = plan.run_time;
  input.present = hands_;
  input.wrench = data->wrench;
  input.virtual_ = data->before.handle;
  input.limited = data->rendered.relaxed || data->rendered.failed;
  perturbation_->Step(input);
  data->perturbation = perturbation_->displacement();
}

void Pipeline::Render(const TickPlan& plan, TickData* data) noexcept {
  data->haptics = Status::Ok();
  Perturb(plan, data);
  if (!plan.renders) return;
  RenderTarget target;
  target.aligning = plan.state == RunState::kAlign;
  target.speed_cap = plan.cap.speed;
  target.rotation_cap = plan.cap.rotation;
  const WorldState& after = world_.state();
  for (const int i : hands_) {
    arms_[i]->LookAhead(guard_.last()[i]);
    // Both poses are poses at the time of the sample, so their difference is the error. These
    // velocities and accelerations are the values after the step.
    target.handle[i] = data->before.handle[i];
    target.handle[i].V_W = target.aligning ? Twist(Twist::Zero()) : after.handle[i].V_W;
    target.handle[i].A_W = after.handle[i].A_W;
    if (plan.state != RunState::kRun || !perturbation_) continue;
    target.handle[i].X_W.p += perturbation_->displacement();
    target.handle[i].V_W.head<3>() += perturbation_->velocity();
    target.handle[i].A_W.head<3>() += perturbation_->acceleration();
  }
  data->haptics = renderer_->Render(View(), target, guard_.last(), &data->rendered);
}

// ---- command -----------------------------------------------------------------------------------

void Pipeline::Command(const MotionOrder& order, TickData* data) noexcept {
  std::array<JointVector, kHands>& v = data->command.v;
  if (order.motion == Motion::kRecover)
    for (const int i : hands_) arms_[i]->LookAhead(guard_.last()[i]);
  if (order.motion == Motion::kFollow) v = data->rendered.v;
  if (order.motion == Motion::kNone || order.holds)
    for (JointVector& arm : v) arm.setZero();
  else if (order.motion == Motion::kRecover)
    recovery_->Step(View(), data->wrench, &v);
}

StopGeometry Pipeline::GeometryForStop(const MotionOrder& order, const TickData& data) noexcept {
  StopGeometry geometry;
  geometry.measured = true;
  for (int i = 0; i < kHands; ++i) {
    if (!arms_[i]) continue;
    ArmSide& arm = *arms_[i];
    const ArmSample& sample = data.sample.arms[i];
    geometry.V_W[i] = data.real[i].V_W;
    const bool fresh = !sample.fault && sample.arm_age <= kMaxStopSampleAge;
    geometry.measured = geometry.measured && fresh;
    if (fresh)
      arm.LookAhead(guard_.last()[i]);
    else
      arm.Extrapolate(guard_.last()[i], order.ticks * dt_);
    arm.ahead().FrameJacobian(*arm.model(), arm.handle_frame(), &geometry.J[i]);
    geometry.p_WH[i] = arm.ahead().FramePose(*arm.model(), arm.handle_frame()).p;
  }
  return geometry;
}

// Slows both arms by the same factor, so that no handle exceeds its cap, regardless of which module
// computed the command. Returns the number of joints changed.
int Pipeline::KeepToCap(const MotionOrder& order, const std::array<Jacobian, kHands>& J,
                        std::array<JointVector, kHands>* v) const noexcept {
  // The last command did not exceed the cap in the previous posture of the arms. In the new
  // posture, it may exceed the cap.
  double factor = 1, last_factor = 1;
  for (const int i : hands_) {
    if ((*v)[i].size() != J[i].cols()) continue;
    const auto allowed = [&](const JointVector& command) {
      const Twist V = TwistOf(J[i], command);
      return std::min(order.cap.speed / std::max(1e-12, V.head<3>().norm()),
                      order.cap.rotation / std::max(1e-12, V.tail<3>().norm()));
    };
    factor = std::min(factor, allowed((*v)[i]));
    last_factor = std::min(last_factor, allowed(guard_.last()[i]));
  }
  // Recovery ignores the joints' acceleration limits. If the guard limited each joint separately,
  // the handles would move in a direction other than the commanded one, and perhaps faster.
  return factor < 1 || order.motion == Motion::kRecover ? guard_.Slow(factor, v, last_factor) : 0;
}

void Pipeline::ApplyGuard(const MotionOrder& order, TickData* data) noexcept {
  data->guard_altered = 0;
  if (direct_) return;
  // Joint positions of the last valid sample. An invalid sample has already stopped the arms. It
  // must not cause the guard's own braking to replace the stop's profile.
  std::array<JointVector, kHands> q;
  // These Jacobians are the predicted Jacobians at the time when the command will take effect.
  // Rendering and braking use the same prediction.
  std::array<Jacobian, kHands> J;
  for (int i = 0; i < kHands; ++i) {
    if (!arms_[i]) continue;
    q[i] = arms_[i]->q();
    arms_[i]->ahead().FrameJacobian(*arms_[i]->model(), arms_[i]->handle_frame(), &J[i]);
  }
  std::array<JointVector, kHands>& v = data->command.v;
  const int slowed = KeepToCap(order, J, &v);
  data->guard_altered = std::max(slowed, guard_.Apply(q, &v, order.ticks));
  SentMotion& sent = data->sent;
  UpdateSent(&sent);
  double speed = 0;
  for (const int i : hands_) {
    sent.handle_twist[i] = TwistOf(J[i], sent.v[i]);
    speed = std::max(speed, StopSpeed(sent.handle_twist[i]));
  }
  sent.handle_rate = (speed - sent.handle_speed) / dt_;
  sent.handle_speed = speed;
}

// ---- between the stages ------------------------------------------------------------------------

Beyond Pipeline::FindBeyond() const noexcept {
  return recovery_ ? recovery_->Find(View()) : Beyond::kNothing;
}

std::string Pipeline::DescribeBeyond(Refusal refusal) const {
  const std::array<RenderArm, kHands> view = View();
  return StartRefusal(scenario_, recovery_->Where(view), view, refusal);
}

void Pipeline::BeginTare() noexcept {
  for (auto& arm : arms_)
    if (arm) arm->BeginTare();
}

Status Pipeline::FinishTare() noexcept {
  Status first;
  for (int i = 0; i < kHands; ++i) {
    const Status status = arms_[i] ? arms_[i]->FinishTare() : Status::Ok();
    if (status.ok() || !first.ok()) continue;
    first = status;
    first.hand = static_cast<std::int8_t>(i);
  }
  return first;
}

void Pipeline::Reset(SentMotion* sent) noexcept {
  world_.Reset();
  guard_.Reset();
  if (perturbation_) perturbation_->Reset();
  if (renderer_) renderer_->Reset();
  if (person_) person_->Reset();
  for (auto& arm : arms_)
    if (arm) arm->Reset();
  BeginTare();  // for a reset that leads to SELFTEST
  UpdateSent(sent);
}

void Pipeline::UpdateSent(SentMotion* sent) const noexcept {
  sent->v = guard_.last();
  sent->may_rest_next = guard_.MayRestNext();
}

}  // namespace predictor
