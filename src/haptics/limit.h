// A limit of haptic rendering, which consists of bounds of joint velocities or of rows of the QP.
// To add a limit, see docs/developer/add-a-limit.md.
#pragma once

#include <algorithm>

#include "haptics/context.h"
#include "qp/qp.h"

namespace predictor {

inline constexpr int kMaxLimitRows = 16;       // of all limits
inline constexpr int kMaxPrecedenceRows = 12;  // of tasks with precedence
static_assert(kMaxLimitRows + kMaxPrecedenceRows == kMaxQpRows);

// The output of a limit: bounds of the joint velocities x [rad/s], and the limit's rows A x ≥ b.
class LimitRows {
 public:
  using Matrix = Eigen::Map<Qp::RowMajor, 0, Eigen::OuterStride<>>;

  // There are `count` rows, starting at `first`. Each row has `joints` variables.
  LimitRows(Qp* qp, int joints, int first, int count)
      : lower_(qp->lower().data()),
        upper_(qp->upper().data()),
        A(qp->A().data() + first * qp->n(), count, joints, Eigen::OuterStride<>(qp->n())),
        b(qp->b().data() + first, count) {}

  // Restricts the velocity of joint `k` to this range, as far as earlier limits allow.
  void Narrow(int k, double lowest, double highest) noexcept {
    const double low = lower_[k], high = upper_[k];
    lower_[k] = std::clamp(lowest, low, high);
    upper_[k] = std::clamp(highest, low, high);
  }

 private:
  double *lower_, *upper_;

 public:
  Matrix A;         // initially zero
  Qp::VectorMap b;  // initially −∞
};

class Limit {
 public:
  virtual ~Limit() = default;
  // Returns the number of rows that the limit needs. Each row has its own slack, so the problem
  // stays solvable. RenderResult::slack_by_limit publishes the largest slack.
  virtual int rows() const { return 0; }
  // Narrows the bounds and fills the limit's rows. This function is called at least once per tick,
  // and must not use the heap or throw.
  virtual void AddTo(const RenderContext& context, LimitRows* out) noexcept = 0;
  // Writes the values that the limit publishes per tick.
  virtual void Publish(RenderResult*) const noexcept {}
};

}  // namespace predictor
