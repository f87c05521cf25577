// Computes the use of the arm muscles of the nominal person at each time of a run, with the
// built-in model of the arm or with another model.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"
#include "muscles/arm_model.h"
#include "muscles/muscle_table.h"
#include "person/body_loads.h"
#include "person/body_sample.h"

namespace predictor::assessment {

struct Frame;
struct MeasuredEmg;
struct NominalChain;
struct NotEvaluable;
struct PersonSample;
struct PersonSetup;
struct QuantityKind;

// Values of one arm.
enum MuscleValue : int {
  kLargestActivation,  // 0 ... 1
  kMeanActivation,     // mean over all muscles
  kGroupActivation,    // largest of each group, in the order of muscles::MuscleGroup
  // Largest torque of a joint that the muscles cannot produce [N·m].
  kReserve = kGroupActivation + muscles::kMuscleGroups,
  // 1 if the missing torque exceeds kReserveLimit and kReserveShare of the joint's torque, else 0.
  kTooWeak,
  kSoftest,  // smallest principal stiffness of the hand [N/m]
  kStiffest,
  kMuscleValues,
};
inline constexpr double kReserveLimit = 0.5;   // (design choice) [N·m]
inline constexpr double kReserveShare = 0.05;  // (design choice)

// The values are not a number if the arm holds no handle. If the upper arm is raised above 90°, the
// model of the shoulder disagrees with measurements (Bergmann et al. 2011), so only the groups of
// elbow and forearm have values.
struct ArmMuscleUse {
  std::array<double, kMuscleValues> values;
  muscles::MuscleVector activation;  // activation of each muscle, 0 ... 1
  // Stiffness of each joint while the other joints do not move [N·m/rad]: the diagonal of
  // muscles::JointStiffness, in the order of person::ArmJoint.
  std::array<double, person::kArmJoints> joint_stiffness;
  bool raised = false;

  ArmMuscleUse() {
    values.fill(std::numeric_limits<double>::quiet_NaN());
    activation.setConstant(std::numeric_limits<double>::quiet_NaN());
    joint_stiffness.fill(std::numeric_limits<double>::quiet_NaN());
  }
};

// Activations from electromyograms and the weights of these activations, as in
// muscles::ActivationProblem.
struct MeasuredActivations {
  muscles::MuscleVector value = muscles::MuscleVector::Zero();
  muscles::MuscleVector trust = muscles::MuscleVector::Zero();  // 0: not measured
};

// The muscles of both arms of the nominal person.
class ArmMuscles {
 public:
  // `paths` is another model of the arm; null selects the built-in model.
  explicit ArmMuscles(const PersonSetup& setup,
                      const std::shared_ptr<const muscles::ArmPaths>& paths = nullptr);
  // Fills in `muscles` of a frame whose angles and loads belong to this sample and motion.
  void Add(const person::BodySample& sample, const person::BodyMotion& motion, Frame* frame,
           const std::array<MeasuredActivations, kHands>& measured = {}) const;

 private:
  person::Stance stance_;
  std::array<muscles::ArmModel, kHands> arms_;
};

// Fills in `muscles` of the chain's frames, and `modelled` of the electromyograms.
void AddMuscles(const PersonSetup& setup, std::span<const PersonSample> samples,
                const std::shared_ptr<const muscles::ArmPaths>& paths,
                std::vector<MeasuredEmg>* emg, NominalChain* chain);

// Returns the rows of the table of quantities for the muscles of both arms.
std::vector<QuantityKind> MuscleQuantities();

// Adds sentences about the share of time in which an arm is too weak, and about results that could
// not be judged.
void AddMuscleWords(const NominalChain& chain, std::vector<std::string>* warnings,
                    std::vector<std::string>* assumptions, std::vector<NotEvaluable>* gaps);

}  // namespace predictor::assessment
