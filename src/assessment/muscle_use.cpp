#include "assessment/muscle_use.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "assessment/measured_emg.h"
#include "assessment/person_chain.h"
#include "assessment/quantities.h"
#include "core/format.h"
#include "muscles/stiffness.h"

namespace predictor::assessment {
namespace {

using muscles::ArmVector;
using muscles::MuscleVector;

constexpr int kFirstGroup = kGroupActivation;

double& ValueOf(ArmMuscleUse* use, int value) {
  return use->values[static_cast<std::size_t>(value)];
}

void SetActivations(const MuscleVector& activation, ArmMuscleUse* use) {
  std::array<double, muscles::kMuscleGroups> largest = {};
  for (int i = 0; i < muscles::kMuscles; ++i) {
    const auto group =
        static_cast<std::size_t>(muscles::MuscleTable()[static_cast<std::size_t>(i)].group);
    largest[group] = std::max(largest[group], activation[i]);
    if (!use->raised || !muscles::ActsAtShoulder(static_cast<int>(group)))
      use->activation[i] = activation[i];
  }
  for (int group = 0; group < muscles::kMuscleGroups; ++group)
    if (!use->raised || !muscles::ActsAtShoulder(group))
      ValueOf(use, kFirstGroup + group) = largest[static_cast<std::size_t>(group)];
  if (use->raised) return;
  ValueOf(use, kLargestActivation) = activation.maxCoeff();
  ValueOf(use, kMeanActivation) = activation.mean();
}

void SetReserve(const ArmVector& reserve, const ArmVector& torque, ArmMuscleUse* use) {
  ValueOf(use, kReserve) = reserve.cwiseAbs().maxCoeff();
  bool weak = false;
  for (int i = 0; i < person::kArmJoints; ++i)
    weak =
        weak || std::abs(reserve[i]) > std::max(kReserveLimit, kReserveShare * std::abs(torque[i]));
  ValueOf(use, kTooWeak) = weak ? 1 : 0;
}

// Muscles of one arm at one time.
ArmMuscleUse MusclesOf(const muscles::ArmModel& arm, const person::BodyMotion& motion,
                       const person::BodyVector& torques, const person::ExternalWrench& wrench,
                       bool raised, const MeasuredActivations& measured) {
  ArmMuscleUse use;
  use.raised = raised;
  const ArmVector q = muscles::ArmOf(motion.q, arm.hand());
  const ArmVector torque = muscles::ArmOf(torques, arm.hand());
  const muscles::MuscleLines lines = arm.LinesAt(q);
  const muscles::MuscleForces forces = arm.ForcesAt(lines, muscles::ArmOf(motion.v, arm.hand()));
  muscles::ActivationProblem problem;
  problem.torque = lines.moment_arm * forces.active.asDiagonal();
  problem.target = torque - lines.moment_arm * forces.passive;
  problem.measured = measured.value;
  problem.trust = measured.trust;
  const muscles::ActivationResult result = muscles::Activate(problem);
  SetActivations(result.activation, &use);
  if (use.raised) return use;
  SetReserve(result.reserve, torque, &use);
  const MuscleVector active = result.activation.cwiseProduct(forces.active);
  const muscles::HandPoint point = muscles::HandPointAt(
      arm.body(), person::Place(arm.body(), motion.q), arm.hand(), wrench.p, wrench.F.head<3>());
  const muscles::ArmMatrix of_joints =
      muscles::JointStiffness(arm, q, active, active + forces.passive);
  for (int i = 0; i < person::kArmJoints; ++i)
    use.joint_stiffness[static_cast<std::size_t>(i)] = of_joints(i, i);
  const auto stiffness = muscles::EndpointStiffness(of_joints, point);
  if (stiffness) {
    const Vector3 principal = muscles::PrincipalStiffness(*stiffness);
    ValueOf(&use, kSoftest) = principal[0];
    ValueOf(&use, kStiffest) = principal[2];
  }
  return use;
}

constexpr Unit kShare = {"", "%", 100, 0};
constexpr Unit kTorque = {"N·m", "N·m", 1, 1};
constexpr Unit kRate = {"N/m", "N/m", 1, 0};

struct Row {
  const char* path[kHands];
  const char* label;
  Unit unit;
  Bad bad = Bad::kHigh;
  bool only_in_files = false;
};

// The quantities, in the order of MuscleValue.
constexpr Row kRows[kMuscleValues] = {
    {{"muscles.left.largest", "muscles.right.largest"}, "largest activation", kShare},
    {{"muscles.left.mean", "muscles.right.mean"}, "mean activation", kShare},
    {{"muscles.left.shoulder_flexors", "muscles.right.shoulder_flexors"},
     "shoulder flexors",
     kShare},
    {{"muscles.left.shoulder_extensors", "muscles.right.shoulder_extensors"},
     "shoulder extensors",
     kShare},
    {{"muscles.left.shoulder_abductors", "muscles.right.shoulder_abductors"},
     "shoulder abductors",
     kShare},
    {{"muscles.left.rotator_cuff", "muscles.right.rotator_cuff"}, "rotator cuff", kShare},
    {{"muscles.left.elbow_flexors", "muscles.right.elbow_flexors"}, "elbow flexors", kShare},
    {{"muscles.left.elbow_extensors", "muscles.right.elbow_extensors"}, "elbow extensors", kShare},
    {{"muscles.left.forearm", "muscles.right.forearm"}, "forearm and wrist", kShare},
    {{"muscles.left.reserve_nm", "muscles.right.reserve_nm"}, "torque the muscles lack", kTorque},
    {{"muscles.left.too_weak", "muscles.right.too_weak"}, "share of time too weak", kShare},
    {{"muscles.left.softest_n_per_m", "muscles.right.softest_n_per_m"},
     "hand's smallest stiffness",
     kRate,
     Bad::kLow},
    {{"muscles.left.stiffest_n_per_m", "muscles.right.stiffest_n_per_m"},
     "hand's largest stiffness",
     kRate,
     Bad::kLow,
     true},
};

template <int Hand, int Value>
double Of(const Moment& m) {
  return m.frame.muscles[Hand].values[Value];
}

template <int Hand, int... Values>
void AddRows(std::integer_sequence<int, Values...>, std::vector<QuantityKind>* kinds) {
  const auto add = [&](const Row& row, double (*of)(const Moment&)) {
    QuantityKind kind = {row.path[Hand],    Hand == 0 ? "Muscles, left arm" : "Muscles, right arm",
                         row.label,         row.unit,
                         Origin::kModelled, of};
    kind.hand = Hand;
    kind.bad = row.bad;
    kind.nominal_only = true;
    kind.only_in_files = row.only_in_files;
    kinds->push_back(kind);
  };
  (add(kRows[Values], Of<Hand, Values>), ...);
}

}  // namespace

ArmMuscles::ArmMuscles(const PersonSetup& setup,
                       const std::shared_ptr<const muscles::ArmPaths>& paths)
    : stance_(setup.stance), arms_{{{setup.body, 0, paths}, {setup.body, 1, paths}}} {}

void ArmMuscles::Add(const person::BodySample& sample, const person::BodyMotion& motion,
                     Frame* frame, const std::array<MeasuredActivations, kHands>& measured) const {
  if (!frame->known) return;
  const auto wrenches = person::WrenchesOn(sample, stance_);
  for (std::size_t h = 0; h < kHands; ++h)
    if (sample.hands[h].present)
      frame->muscles[h] = MusclesOf(arms_[h], motion, frame->loads.torque, wrenches[h],
                                    IsRaised(frame->angles.arms[h]), measured[h]);
}

void AddMuscles(const PersonSetup& setup, std::span<const PersonSample> samples,
                const std::shared_ptr<const muscles::ArmPaths>& paths,
                std::vector<MeasuredEmg>* emg, NominalChain* chain) {
  const ArmMuscles muscles(setup, paths);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    muscles.Add(samples[i].body, chain->motions[i], &chain->frames[i], ActivationsAt(*emg, i));
    AddModelled(chain->frames[i].muscles, emg);
  }
}

