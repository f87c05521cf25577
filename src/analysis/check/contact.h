// Predicts what the device can render while the object touches its surroundings.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "analysis/check/surfaces.h"
#include "core/messages.h"
#include "haptics/stability.h"
#include "haptics/wall.h"
#include "scenario/scenario.h"
#include "simulation/world.h"

namespace predictor {

// The range of stiffnesses in which the prediction searches [N/m].
inline constexpr double kSoftestWall = 100, kStiffestWall = 1e6;

// The stiffest wall against which the loop does not oscillate.
struct WallLimit {
  double stiffness = 0;  // [N/m]; 0: the loop oscillates even without a wall
  double frequency = 0;  // of the oscillation against a stiffer one [Hz]
  bool reached = true;   // false: none up to kStiffestWall makes it oscillate
};

// Returns the limit for a hand and a lead [s], with an accuracy of 5 %. `wall` specifies the place,
// direction and damping of the wall. The function varies the stiffness of the wall from soft to
// stiff. The loop may be stable again with walls that are much stiffer than the limit.
WallLimit StiffestStableWall(const LinearModel& world, const Scenario& scenario,
                             const HandSpec& hand, double lead, const Wall& wall,
                             LoopModel model = LoopModel::kWithReserve);

// The impedance that the hands feel at one frequency.
struct FeltAt {
  double frequency = 0;  // [Hz]
  FeltImpedance felt;
};

// A wall that represents one point of contact. The wall stands for all surfaces of the same kind
// that lie on the same side of the object.
struct ContactWall {
  std::vector<Surface> surfaces;
  Wall wall;
  bool yields = false;  // the surfaces are fixtures with a stiffness
  // Returns the wall for a search over stiffnesses. The wall has the fixtures' own damping if the
  // fixtures yield, and no damping otherwise. The damping of a contact that does not yield is valid
  // only together with the contact's own stiffness.
  Wall Varying() const;
};

// The prediction for a movable object that moves together with the carried object.
struct AddedMass {
  double mass = 0;       // of the movable object [kg]
  bool stable = true;    // the loop with this mass
  FeltImpedance moving;  // at kFeltFrequency, along the wall's normal
};

// The prediction for contact with the surfaces that a wall represents. A movable object counts as
// one that cannot move, for example because a fixture is behind it.
struct ContactReport : ContactWall {
  std::string what;  // the surfaces with their names, for example "fixtures 0 and 2 (shelf)"
  // The object touches a surface at the start. `stable`, `at_rest`, `moving` and `spectrum` are
  // then those of this contact as it is, with all its points.
  bool at_start = false;
  bool stable = true;  // touched at one point and, if the contact is soft, at four
  WallLimit limit;     // with the wall Varying(), for the scenario's hand
  // Impedances that the hands feel in contact at one point: at rest, at kFeltFrequency and at all
  // frequencies of FeltFrequencies().
  FeltImpedance at_rest, moving;
  std::vector<FeltAt> spectrum;
  // For a movable object: the object pushes it along the normal and nothing else stops it, and the
  // object holds it (event pick_up). Absent for other surfaces, and if there is no such event.
  std::optional<AddedMass> pushed, held;

  bool is_movable() const { return surfaces[0].kind == Surface::Kind::kMovable; }
};
inline constexpr double kFeltFrequency = 5;  // [Hz]

// Returns frequencies from 0.1 to 40 Hz, with 20 frequencies per decade [Hz].
std::vector<double> FeltFrequencies();

// Returns the walls of all surfaces that the object can touch. Each contact acts at the object's
// origin, along the normal of the surface's nearest side. X_WO is the pose of the object in W.
// `floor` states whether to include the floor if there is one. `world` contains no contacts. Empty
// without hands. Throws InputError if the model of a movable object cannot be read.
std::vector<ContactWall> WallsOf(const Scenario& scenario, const LinearModel& world,
                                 const Pose& X_WO, bool floor);

// Returns the reports for WallsOf at the start. `lead` is the lead of the run [s]. `world` is at
// the start. Throws as WallsOf does. Allocates memory.
std::vector<ContactReport> CheckContacts(const Scenario& scenario, const World& world, double lead,
                                         bool floor);

// Returns the damping part of an impedance [N/m] at a frequency [Hz], in N·s/m.
double DampingOf(const std::complex<double>& impedance, double frequency);

}  // namespace predictor
