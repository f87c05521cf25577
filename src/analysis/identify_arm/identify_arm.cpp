#include "analysis/identify_arm/identify_arm.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/identify_arm/arm_collector.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "scenario/perturbation.h"

namespace predictor {
namespace {

constexpr double kMaxTick = 0.002;  // [s]; a longer one cannot resolve the acceleration
constexpr int kMinDisplacements = 3 * kPlaneParameters;

// Appends the displacements of one recording to the displacements of other recordings.
void Append(const ArmResponses& from, ArmResponses* to) {
  if (to->count() == 0) {
    *to = from;
    return;
  }
  const auto join = [](const Eigen::MatrixXd& b, Eigen::MatrixXd* a) {
    Eigen::MatrixXd both(a->rows(), a->cols() + b.cols());
    both << *a, b;
    *a = std::move(both);
  };
  for (std::size_t axis = 0; axis < 2; ++axis) {
    join(from.position[axis], &to->position[axis]);
    join(from.velocity[axis], &to->velocity[axis]);
    join(from.acceleration[axis], &to->acceleration[axis]);
    join(from.force[axis], &to->force[axis]);
  }
  Eigen::MatrixX2d direction(to->count() + from.count(), 2);
  direction << to->direction, from.direction;
  to->direction = direction;
}

}  // namespace

struct ArmIdentifier::Impl {
  ArmFitOptions options;
  std::vector<std::array<std::optional<ArmCollector>, kHands>> recordings;
  std::array<Vector3, 2> plane = {Vector3::UnitX(), Vector3::UnitY()};
  double dt = 0;
  bool perturbed = false, simulated = false;

  ArmOfHand Hand(std::size_t hand) const;
  std::string WhyRefused(const ArmOfHand& arm) const;
};

ArmIdentifier::ArmIdentifier(ArmFitOptions options) : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
}
ArmIdentifier::~ArmIdentifier() = default;

void ArmIdentifier::Begin(const Scenario& scenario, double dt) {
  Impl& s = *impl_;
  if (scenario.mode == Mode::kDirect)
    throw InputError(
        "The recording was made in mode: direct, in which no force sensor measures a hand. Record "
        "an emulation.");
  if (dt > kMaxTick)
    throw InputError("The recording has a tick of " + FormatNumber(1e3 * dt) +
                     " ms, which is too long to see the arm's inertia. Record at 500 Hz or more.");
  if (!s.recordings.empty() && std::abs(dt - s.dt) > 1e-9)
    throw InputError(
        "The recordings differ in their rates. Identify the arm from each recording separately.");
  if (scenario.perturbation) {
    const auto plane = PerturbationPlane(*scenario.perturbation);
    if (s.perturbed &&
        ((plane[0] - s.plane[0]).norm() > 1e-9 || (plane[1] - s.plane[1]).norm() > 1e-9))
      throw InputError(
          "The recordings differ in perturbation.normal. Identify the arm in each plane "
          "separately.");
    s.plane = plane;
    s.perturbed = true;
  }
  s.dt = dt;
  s.simulated = s.simulated || scenario.operator_.type != "person";
  auto& hands = s.recordings.emplace_back();
  for (const int hand : scenario.hands())
    hands[static_cast<std::size_t>(hand)].emplace(scenario, hand, s.plane, dt);
}

void ArmIdentifier::Add(const TickRecord& record) {
  for (auto& hand : impl_->recordings.back())
    if (hand) hand->Add(record);
}

// If all motion depends on the hand, force and motion determine the impedance of the virtual
// object, not that of the arm.
std::string ArmIdentifier::Impl::WhyRefused(const ArmOfHand& arm) const {
  if (!perturbed)
    return "Nothing moved the handle independently of the person, because the scenario has no "
           "perturbation. The hand's impedance cannot be distinguished from its voluntary force. "
           "Record a run with perturbation: {consent: true}, for example "
           "scenarios/identify_arm.yaml.";
  if (arm.taken >= kMinDisplacements) return "";
  std::string why = "Only " + std::to_string(arm.taken) + " displacements can be used; at least " +
                    std::to_string(kMinDisplacements) + " are needed.";
  if (arm.spoiled > 0)
    why += " " + std::to_string(arm.spoiled) +
           " were taken back because of a force above perturbation.force, or had a gap.";
  return why +
         " Record a longer run, or several runs, in which the hands hold the object and hardly "
         "move it. A displacement begins only if each hand exerts at least 0.5 N, the object is "
         "slower than perturbation.speed, and the expected force is below perturbation.force.";
}

ArmOfHand ArmIdentifier::Impl::Hand(std::size_t hand) const {
  ArmOfHand arm;
  ArmResponses all;
  for (const auto& recording : recordings) {
    if (!recording[hand]) continue;
    const ArmCollector& collector = *recording[hand];
    arm.present = true;
    arm.taken += collector.taken();
    arm.spoiled += collector.spoiled();
    arm.largest_force = std::max(arm.largest_force, collector.largest_force());
    if (collector.taken() > 0) Append(collector.responses(), &all);
  }
  if (!arm.present) return arm;
  arm.refusal = WhyRefused(arm);
  if (!arm.refusal.empty()) return arm;
  try {
    arm.fit = FitArm(all, options);
  } catch (const InputError& error) {
    arm.refusal = error.what();
  }
  return arm;
}

ArmIdentification ArmIdentifier::Finish() const {
  ArmIdentification result;
  result.plane = impl_->plane;
  result.simulated = impl_->simulated;
  for (std::size_t hand = 0; hand < kHands; ++hand) result.hands[hand] = impl_->Hand(hand);
  return result;
}

bool ArmIdentification::complete() const {
  return std::ranges::all_of(hands,
                             [](const ArmOfHand& h) { return !h.present || h.identified(); });
}

bool IsWide(const ArmFit& fit, int parameter) {
  return !(fit.half_width(parameter) <= 0.25 * std::abs(fit.value[parameter]));
}

}  // namespace predictor
