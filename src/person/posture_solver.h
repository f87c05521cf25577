// Computes a person's posture from the handles, and from head and elbows if they are measured
// (inverse kinematics).
#pragma once

#include <algorithm>
#include <array>

#include "person/body_sample.h"

namespace predictor::person {

// The weights of squared deviations, which determine the part of the posture that the measurements
// leave open (all values D). A hand's squared position error has the weight 1 [1/m²], and its
// squared rotation error 0.04 [1/rad²].
struct PosturePrior {
  BodyVector comfort;  // [rad], [m]
  BodyVector weight;   // [1/rad²], [1/m²]
  // The angle by which the elbow is rotated outward about the line from shoulder to wrist [rad],
  // and its weight [1/m² of the elbow's displacement]. The angle is measured from the downward
  // direction, tilted backwards by 30°.
  std::array<double, kHands> swivel = {0.35, 0.35};
  double swivel_weight = 0.1;
  // The cost of lowering the hips [1/m]. The cost of lowering is nearly linear, so the knees stay
  // straight unless bending them lowers the total cost. The squared knee angle is also nearly
  // linear: for hips lowered by d, it is 8 d divided by the length of the leg. This weight is four
  // times the weight of an arm's joint. The cost is lowering · (√(z² + s²) - s) with s =
  // kLoweringSmooth.
  double lowering = 3.5e-2;
};
inline constexpr double kLoweringSmooth = 0.01;  // [m]
PosturePrior DefaultPrior();

struct Posture {
  BodyVector q;
  // The remaining errors of the handles' poses, or 0 for an absent hand. For a grip that can turn,
  // the rotation error is only the part of the bar's oblique angle in the hand that exceeds 0.7
  // rad.
  std::array<double, kHands> position_error = {};  // [m]
  std::array<double, kHands> rotation_error = {};  // [rad]
  std::array<double, kHands> oblique = {};         // angle of the bar in a grip that turns [rad]
  std::array<double, kHands> elbow_error = {};     // [m]; 0 if not measured
  double head_error = 0;                           // [m]; 0 if not measured
  int iterations = 0;
  // `reached` is true if the errors of both hands are at most 1e-6 m and 1e-6 rad. If the errors
  // are larger, the posture is the nearest one found.
  bool reached = false;

  // Returns the largest distance by which a hand misses its handle [m].
  double miss() const { return std::max(position_error[0], position_error[1]); }
};

// Solves in two stages: first the weighted compromise of all tasks and the prior, then the shortest
// step that brings the hands exactly to the handles. Both stages use damped Gauss-Newton steps
// (Levenberg & Marquardt). Each step is a quadratic program with the joint limits as bounds. The
// programs are solved without a warm start, so the result depends only on the sample and the start.
class PostureSolver {
 public:
  PostureSolver(const BodyModel& model, const Stance& stance, const std::array<Grip, kHands>& grips,
                const PosturePrior& prior = DefaultPrior());

  // Starts the search at the prior's comfortable posture.
  Posture Solve(const BodySample& sample) const { return Solve(sample, prior_.comfort); }
  // Starts the search at `start`, for example at the posture of the previous sample.
  Posture Solve(const BodySample& sample, const BodyVector& start) const;

  const BodyModel& model() const { return model_; }
  const Stance& stance() const { return stance_; }
  const std::array<Grip, kHands>& grips() const { return grips_; }
  const PosturePrior& prior() const { return prior_; }

 private:
  BodyModel model_;
  Stance stance_;
  std::array<Grip, kHands> grips_;
  PosturePrior prior_;
};

}  // namespace predictor::person
