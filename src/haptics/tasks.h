// What the arms are asked to do, as terms of the QP's objective. Adding one: docs/add-a-limit.md.
#pragma once

#include "core/archive.h"
#include "core/filters.h"
#include "haptics/limits.h"

namespace predictor {

class Task {
 public:
  virtual ~Task() = default;
  // Adds ½ (J x − r)ᵀ W (J x − r) (or a linear term) to the objective. No heap, no exception.
  virtual void AddTo(const RenderState& state, Qp* qp) noexcept = 0;
};

// (7)–(9): each real handle follows its virtual one, with feed-forward of its velocity, lead by the
// device's lag, and one common cap on the handles' speeds.
class Tracking final : public Task {
 public:
  // lead, dt [s]. The lead's acceleration is low-passed: raw, noise of the hand's force would
  // become jerk of the arms.
  Tracking(const RenderingSpec& spec, double lead, double dt);
  // Once a tick, before AddTo: the filter of the lead goes on.
  void Advance(const RenderTarget& target) noexcept;
  void AddTo(const RenderState& state, Qp* qp) noexcept override;
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept { a(acceleration_, reference_); }

  // Reference twist v^r of each handle in the last tick, before weighing [m/s], [rad/s].
  const std::array<Twist, kHands>& reference() const { return reference_; }

 private:
  RenderingSpec spec_;
  double lead_;                                        // [s]
  std::array<LowPass<Vector6>, kHands> acceleration_;  // of the virtual handles
  std::array<Twist, kHands> reference_ = {Twist::Zero(), Twist::Zero()};
};

// (10), repaired: the pose of the right real handle relative to the left one goes to the virtual
// one's, carried by the real left handle. Weighed far above tracking, so that it yields only to
// limits; what it yields is its slack. Asks for no more than a handle's caps.
class RelativePose final : public Task {
 public:
  explicit RelativePose(const RenderingSpec& spec) : spec_(spec) {}
  void AddTo(const RenderState& state, Qp* qp) noexcept override;
  // The same as six rows A x + s/√w = rate from `row` on, with a slack variable s each from
  // `variable` on: more work for the solver, but weights far apart do not spoil its condition.
  void AddRowsTo(const RenderState& state, int row, int variable, Qp* qp) noexcept;
  // Slack of a solution: achieved minus asked rate of the relative pose [m/s], [rad/s]; zero while
  // aligning.
  Vector6 Slack(const RenderState& state, const double* x) const noexcept;

 private:
  static bool Counts(const RenderState& state) noexcept;
  void Evaluate(const RenderState& state) noexcept;

  RenderingSpec spec_;
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kHands * kMaxArmJoints> A_;
  Vector6 rate_ = Vector6::Zero();
  Vector6 weight_ = Vector6::Zero();
};

// −α J_m: climbs the translational manipulability of each arm.
class Manipulability final : public Task {
 public:
  explicit Manipulability(double weight) : weight_(weight) {}
  void AddTo(const RenderState& state, Qp* qp) noexcept override;
  const std::array<double, kHands>& value() const { return value_; }

 private:
  double weight_;  // α
  std::array<double, kHands> value_ = {};
};

// ½ ε |x|², which makes the problem strictly convex: P = JᵀJ has rank 12 of 14. ε grows near a
// singularity (damped least squares, Nakamura & Hanafusa 1986), where it bounds joint speeds. Its
// bias on a handle's speed along a direction of singular value σ is the fraction ε / (σ² + ε).
class Regularisation final : public Task {
 public:
  explicit Regularisation(const RenderingSpec& spec) : spec_(spec) {}
  void AddTo(const RenderState& state, Qp* qp) noexcept override;

 private:
  RenderingSpec spec_;
};

inline constexpr double kAlignGain = 4.0;  // of position and angle while aligning [1/s]
// Weight of tracking's translation is 1; these are relative to it.
inline constexpr double kRelativeWeight = 1e5;
inline constexpr double kLimitSlackWeight = 1e9;  // of the slack of a row of a Limit
inline constexpr double kRegularisation = 1e-5;   // ε far from singularities
inline constexpr double kDamping = 1e-2;          // added to ε at a singularity
inline constexpr double kSingularValue = 0.05;    // below which damping begins

}  // namespace predictor
