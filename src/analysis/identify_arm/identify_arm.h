// Identifies the impedance of the operator's arms from recordings in which a scenario's
// `perturbation` displaced the handles (docs/how-to/identify-arm.md).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "analysis/identify_arm/arm_fit.h"
#include "core/record.h"
#include "scenario/scenario.h"

namespace predictor {

struct ArmOfHand {
  bool present = false;
  std::string refusal;        // why the arm is not identified and the remedy; otherwise empty
  std::optional<ArmFit> fit;  // empty if refused
  int taken = 0;              // displacements used
  int spoiled = 0;            // displacements that were cut short, or had a gap
  double largest_force = 0;   // of the hand while it was displaced [N]
  bool identified() const { return fit.has_value(); }
};

struct ArmIdentification {
  std::array<ArmOfHand, kHands> hands;
  std::array<Vector3, 2> plane = {Vector3::UnitX(), Vector3::UnitY()};  // axes u, v in W
  bool simulated = false;                                               // operator
  bool complete() const;                                                // no hand was refused
};

class ArmIdentifier {
 public:
  explicit ArmIdentifier(ArmFitOptions options = {});
  ~ArmIdentifier();

  // Begins a further recording of the same person. `scenario` is the scenario of this recording.
  // Throws InputError if the displacements in this recording lie in another plane than those in the
  // first recording.
  void Begin(const Scenario& scenario, double dt);
  void Add(const TickRecord& record);
  ArmIdentification Finish() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Returns whether the 90 % interval is wider than ±25 % of the value.
bool IsWide(const ArmFit& fit, int parameter);

std::string ArmText(const ArmIdentification& identification, const std::string& source);
std::string ArmJson(const ArmIdentification& identification, const std::string& source);  // SI
// Returns the mean and the covariance of a hand's parameters for `predictor continue --arm`:
// stiffness along those axes of W that lie in the plane, damping ratio, mass, reflex gain and
// delay. The hand must have been identified.
std::string ArmFile(const ArmIdentification& identification, int hand, const std::string& source);

}  // namespace predictor
