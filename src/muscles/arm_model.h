// Computes the lengths, moment arms and forces of the muscles of an arm in one posture of the body.
#pragma once

#include <array>
#include <memory>

#include "muscles/muscle.h"
#include "muscles/muscle_table.h"
#include "person/body_model.h"

namespace predictor::muscles {

using ArmVector = Eigen::Matrix<double, person::kArmJoints, 1>;
using ArmMatrix = Eigen::Matrix<double, person::kArmJoints, person::kArmJoints>;
using MuscleVector = Eigen::Matrix<double, kMuscles, 1>;
using MomentArms = Eigen::Matrix<double, person::kArmJoints, kMuscles>;

// Returns the values of the joints of a hand's arm in a vector for the whole body.
inline ArmVector ArmOf(const person::BodyVector& q, int hand) {
  return q.segment<person::kArmJoints>(person::Of(hand, person::ArmJoint::kShoulderFlexion));
}

// The lengths of the muscle paths from origin to insertion [m], and the moment arms R = -∂l/∂q [m].
// A muscle with the force F produces the torques R F, positive in the direction of the joints
// (person::ArmJoint).
struct MuscleLines {
  MuscleVector length;
  MomentArms moment_arm;
};

// The forces along the tendons at full activation and without activation [N].
struct MuscleForces {
  MuscleVector active, passive;
  MuscleVector fibre_length;  // relative to the optimal length; 0: slack
};

// The muscles of another arm model, with the same names and joints. The two arms are mirror images,
// so the model describes both with the same angles. All lengths apply to an upper arm of the length
// kTableUpperArm.
class ArmPaths {
 public:
  virtual ~ArmPaths() = default;
  // Returns the model's name, which is shown with the results.
  virtual const char* name() const = 0;
  // q is in [rad]. Does not use the heap. Only one thread may use an object of this type.
  virtual MuscleLines LinesAt(const ArmVector& q) const noexcept = 0;
  virtual const MuscleParameters& muscle(int i) const = 0;
};

class ArmModel {
 public:
  // An arm of the body (hand 0: left). The paths scale with the lengths of upper arm, forearm and
  // hand. Forces are proportional to mass times height over length, relative to a person of 75 kg
  // and 1.75 m, because a muscle's volume is proportional to mass times height (R). The forces are
  // also multiplied by 0.7 for women (D), and by the person's own strength. Tendon lengths are
  // chosen so that the longest fibre at all corners of the working range has the length
  // kLongestFibre. The working range comprises flexion from 0 to 90°, abduction from 0 to 60° and
  // so on (D).
  //
  // If `paths` is given, the paths and parameters of the muscles are those of another model, and
  // all lengths scale with the upper arm. Forces are scaled in the same way.
  ArmModel(const BodySpec& spec, int hand, std::shared_ptr<const ArmPaths> paths = nullptr);

  int hand() const { return hand_; }
  const person::BodyModel& body() const { return body_; }
  const MuscleParameters& muscle(int i) const { return muscles_[static_cast<std::size_t>(i)]; }

  // q is in [rad]. Does not use the heap.
  MuscleLines LinesAt(const ArmVector& q) const noexcept;
  // v contains the joints' velocities [rad/s]. Does not use the heap.
  MuscleForces ForcesAt(const MuscleLines& lines, const ArmVector& v) const noexcept;

 private:
  struct Node {
    int level = 0;  // the last joint of the arm that moves the point; -1: none
    Vector3 p = Vector3::Zero();
    Wrap wrap = Wrap::kNone;
    double radius = 0;
  };
  struct Line {
    std::array<Node, kMaxPathPoints> nodes;
    int count = 0;
  };

  void PlaceMuscle(int i);
  void SetTendons();
  MuscleLines OwnLinesAt(const ArmVector& q) const noexcept;

  person::BodyModel body_;
  int hand_;
  std::shared_ptr<const ArmPaths> paths_;  // null: the built-in ones
  double scale_;                           // length of the upper arm relative to kTableUpperArm
  std::array<MuscleParameters, kMuscles> muscles_;
  std::array<Line, kMuscles> lines_;
};

// The length of the longest fibres in the working range, relative to the optimal length (D).
inline constexpr double kLongestFibre = 1.2;

}  // namespace predictor::muscles
