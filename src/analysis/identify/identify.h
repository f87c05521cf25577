// Identifies a cobot's joint friction, and its load, from the ticks of a run.
//
// Both sides of each joint's equation of motion are averaged over windows:
//
//   τ + J_Aᵀ P Σ F_hand = b v + c sgn(v) + Y(q, v, a) π + J_Aᵀ P Y_load π_load
//
// τ is the commanded torque (a sensor on the link side would not measure the friction). b and c are
// viscous and Coulomb friction, Y is the joint-torque regressor, π the links' inertial parameters,
// A the attachment of the load, and P the projection on the wrenches that the attachment transmits.
// All unknowns enter the equations linearly, so robust least squares can estimate the unknowns.
// The method and its accuracy are described in docs/how-to/identify-friction.md.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/least_squares.h"
#include "core/record.h"
#include "scenario/scenario.h"

namespace predictor {

struct IdentifyOptions {
  double window = 0.1;  // time over which an equation is averaged, with a Hann window [s]
  // The assumed deviations of the links from their model, as standard deviations.
  double mass_uncertainty = 0.03;    // mass of a link, as a share of the mass
  double com_uncertainty = 0.005;    // centre of mass of a link, along each axis [m]
  double inertia_uncertainty = 0.1;  // inertia of a link, as a share of its trace
};

// Returns whether the interval exceeds both ±5 % of the value and an amount too small to feel:
// 0.005 N·m or N·m·s/rad, or 0.005 kg or m for the load.
bool IsWide(const Estimate& estimate);

struct JointIdentification {
  std::string name;
  std::string refusal;  // why the joint is not identified and the remedy; otherwise empty
  Estimate viscous;     // [N·m·s/rad]
  Estimate coulomb;     // [N·m]
  std::array<double, 2> moving = {0, 0};  // time for which it turned in each direction [s]
  double slow = 0, fast = 0;  // 10 % and 90 % quantiles of its speed while it turned [rad/s]
  double held_out = 0;        // rms torque error in blocks that were left out of the fit [N·m]
  bool identified() const { return refusal.empty(); }
};

struct LoadIdentification {
  std::string refusal;                    // as for a joint
  Estimate mass;                          // [kg]
  std::array<Estimate, 3> com;            // centre of gravity in O [m]
  double nominal_mass = 0;                // [kg]
  Vector3 nominal_com = Vector3::Zero();  // [m]
  bool identified() const { return refusal.empty(); }
};

// The model of the links' inertial parameters.
enum class InertiaModel { kFixed, kRegularised, kBase };
inline constexpr int kInertiaModels = 3;
inline constexpr std::array<const char*, kInertiaModels> kInertiaModelNames = {
    "fixed", "regularised", "base"};

// The accuracy with which a model predicts blocks of time that were left out of its fit.
struct ModelScore {
  double held_out = 0;  // rms torque error [N·m]
  // The mean robust loss per row minus the loss of the regularised model, and the standard error of
  // this difference.
  double excess = 0, excess_error = 0;
};

struct Identification {
  std::vector<JointIdentification> joints;
  LoadIdentification load;
  InertiaModel model = InertiaModel::kRegularised;  // selected by the scores
  std::array<ModelScore, kInertiaModels> scores;
  int base_parameters = 0;  // number of parameters of links and load that the motion separates
  // The distance of the links from their model, in standard deviations of the prior (rms over the
  // base parameters). The second value states whether this distance is larger than chance can
  // explain.
  double strain = 0;
  bool strained = false;
  double condition = 0;  // condition number of the base regressor with friction, for unit columns
  double duration = 0;   // duration of the data used [s]
  // The number of ticks that were skipped because they contain a number that is not finite. A
  // recording with such ticks is damaged.
  std::uint64_t not_finite = 0;
  bool complete() const;  // no joint was refused
};

// Collects the ticks of a run one by one. Memory grows by 6 MB per minute for seven joints.
class Identifier {
 public:
  // `nominal` is the scenario with the nominal cobot and load of the recording. Throws InputError.
  explicit Identifier(const Scenario& nominal, const IdentifyOptions& options = {});
  ~Identifier();

  // Adds ticks in order. Ticks that are not in RUN or are next to a gap are skipped.
  void Add(const TickRecord& record);

  // Throws InputError if the data cover less than ten seconds, or if the data come from a cobot
  // with a different number of joints.
  Identification Finish() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

// Returns the scenario with the identified friction. A refused joint keeps its previous friction.
Scenario WithFriction(const Scenario& scenario, const Identification& identification);

std::string IdentificationText(const Identification& identification);  // for the user
std::string IdentificationJson(const Identification& identification);  // in SI units

}  // namespace predictor
