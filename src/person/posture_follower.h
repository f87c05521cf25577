// Computes a posture that follows the handles and satisfies the rules of the control loop.
#pragma once

#include <memory>

#include "person/posture_solver.h"

namespace predictor::person {

inline constexpr int kFollowIterations = 5;

// Performs only a few steps of the solver's first stage at a time, so that its cost is bounded. The
// hands do not reach the handles exactly: the weight of comfort causes an error of a few
// millimetres, which grows while the handles move fast.
class PostureFollower {
 public:
  // The constructor allocates all memory.
  explicit PostureFollower(const PostureSolver& solver);
  ~PostureFollower();

  // Improves q for this sample by at most kFollowIterations steps. The result depends only on the
  // sample and q. Does not use the heap or throw.
  void Follow(const BodySample& sample, BodyVector* q) noexcept;

  const PostureSolver& solver() const { return solver_; }

 private:
  struct Impl;
  PostureSolver solver_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor::person