std::vector<QuantityKind> MuscleQuantities() {
  std::vector<QuantityKind> kinds;
  AddRows<0>(std::make_integer_sequence<int, kMuscleValues>(), &kinds);
  AddRows<1>(std::make_integer_sequence<int, kMuscleValues>(), &kinds);
  return kinds;
}

void AddMuscleWords(const NominalChain& chain, std::vector<std::string>* warnings,
                    std::vector<std::string>* assumptions, std::vector<NotEvaluable>* gaps) {
  assumptions->emplace_back(
      "The model distributes the torques among the muscles such that the sum of squared "
      "activations is smallest. The model assumes no co-contraction, so activations are lower "
      "bounds. "
      "The missing co-contraction makes the hand's stiffness too low, and rigid tendons make it "
      "too "
      "high. The hand's largest stiffness is two to four times the measured values, so only the "
      "JSON and CSV files contain it.");
  gaps->push_back({"muscles that grip, and the muscle forces on the shoulder joint",
                   "the effort of the grip is not measured, and the shoulder girdle does not move "
                   "in the model"});
  for (int hand = 0; hand < kHands; ++hand) {
    double judged = 0, weak = 0, raised = 0, most = 0;
    for (const Frame& frame : chain.frames) {
      const ArmMuscleUse& use = frame.muscles[static_cast<std::size_t>(hand)];
      raised += use.raised ? 1 : 0;
      if (!std::isfinite(use.values[kTooWeak])) continue;
      judged += 1;
      weak += use.values[kTooWeak];
      most = std::max(most, use.values[kReserve]);
    }
    if (weak > 0)
      warnings->push_back(Formatted(
          "For %.1f %% of the time, the muscles of the %s arm cannot produce the torques of the "
          "arm in the model: up to %.1f N·m are missing, and the activations shown are too low.",
          100 * weak / judged, HandName(hand), most));
    if (raised > 0)
      gaps->push_back({std::string("strength and torques of the ") + HandName(hand) +
                           " shoulder, and muscles and stiffness of this arm, for " +
                           Formatted("%.1f %% of the time", 100 * raised / (judged + raised)),
                       "the upper arm is raised above 90°, where models of the shoulder disagree "
                       "with measurements"});
  }
}

}  // namespace predictor::assessment
