// Predicts what the device can render while the object touches a fixture.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "core/messages.h"
#include "haptics/stability.h"
#include "haptics/wall.h"
#include "scenario/scenario.h"

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

// A wall that represents one point of contact. The wall stands for all fixtures of the same kind
// that lie on the same side of the object.
struct FixtureWall {
  std::vector<std::size_t> fixtures;  // their numbers
  Wall wall;
  bool yields = false;  // they have a stiffness
  // Returns the wall for a search over stiffnesses. The wall has the fixtures' own damping if the
  // fixtures yield, and no damping otherwise. The damping of a contact that does not yield is valid
  // only together with the contact's own stiffness.
  Wall Varying() const;
};

// The prediction for contact with the fixtures that a wall represents.
struct ContactReport : FixtureWall {
  bool stable = true;  // touched at one point and, if they yield, at four
  WallLimit limit;     // with the wall Varying(), for the scenario's hand
  // Impedances that the hands feel in contact at one point: at rest, at kFeltFrequency and at all
  // frequencies of FeltFrequencies().
  FeltImpedance at_rest, moving;
  std::vector<FeltAt> spectrum;
};
inline constexpr double kFeltFrequency = 5;  // [Hz]

// Returns frequencies from 0.1 to 40 Hz, with 20 frequencies per decade [Hz].
std::vector<double> FeltFrequencies();

// Returns the walls of all fixtures that touch the object. Each contact acts at the object's
// origin, along the normal of the fixture's nearest side. X_WO is the pose of the object in W.
// Empty without hands.
std::vector<FixtureWall> WallsOf(const Scenario& scenario, const LinearModel& world,
                                 const Pose& X_WO);

// Returns the reports for WallsOf. The world is linearised about the start. `lead` is the lead of
// the run [s].
std::vector<ContactReport> CheckContacts(const Scenario& scenario, const LinearModel& world,
                                         const Pose& X_WO, double lead);

// Returns the damping part of an impedance [N/m] at a frequency [Hz], in N·s/m.
double DampingOf(const std::complex<double>& impedance, double frequency);

// Returns the outward unit normal, in W, of the fixture's side that faces the point p_W.
Vector3 NormalToward(const FixtureSpec& fixture, const Vector3& p_W);

}  // namespace predictor
