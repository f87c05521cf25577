// Identification of a cobot's joint friction, and of its load, out of the ticks of a run.
//
// The equation of motion of each joint is averaged over windows, both sides alike:
//
//   τ + J_Aᵀ P Σ F_hand = b v + c sgn(v) + Y(q, v, a) π + J_Aᵀ P Y_load π_load
//
// τ commanded torque (a sensor on the link's side would not see the friction), b and c viscous and
// Coulomb friction, Y the joint-torque regressor, π the links' inertial parameters, A the
// attachment of the load, P what the attachment transmits. Everything unknown enters linearly and
// is found by robust least squares. docs/identification.md tells how, and how well.
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
  double window = 0.1;  // over which an equation is averaged, with Hann's weights [s]
  // How far the links may be from their model (standard deviations).
  double mass_uncertainty = 0.03;    // of a link's mass, over the mass
  double com_uncertainty = 0.005;    // of a link's centre of mass, along each axis [m]
  double inertia_uncertainty = 0.1;  // of a link's inertia, over its trace
};

// The interval reaches further than 5 % of the value, and than what nobody would feel: 0.005 of
// N·m and N·m·s/rad; of the load, of kg and m.
bool IsWide(const Estimate& estimate);

struct JointIdentification {
  std::string name;
  std::string refusal;                    // why nothing is said of it and what to do; else empty
  Estimate viscous;                       // [N·m·s/rad]
  Estimate coulomb;                       // [N·m]
  std::array<double, 2> moving = {0, 0};  // time in which it turned back and forth [s]
  double slow = 0, fast = 0;              // of its speeds while it turned: 10 and 90 % [rad/s]
  double held_out = 0;                    // rms torque error in blocks left out of the fit [N·m]
  bool identified() const { return refusal.empty(); }
};

struct LoadIdentification {
  std::string refusal;                     // as of a joint
  Estimate mass;                           // [kg]
  std::array<Estimate, 3> com;             // of its centre of gravity in O [m]
  double believed_mass = 0;                // [kg]
  Vector3 believed_com = Vector3::Zero();  // [m]
  bool identified() const { return refusal.empty(); }
};

// What is taken of the links' inertial parameters.
enum class InertiaModel { kFixed, kRegularised, kBase };
inline constexpr int kInertiaModels = 3;
inline constexpr std::array<const char*, kInertiaModels> kInertiaModelNames = {
    "fixed", "regularised", "base"};

// How well a model foretells blocks of time that were left out of its fit.
struct ModelScore {
  double held_out = 0;  // rms torque error [N·m]
  // Mean robust loss of a row over that of the regularised model, and its standard error.
  double excess = 0, excess_error = 0;
};

struct Identification {
  std::vector<JointIdentification> joints;
  LoadIdentification load;
  InertiaModel model = InertiaModel::kRegularised;  // by the scores
  std::array<ModelScore, kInertiaModels> scores;
  int base_parameters = 0;  // that the motion tells apart, of links and load together
  // How far the links seem to be from their model, in standard deviations of what is believed (rms
  // over the base parameters); and whether that is more than can be by chance.
  double strain = 0;
  bool strained = false;
  double condition = 0;  // of the base regressor with friction, columns of unit length
  double duration = 0;   // of what was used [s]
  // Ticks left out because a number in them is none (or infinite): the recording is damaged.
  std::uint64_t not_finite = 0;
  bool complete() const;  // no joint was refused
};

// Takes the ticks of a run one by one; memory grows by 6 MB a minute and seven joints.
class Identifier {
 public:
  // `believed`: whose cobot and load are believed to be the recorded ones. Throws InputError.
  explicit Identifier(const Scenario& believed, const IdentifyOptions& options = {});
  ~Identifier();

  // Ticks in their order; what did not run, or lies beside a gap, is left out.
  void Add(const TickRecord& record);

  // Throws InputError if there is nothing to go by: less than ten seconds, or a cobot with another
  // number of joints.
  Identification Finish() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

// The scenario with the friction that was found; a joint that was refused keeps its own.
Scenario WithFriction(const Scenario& scenario, const Identification& identification);

std::string IdentificationText(const Identification& identification);  // for people
std::string IdentificationJson(const Identification& identification);  // SI units

}  // namespace predictor
