// Implements (7)–(9) of the paper: each real handle follows its virtual handle. The task adds
// velocity feed-forward, a lead that compensates the arms' lag, and one common cap on the speeds of
// the handles.
#include <algorithm>

#include "core/filters.h"
#include "haptics/registry.h"

namespace predictor {
namespace {

constexpr double kAlignGain = 4.0;  // position and angle gain during alignment [1/s]

class Tracking final : public Task {
 public:
  explicit Tracking(const RenderSetup& setup)
      : Task(kHands),
        kp_(setup.scenario.rendering.kp),
        ko_(setup.scenario.rendering.ko),
        lead_(setup.lead),
        nearer_(setup.repairs.Has(Repair::kNearerHemisphere)),
        capped_(setup.repairs.Has(Repair::kHandleSpeedCap)) {
    acceleration_.fill(
        LowPass<Vector6>(setup.scenario.rendering.lead_cutoff, setup.dt, Vector6::Zero()));
    for (TaskTerm& term : terms_) term.weight = TwistWeight(setup);
  }

  void Update(const RenderContext& context, JointObjective*) noexcept override {
    const RenderTarget& target = context.target;
    const double kp = target.aligning ? kAlignGain : kp_;
    const double ko = target.aligning ? 2 * kAlignGain : ko_;
    double scale = 1;
    for (int i = 0; i < kHands; ++i) {
      const FrameMotion& D = target.handle[i];
      if (!target.aligning) acceleration_[i].Update(D.A_W);
      terms_[i].first = context.offset[i];
      terms_[i].J = context.J[i];
      if (!context.Has(i)) continue;
      Twist& v = terms_[i].rate;
      v = D.V_W;
      if (!target.aligning) v += lead_ * acceleration_[i].value();
      v.head<3>() += kp * (D.X_W.p - context.X_WH[i].p);
      v.tail<3>() += ko * QuaternionError(D.X_W.q, context.X_WH[i].q, nearer_);
      // The cap reduces the speeds of both handles by the same factor, so the direction of their
      // relative motion does not change.
      if (capped_ || target.aligning) scale = std::min(scale, ScaleToCaps(v, target));
    }
    for (TaskTerm& term : terms_) term.rate *= scale;
  }

  void Reset() noexcept override {
    for (auto& a : acceleration_) a.Reset(Vector6::Zero());
  }
  void Archive(StateArchive& a) noexcept override {
    a(acceleration_, terms_[0].rate, terms_[1].rate);
  }

 private:
  double kp_, ko_;  // K_p, K_o of (9) [1/s]
  double lead_;     // [s]
  bool nearer_, capped_;
  // Filtered acceleration of the virtual handles [m/s²], [rad/s²]. Without a filter, noise in the
  // measured force would make the arms jerk.
  std::array<LowPass<Vector6>, kHands> acceleration_;
};

}  // namespace

const TaskKind tasks::kTracking =
    TaskKindOf<Tracking>("tracking", "each handle follows its virtual one");

}  // namespace predictor
