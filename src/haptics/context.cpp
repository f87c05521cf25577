#include "haptics/context.h"

namespace predictor {

RenderSetup::RenderSetup(const Scenario& s,
                         const std::array<std::shared_ptr<const RobotModel>, kHands>& m, double l,
                         double tick)
    : scenario(s), models(m), lead(l), dt(tick), repairs(RepairsOf(s.rendering)) {
  for (int i = 0; i < kHands; ++i) {
    if (!models[i]) continue;
    limits[i] = LimitsOf(scenario.arm(i), *models[i]);
    joints += models[i]->dof();
  }
}

RenderContext::RenderContext(const std::array<RenderArm, kHands>& both, const RenderTarget& to,
                             const std::array<JointVector, kHands>& sent, double tick) noexcept
    : arms(both), target(to), last(sent), dt(tick) {
  for (int i = 0; i < kHands; ++i) {
    offset[i] = joints;
    if (!arms[i].present) continue;
    arms[i].ahead->FrameJacobian(*arms[i].model, arms[i].handle, &J[i]);
    X_WH[i] = arms[i].data->FramePose(*arms[i].model, arms[i].handle);
    X_WH_ahead[i] = arms[i].ahead->FramePose(*arms[i].model, arms[i].handle);
    joints += static_cast<int>(arms[i].q->size());
  }
}

}  // namespace predictor
