#include "emulator/saved_state.h"

#include "devices/device.h"
#include "emulator/pipeline.h"
#include "emulator/supervisor.h"
#include "emulator/tick_data.h"

namespace predictor {

void ArchiveState(StateArchive& a, const SavedState& state) noexcept {
  Pipeline& p = state.pipeline;
  Supervisor& s = state.supervisor;
  TickData& d = state.data;
  a(p.world_, p.arms_, s.parameters_, s.monitor_, s.warnings_, p.guard_, s.states_, s.stopper_,
    s.hand_inputs_, d.sample, d.command.v, d.person, d.rendered, d.real, d.wrench, s.reported_,
    s.fault_, s.power_off_cause_, s.enabling_age_, s.healthy_time_, s.joints_jumped_, s.aligned_,
    s.tared_, d.sent.handle_twist, d.sent.handle_speed, d.sent.handle_rate, s.run_time_,
    s.state_time_, state.tick);
  for (std::size_t i = 0; i < kHands; ++i)
    if ((d.sample.arms[i].present || d.wrench[i].present) && !p.hands_.Has(static_cast<int>(i)))
      a.Fail();
  if (state.device) state.device->Archive(a);
  if (p.perturbation_) p.perturbation_->Archive(a);
  if (p.renderer_) p.renderer_->Archive(a);
  if (p.person_) p.person_->Archive(a);
  p.UpdateSent(&d.sent);
}

}  // namespace predictor
