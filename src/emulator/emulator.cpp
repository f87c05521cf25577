#include "emulator/emulator.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "emulator/pipeline.h"
#include "emulator/saved_state.h"
#include "emulator/stage_timer.h"
#include "emulator/supervisor.h"
#include "emulator/tick_data.h"
#include "emulator/tick_record.h"
#include "scenario/action_time.h"
#include "scenario/located.h"

namespace predictor {

struct Emulator::Impl {
  Impl(const Scenario& scenario, std::unique_ptr<Device> real_arms);

  void Tick(std::uint64_t wall_ns, int missed) noexcept;
  void HandleRequests() noexcept;
  void Read() noexcept;
  void Command(const MotionOrder& order) noexcept;
  void Write() noexcept;
  void Advance(const TickPlan& plan) noexcept;
  SavedState State() noexcept { return {pipeline, supervisor, data, device.get(), record.tick}; }
  // Returns null if a person holds the handles.
  const OperatorOutput* SimulatedOperator() const noexcept {
    return device ? device->truth() : &data.person;
  }

  const Scenario scenario;
  const std::vector<ActionSpan> script;
  Pipeline pipeline;
  Supervisor supervisor;
  std::unique_ptr<Device> device;  // null in direct mode
  EmulatorSetup setup;
  TickData data;
  StageTimer timer;
  TickRecord record{};
};

Emulator::Impl::Impl(const Scenario& s, std::unique_ptr<Device> real_arms)
    : scenario(s),
      script(SpansOf(s.operator_.script)),
      pipeline(s),
      supervisor(s, pipeline.arms()) {
  setup.rules = RulesFor(s);
  setup.object_start = pipeline.world().state().object.X_W.p;
  setup.cobot_joints = pipeline.world().joint_names();
  setup.controller_tape = pipeline.world().ControllerTape();
  data.after = &pipeline.world().state();
  if (pipeline.direct()) {
    setup.device = "none: the hands act on the object's own handles";
    return;
  }
  setup.start = pipeline.start();
  setup.lead = pipeline.lead();
  device = real_arms ? std::move(real_arms)
                     : MakeSimulatedDevice(s, pipeline.StartJoints(s.rig.start_offset));
  setup.device = device->Describe();
  pipeline.UpdateSent(&data.sent);
  for (const int i : s.hands()) {
    ArmSample& arm = data.sample.arms[i];
    for (JointVector* x : {&data.command.v[i], &data.rendered.v[i], &arm.q, &arm.v})
      x->setZero(data.sent.v[i].size());
  }
}

// ---- the tick ----------------------------------------------------------------------------------

void Emulator::Impl::Tick(std::uint64_t wall_ns, int missed) noexcept {
  timer.Start();
  pipeline.world().SetRealTime(wall_ns != 0);
  data.missed = static_cast<std::uint32_t>(std::max(0, missed));
  HandleRequests();
  Read();
  timer.Lap(Stage::kRead);
  const TickPlan plan = supervisor.Plan(data.sample);
  pipeline.Sense(plan, &data);
  timer.Lap(Stage::kSense);
  pipeline.Simulate(plan, &data);
  timer.Lap(Stage::kSimulate);
  pipeline.Render(plan, &data);
  timer.Lap(Stage::kRender);
  supervisor.Check(plan, data);
  timer.Lap(Stage::kMonitor);
  Command(supervisor.Order(plan, data));
  timer.Lap(Stage::kGuard);
  Write();
  timer.Lap(Stage::kWrite);
  BuildRecord({scenario, plan, data, supervisor, script, SimulatedOperator() != nullptr}, wall_ns,
              &record);
  timer.Finish(&record.stage_us);
  Advance(plan);
}

void Emulator::Impl::HandleRequests() noexcept {
  data.requests = supervisor.TakeRequests();
  const bool aligns = data.requests.Has(RunEvent::kAlignRequested);
  const Beyond beyond = aligns ? pipeline.FindBeyond() : Beyond::kNothing;
  if (supervisor.HandleRequests(data, beyond)) pipeline.Reset(&data.sent);
}

void Emulator::Impl::Read() noexcept {
  data.before = pipeline.world().state();
  if (!device) return;
  data.reading = device->Read(&data.sample);
  if (const OperatorOutput* truth = device->truth()) data.person = *truth;
}

void Emulator::Impl::Command(const MotionOrder& order) noexcept {
  if (order.motion == Motion::kBrake)
    supervisor.Brake(order, pipeline.GeometryForStop(order, data), &data.command.v);
  else
    pipeline.Command(order, &data);
  pipeline.ApplyGuard(order, &data);
  if (device) supervisor.ObserveStop(data);
}

void Emulator::Impl::Write() noexcept {
  if (!device) return;
  data.command.state = supervisor.state();
  data.command.run_time = supervisor.run_time();
  data.command.hands = supervisor.hand_inputs();
  data.writing = device->Write(data.command);
  supervisor.HandleFault(data.writing, data.sent);
}

void Emulator::Impl::Advance(const TickPlan& plan) noexcept {
  supervisor.EndTick(plan);
  std::optional<Status> self_test;
  if (supervisor.SelfTestEnds()) self_test = pipeline.FinishTare();
  const bool recovers = supervisor.state() == RunState::kRecovery;
  const Beyond beyond = recovers ? pipeline.FindBeyond() : Beyond::kNothing;
  if (supervisor.Advance(data, beyond, self_test)) pipeline.BeginTare();
  supervisor.FollowEnablingDevice(device ? device->enabling() : Enabling::kNone);
}

// ---- the interface -----------------------------------------------------------------------------

Emulator::Emulator(const Scenario& scenario, std::unique_ptr<Device> device) try
    : impl_(std::make_unique<Impl>(scenario, std::move(device))) {
} catch (const InputError& error) {
  throw Located(error, scenario);
}
Emulator::~Emulator() = default;
void Emulator::Tick(std::uint64_t wall_ns, int missed) noexcept { impl_->Tick(wall_ns, missed); }
std::string Emulator::PrioritiseController(bool on) {
  return impl_->pipeline.world().PrioritiseProcess(on);
}

void Emulator::Play(const TickRecord& record) noexcept {
  ControllerAnswer answer;
  const Eigen::Index dof = std::min<Eigen::Index>(record.cobot_dof, kMaxCobotJoints);
  if (dof != impl_->pipeline.world().effort_limit().size()) return;
  answer.torque = Eigen::Map<const Eigen::VectorXd>(record.cobot_torque.data(), dof);
  answer.energy = record.energy;
  answer.outcome =
      static_cast<ControllerOutcome>(std::min<int>(record.controller, kControllerOutcomes - 1));
  answer.failure = {StopCause::kPhysics, -1, record.cause_value, record.cause_limit,
                    record.cause_quantity};
  impl_->pipeline.world().Play(answer);
}
bool Emulator::Submit(const RunInput& input) noexcept { return impl_->supervisor.Submit(input); }
bool Emulator::HasRoomForInput() const noexcept { return impl_->supervisor.HasRoomForInput(); }
void Emulator::Request(RunEvent event) noexcept { impl_->supervisor.Request(event); }
void Emulator::RequestEnd() noexcept { impl_->supervisor.RequestEnd(); }
std::size_t Emulator::SaveState(std::span<std::byte> to) noexcept {
  StateArchive archive = StateArchive::ToSave(to);
  ArchiveState(archive, impl_->State());
  return archive.ok() ? archive.used() : 0;
}
void Emulator::LoadState(std::span<const std::byte> from, std::optional<std::uint64_t> seed) {
  StateArchive archive = StateArchive::ToLoad(from, seed);
  ArchiveState(archive, impl_->State());
  if (archive.ok() && archive.used() == from.size()) return;
  throw InputError("The saved state (" + std::to_string(from.size()) +
                   " bytes) belongs to another scenario or another version of the program. Use the "
                   "version of the program that wrote this state.");
}
const TickRecord& Emulator::record() const { return impl_->record; }
RunState Emulator::state() const { return impl_->supervisor.state(); }
StopLevel Emulator::level() const { return impl_->supervisor.level(); }
double Emulator::run_time() const { return impl_->supervisor.run_time(); }
const StopReport& Emulator::stop() const { return impl_->supervisor.stop(); }
std::string Emulator::WhyNotAligned() const {
  const TickRecord& r = impl_->record;
  if (impl_->pipeline.direct() || r.refused != 1 + static_cast<int>(RunEvent::kAlignRequested))
    return "";
  return impl_->pipeline.DescribeBeyond(static_cast<Refusal>(r.why_refused));
}
std::string Emulator::EngineFailure() const { return impl_->pipeline.world().EngineFailure(); }
const EmulatorSetup& Emulator::setup() const { return impl_->setup; }
const Scenario& Emulator::scenario() const { return impl_->scenario; }
double Emulator::dt() const { return 1 / impl_->scenario.rate; }

}  // namespace predictor
