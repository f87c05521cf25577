// In the repaired form of (10), the right real handle approaches a goal. Relative to the left real
// handle, this goal has the relative pose of the virtual handles. The requested motion does not
// exceed the speed caps of a handle.
//
// In the printed form of (10), the vector between the real handles approaches the vector between
// the virtual handles in W, and the orientations of the handles approach each other.
#include "haptics/registry.h"

namespace predictor {
namespace {

constexpr double kRelativeWeight = 1e5;  // relative to tracking

class RelativePose final : public Task {
 public:
  explicit RelativePose(const RenderSetup& setup)
      : Task(setup.models[0] && setup.models[1] ? 1 : 0),
        kp_(setup.scenario.rendering.relative_kp),
        ko_(setup.scenario.rendering.relative_ko),
        relative_(setup.repairs.Has(Repair::kRelativeTarget)),
        nearer_(setup.repairs.Has(Repair::kNearerHemisphere)),
        capped_(setup.repairs.Has(Repair::kHandleSpeedCap)) {
    for (TaskTerm& term : terms_) term.weight = kRelativeWeight * TwistWeight(setup);
  }

  bool has_precedence() const override { return true; }

  void Update(const RenderContext& context, JointObjective*) noexcept override {
    if (terms_.empty()) return;
    TaskTerm& term = terms_[0];
    // During alignment, no hand holds a handle, and each arm moves independently. If the relative
    // pose is far from correct, the arms cannot reach the relative pose and the virtual handles at
    // the same time.
    if (!context.Has(0) || !context.Has(1) || context.target.aligning) {
      term.J.resize(6, 0);
      return;
    }
    Pose X_W2_goal;
    Vector3 lever;
    SetGoal(context, &X_W2_goal, &lever);

    // The derivative of (goal − right) is the rigid motion of the left handle at the goal, minus
    // the motion of the right handle.
    const Jacobian &J0 = context.J[0], &J1 = context.J[1];
    const auto n0 = J0.cols(), n1 = J1.cols();
    term.J.resize(6, n0 + n1);
    term.J.leftCols(n0) = J0;
    for (Eigen::Index c = 0; c < n0; ++c)
      term.J.col(c).head<3>() += J0.col(c).tail<3>().cross(lever);
    term.J.rightCols(n1) = -J1;
    term.rate.head<3>() = -kp_ * (X_W2_goal.p - context.X_WH[1].p);
    term.rate.tail<3>() = -ko_ * QuaternionError(X_W2_goal.q, context.X_WH[1].q, nearer_);
    if (capped_) term.rate *= ScaleToCaps(term.rate, context.target);
  }

  void Publish(const double* x, RenderResult* result) const noexcept override {
    if (x) result->relative_slack = terms_.empty() ? Vector6(Vector6::Zero()) : terms_[0].Slack(x);
  }

 private:
  // Computes the goal of the right handle, and the vector from the left handle to the right handle
  // [m].
  void SetGoal(const RenderContext& context, Pose* goal, Vector3* lever) const noexcept {
    const auto& D = context.target.handle;
    if (relative_) {
      const Pose X_D1D2 = D[0].X_W.Inverse() * D[1].X_W;
      *goal = context.X_WH[0] * X_D1D2;
      *lever = context.X_WH_ahead[0].q * X_D1D2.p;
    } else {
      goal->p = context.X_WH[0].p + (D[1].X_W.p - D[0].X_W.p);
      goal->q = context.X_WH[0].q;
      *lever = context.X_WH_ahead[1].p - context.X_WH_ahead[0].p;
    }
  }

  double kp_, ko_;  // K'_p, K'_o of (10) [1/s]
  bool relative_, nearer_, capped_;
};

}  // namespace

const TaskKind tasks::kRelativePose =
    TaskKindOf<RelativePose>("relative_pose", "the handles keep their relative pose");

}  // namespace predictor
