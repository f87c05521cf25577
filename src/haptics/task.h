// A task of haptic rendering is a goal of the arms, expressed as terms of the QP's objective. To
// add a task, see docs/developer/add-a-limit.md.
#pragma once

#include <span>
#include <vector>

#include "core/archive.h"
#include "haptics/context.h"

namespace predictor {

inline constexpr int kMaxRenderJoints = kHands * kMaxArmJoints;

// ½ (J x − rate)ᵀ diag(weight) (J x − rate), x: joint velocities of both arms [rad/s].
struct TaskTerm {
  int first = 0;  // index in x of J's first column
  // no columns: the term is inactive
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxRenderJoints> J;
  Vector6 rate = Vector6::Zero();    // desired J x: error times gain [m/s], [rad/s]
  Vector6 weight = Vector6::Zero();  // tracking's translation has weight 1

  // Returns J x − rate [m/s], [rad/s], or zero if the term is inactive.
  Vector6 Slack(const double* x) const noexcept;
};

// −gradientᵀ x + ½ xᵀ diag(damping) x: objective of single joints, one entry per joint.
struct JointObjective {
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRenderJoints, 1> gradient, damping;
};

class Task {
 public:
  virtual ~Task() = default;

  // Updates terms() and adds the task's terms for single joints to the objective. This function is
  // called once per tick and must not use the heap or throw.
  virtual void Update(const RenderContext& context, JointObjective* joints) noexcept = 0;
  std::span<const TaskTerm> terms() const { return terms_; }
  // Returns whether the task has precedence over ordinary tasks. The weights of its terms are then
  // so large that the terms yield only to limits. If the solver finds no precise solution with such
  // weights, the terms are replaced by rows with slack.
  virtual bool has_precedence() const { return false; }

  // Writes the values that the task publishes per tick. `x` is the solution, or null if none was
  // found.
  virtual void Publish(const double*, RenderResult*) const noexcept {}
  virtual void Reset() noexcept {}
  virtual void Archive(StateArchive&) noexcept {}

 protected:
  explicit Task(std::size_t terms) : terms_(terms) {}
  std::vector<TaskTerm> terms_;
};

// Returns the vector part of the quaternion that rotates `from` into `to` by the shorter path. For
// small rotations, this vector is half of the rotation vector. The result equals the expression η
// ε^d − η^d ε − S(ε^d) ε in (9) of the paper. If `nearer` is false, the signs of the quaternions
// determine the path, as in (9) of the paper.
Vector3 QuaternionError(const Quaternion& to, const Quaternion& from, bool nearer = true) noexcept;

// Returns the weights of a handle's twist. The weight of translation is 1. The weight of rotation
// is the square of `rendering.characteristic_length`, or 1 in (7) of the paper.
Vector6 TwistWeight(const RenderSetup& setup);

// Returns a factor in (0, 1] that reduces a twist to the speed caps of a handle.
double ScaleToCaps(const Twist& V, const RenderTarget& target) noexcept;

}  // namespace predictor
