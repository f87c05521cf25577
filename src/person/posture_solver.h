// Inverse kinematics: a person's posture from the handles, and from head and elbows where measured.
#pragma once

#include <array>

#include "person/body_sample.h"

namespace predictor::person {

// What decides the posture as far as the measurements do not. All figures D. Squared deviations
// count with these weights against 1 for a hand's squared position error [m²] and 0.04 for its
// squared rotation error [rad²].
struct PosturePrior {
  BodyVector comfort;  // [rad], [m]
  BodyVector weight;   // [1/rad²], [1/m²]
  // Angle by which the elbow is turned outward about the line from shoulder to wrist, from the
  // direction 30° behind straight down [rad], and its weight [1/m² of the elbow's displacement].
  std::array<double, kHands> swivel = {0.35, 0.35};
  double swivel_weight = 0.1;
  // Cost of lowering the hips [1/m]. It is nearly linear, like the squared knee angle (8 d / length
  // of the leg for hips lowered by d; four times the weight of an arm's joint), so that the knees
  // stay straight unless bending them pays: lowering · (√(z² + s²) - s) with s = kLoweringSmooth.
  double lowering = 3.5e-2;
};
inline constexpr double kLoweringSmooth = 0.01;  // [m]
PosturePrior DefaultPrior();

struct Posture {
  BodyVector q;
  // Remaining errors of the handles' poses; 0 for an absent hand. Of a grip that turns, only what
  // the bar lies more obliquely in the hand than 0.7 rad counts as missing rotation.
  std::array<double, kHands> position_error = {};  // [m]
  std::array<double, kHands> rotation_error = {};  // [rad]
  std::array<double, kHands> oblique = {};         // of the bar in a grip that turns [rad]
  std::array<double, kHands> elbow_error = {};     // [m]; 0 if not measured
  double head_error = 0;                           // [m]; 0 if not measured
  int iterations = 0;
  // Both hands are within 1e-6 m and 1e-6 rad. Otherwise the posture is the nearest one found.
  bool reached = false;
};

// Solves in two stages: first the weighted compromise of all tasks and the prior; then the shortest
// step that brings the hands exactly to the handles. Both are Gauss-Newton with damping (Levenberg
// & Marquardt), each step a quadratic program with the joint limits as bounds. The programs are
// solved cold, so that the result depends only on the sample and the start.
class PostureSolver {
 public:
  PostureSolver(const BodyModel& model, const Stance& stance, const std::array<Grip, kHands>& grips,
                const PosturePrior& prior = DefaultPrior());

  // Starts at the prior's comfort.
  Posture Solve(const BodySample& sample) const { return Solve(sample, prior_.comfort); }
  // Starts at `start`, for example the posture of the sample before.
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
